"""ROBOTIS TurtleBot3 Burger: axle ahead of the middle of its body."""

from __future__ import annotations

from fuzzyq_bullet.robots.base import RobotModel, register_robot

TURTLEBOT3_BURGER = register_robot(
    RobotModel(
        name="turtlebot3-burger",
        size=(0.138, 0.178),
        offset=-0.032,
        height=0.192,
        track=0.16,
        wheel_radius=0.033,
        mass=0.94,
        wheel_mass=0.03,
        motor_torque=1.5,
        max_speed=0.22,
        max_turn_rate=2.84,
        acceleration=1.0,
        turn_acceleration=6.0,
        source="TurtleBot3 e-Manual, Features: Specifications; turtlebot3_description",
    )
)
