"""A new robot: smaller, slower, with narrower wheels; its URDF is made from these numbers.

    fuzzyq run room.yaml --plugin examples/extend/robot.py

In the scenario file: ``robot: {model: mouse}``. Keys such as ``max_speed`` still change it.
"""

from fuzzyq_bullet.robots import RobotModel, register_robot

register_robot(
    RobotModel(
        name="mouse",
        radius=0.15,
        height=0.12,
        track=0.22,
        wheel_radius=0.04,
        mass=2.0,
        wheel_mass=0.1,
        motor_torque=1.5,
        max_speed=0.4,
        max_turn_rate=2.5,
        acceleration=0.8,
    )
)
