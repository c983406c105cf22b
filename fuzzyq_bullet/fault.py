"""Whose fault a contact was, and how fast both moved."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fuzzyq_bullet.moving import speed_at

if TYPE_CHECKING:
    from fuzzyq_bullet.trajectory import Trajectory

FAULT_SPEED = 0.05
"""A robot that moves faster than this (m/s) when it touches something is at fault."""
FAULT_TIME = 0.3
"""It is also at fault if it was so fast within this time (s) before."""


def at_fault(trajectory: Trajectory) -> bool | None:
    """Return whether the robot was at fault for the contact that ended its run; None without one.

    Passive safety: a robot that stands, and has stood for a moment, has done what it can.
    """
    speed = robot_speed(trajectory)
    return None if speed is None else speed > FAULT_SPEED


def robot_speed(trajectory: Trajectory) -> float | None:
    """Return the robot's greatest speed (m/s) in the 0.3 s before a contact; None without one."""
    if trajectory.collision is None:
        return None
    ticks, time = trajectory.ticks, trajectory.collision.time
    before = ticks.time >= time - FAULT_TIME - 1e-9
    if trajectory.scenario.drive == "wheels" and len(ticks.time) > 1:
        before[-1] = False  # that speed is what the contact has made of it
    return float(np.abs(ticks.speed[before]).max(initial=0.0))


def mover_speed(trajectory: Trajectory) -> float | None:
    """Return how fast (m/s) that moved what was touched; None for what stands, or no contact."""
    hit, scenario = trajectory.collision, trajectory.scenario
    if hit is None or hit.obstacle not in scenario.movers or len(trajectory.ticks.time) < 2:
        return None
    k = scenario.movers.index(hit.obstacle)
    before, after = trajectory.movers[-2, k].tolist(), trajectory.movers[-1, k].tolist()
    span = float(trajectory.ticks.time[-1] - trajectory.ticks.time[-2])
    return speed_at(scenario.obstacles[hit.obstacle].position, before, after, hit.point, span)


def speeds_in_words(trajectory: Trajectory) -> str:
    """Say how fast the two moved, if the robot touched something that moves; else nothing."""
    other, own = mover_speed(trajectory), robot_speed(trajectory)
    if other is None or own is None:
        return ""
    whose = "at fault" if own > FAULT_SPEED else "not at fault"
    return f"it moved at {other:.2f} m/s, the robot at {own:.2f} m/s: {whose}"
