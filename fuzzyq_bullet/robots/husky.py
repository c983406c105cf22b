"""Clearpath Husky: its four skid-steered wheels are modelled as two amidships and a caster."""

from __future__ import annotations

from fuzzyq_bullet.robots.base import RobotModel, register_robot

HUSKY = register_robot(
    RobotModel(
        name="husky",
        size=(0.99, 0.67),
        height=0.39,
        track=0.555,
        wheel_radius=0.165,
        mass=45.0,
        wheel_mass=2.6,
        motor_torque=60.0,
        max_speed=1.0,
        max_turn_rate=2.0,
        acceleration=2.0,
        turn_acceleration=6.0,
        source="Husky user manual, Technical Specifications; husky_description",
    )
)
