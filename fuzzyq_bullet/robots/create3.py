"""iRobot Create 3: a disc, driven by two wheels on its diameter."""

from __future__ import annotations

from fuzzyq_bullet.robots.base import RobotModel, register_robot

CREATE3 = register_robot(
    RobotModel(
        name="create3",
        radius=0.171,
        height=0.093,
        track=0.233,
        wheel_radius=0.036,
        mass=2.8,
        wheel_mass=0.05,
        motor_torque=1.5,
        max_speed=0.306,
        max_turn_rate=1.9,
        acceleration=0.9,
        turn_acceleration=6.0,
        source="Create 3 documentation, Hardware Overview; irobot_create_description",
    )
)
