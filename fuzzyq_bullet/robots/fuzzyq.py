"""The default robot, with the paper's own unit S_p = 0.2 m."""

from __future__ import annotations

from fuzzyq_bullet.resources import asset
from fuzzyq_bullet.robots.base import RobotModel, register_robot

FUZZYQ = register_robot(
    RobotModel(
        name="fuzzyq",
        radius=0.2,
        height=0.15,
        track=0.28,
        wheel_radius=0.05,
        mass=5.0,
        wheel_mass=0.2,
        motor_torque=3.0,
        max_speed=0.6,
        max_turn_rate=2.0,
        acceleration=1.0,
        turn_acceleration=6.0,
        urdf_file=asset("robot.urdf"),
    )
)
