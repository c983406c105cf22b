"""Clearpath Jackal: its four skid-steered wheels are modelled as two amidships and a caster."""

from __future__ import annotations

from fuzzyq_bullet.robots.base import RobotModel, register_robot

JACKAL = register_robot(
    RobotModel(
        name="jackal",
        size=(0.508, 0.43),
        height=0.25,
        track=0.376,
        wheel_radius=0.098,
        mass=16.0,
        wheel_mass=0.5,
        motor_torque=15.0,
        max_speed=2.0,
        max_turn_rate=4.0,
        acceleration=3.0,
        turn_acceleration=10.0,
        source="Jackal user manual, Technical Specifications; jackal_description",
    )
)
