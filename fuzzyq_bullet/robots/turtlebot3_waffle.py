"""ROBOTIS TurtleBot3 Waffle: axle ahead of the middle of its body."""

from __future__ import annotations

from fuzzyq_bullet.robots.base import RobotModel, register_robot

TURTLEBOT3_WAFFLE = register_robot(
    RobotModel(
        name="turtlebot3-waffle",
        size=(0.281, 0.306),
        offset=-0.064,
        height=0.141,
        track=0.287,
        wheel_radius=0.033,
        mass=1.74,
        wheel_mass=0.03,
        motor_torque=1.5,
        max_speed=0.26,
        max_turn_rate=1.82,
        acceleration=1.0,
        turn_acceleration=6.0,
        source="TurtleBot3 e-Manual, Features: Specifications; turtlebot3_description",
    )
)
