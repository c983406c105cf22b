"""Whose fault a contact was, and how fast both moved."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fuzzyq_bullet.recording.moving import speed_at

if TYPE_CHECKING:
    from fuzzyq_bullet.recording.trajectory import Trajectory

FAULT_SPEED = 0.05
"""A robot that moves faster than this (m/s) when it touches something that moves is at fault."""
FAULT_TIME = 0.3
"""It is also at fault if it was so fast within this time (s) before."""


def at_fault(trajectory: Trajectory) -> bool | None:
    """Return whether the robot was at fault for the contact that ended its run; None without one.

    Passive safety: a robot that stands, and has stood for a moment, has done what it can. What
    stands still does not come to a robot, however slowly that creeps.
    """
    hit, speed = trajectory.collision, robot_speed(trajectory)
    if hit is None or speed is None:
        return None
    return hit.obstacle not in trajectory.scenario.movers or speed > FAULT_SPEED


def robot_speed(trajectory: Trajectory) -> float | None:
    """Return the robot's greatest speed (m/s) in the 0.3 s before a contact; None without one."""
    if trajectory.collision is None:
        return None
    ticks, time = trajectory.ticks, trajectory.collision.time
    if trajectory.scenario.drive == "kinematic" and len(ticks.time) > 1:
        # The contact cut the last move short.
        return float(trajectory.decisions.step[-1] / (ticks.time[-1] - ticks.time[-2]))
    before = ticks.time >= time - FAULT_TIME - 1e-9
    before[-2:] = True  # of few decisions a second, the tick before the contact is older
    before[-1] = len(ticks.time) == 1  # the last speed is what the contact has made of it
    return float(np.abs(ticks.speed[before]).max(initial=0.0))


def mover_speed(trajectory: Trajectory) -> float | None:
    """Return how fast (m/s) that moved what was touched; None for what stands, or no contact."""
    hit, scenario = trajectory.collision, trajectory.scenario
    if hit is None or hit.obstacle not in scenario.movers or len(trajectory.ticks.time) < 2:
        return None
    poses = trajectory.movers[:, scenario.movers.index(hit.obstacle)].tolist()
    centre, time = scenario.obstacles[hit.obstacle].position, trajectory.ticks.time.tolist()
    # A move of the kinematic drive is long, and the contact stopped the obstacle within the last.
    last = 2 if scenario.drive == "kinematic" and len(time) > 2 else 1
    return max(
        speed_at(centre, poses[k - 1], poses[k], hit.point, time[k] - time[k - 1])
        for k in range(-last, 0)
    )


def speeds_in_words(trajectory: Trajectory) -> str:
    """Say how fast the two moved, if the robot touched something that moves; else nothing."""
    other, own = mover_speed(trajectory), robot_speed(trajectory)
    if other is None or own is None:
        return ""
    whose = "at fault" if at_fault(trajectory) else "not at fault"
    # A speed that is rounded to the limit would not say on which side of it it is.
    told = f"{own:.4g}" if round(own, 2) == FAULT_SPEED else f"{own:.2f}"
    return f"it moved at {other:.2f} m/s, the robot at {told} m/s: {whose}"
