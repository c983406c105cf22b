"""Which moving obstacle comes towards the robot, in words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fuzzyq_bullet.video.timeline import sensor_range

if TYPE_CHECKING:
    from fuzzyq_bullet.recording.trajectory import Trajectory

_AHEAD = math.radians(30.0)
"""What comes from no farther aside of the robot's heading (rad) comes from ahead."""
_BEHIND = math.radians(120.0)
_SLOW = 0.02
"""What comes nearer more slowly than this (m/s) does not come."""


def approaching(trajectory: Trajectory, tick: int) -> str:
    """Say that a moving obstacle within the range of the sensor comes; nothing if none does.

    Args:
        trajectory: The run.
        tick: When.
    """
    scenario, ticks = trajectory.scenario, trajectory.ticks
    last = len(ticks.time) - 1
    if not trajectory.movers.size or last < 1:
        return ""
    one, two = (tick, tick + 1) if tick < last else (last - 1, last)
    span = float(ticks.time[two] - ticks.time[one])
    x, y = ticks.position[tick].tolist()
    least, found = sensor_range(trajectory) + scenario.robot.radius, ""
    for k, index in enumerate(scenario.movers):
        before, after = trajectory.movers[one, k].tolist(), trajectory.movers[two, k].tolist()
        closing = (math.dist((x, y), before[:2]) - math.dist((x, y), after[:2])) / span
        gap = math.dist((x, y), trajectory.movers[tick, k, :2]) - scenario.obstacles[index].extent()
        if closing > _SLOW and gap < least:
            bearing = math.atan2(before[1] - y, before[0] - x) - float(ticks.heading[tick])
            least, found = gap, _side(math.remainder(bearing, math.tau))
    return f"A moving obstacle comes from {found}" if found else ""


def _side(bearing: float) -> str:
    if abs(bearing) <= _AHEAD:
        return "ahead"
    if abs(bearing) >= _BEHIND:
        return "behind"
    return "the left" if bearing > 0.0 else "the right"
