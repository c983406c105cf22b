"""The safety filter for twists: the arc ahead, up to a stop, must be free."""

from __future__ import annotations

import math
from collections.abc import Iterable

from fuzzyq_bullet.planning.base import Motion, Observation
from fuzzyq_bullet.planning.commands import TwistCommand
from fuzzyq_bullet.planning.safety_filter import RESERVE, SAME

PARTS = 8
"""A twist that leads too far is tried again with so many smaller speeds."""
_APART = 0.01
"""Greatest distance between two points of the arc (m): half of what a line is wider than the
robot, on either side."""
_STEPS_A_PERIOD = 12
_MOST_STEPS = 100_000


def twist_filter(
    twist: TwistCommand, observation: Observation, motion: Motion
) -> tuple[TwistCommand, float]:
    """Return the twist with its speed limited to what is free.

    Args:
        twist: What the planner asks for.
        observation: What it saw, of a robot with wheels.
        motion: What its body can do.

    Returns:
        The limited twist, and the shortest of the free lengths (m) towards points of its arc.
    """
    found, shortest = first_free(slower(twist, motion), observation, motion)
    return found or twist._replace(speed=0.0, turn_rate=0.0), shortest


def slower(twist: TwistCommand, motion: Motion) -> list[TwistCommand]:
    """Return the twist within the robot's limits, then with smaller speeds down to none."""
    speed = max(-motion.max_speed, min(twist.speed, motion.max_speed))
    rate = max(-motion.max_turn_rate, min(twist.turn_rate, motion.max_turn_rate))
    return [
        twist._replace(speed=speed * part / PARTS, turn_rate=rate) for part in range(PARTS, -1, -1)
    ]


def first_free(
    twists: Iterable[TwistCommand], observation: Observation, motion: Motion
) -> tuple[TwistCommand | None, float]:
    """Return the first twist whose way is free.

    The robot goes on until the command reaches its wheels, comes to the twist within its
    acceleration, holds it for a period, and then brakes to a stop. Every point that its centre
    passes must be sensed to be free. If it is not with any twist, the robot should brake: that way
    was free when it was last asked, so there always is one.

    Returns:
        The twist, None if the way of none is free; and the shortest of the free lengths (m) towards
        points of the last arc that was tried, 0 if there is none.
    """
    shortest = 0.0
    for twist in twists:
        arc = _arc(twist, observation, motion)
        free, shortest = _free(arc, observation, RESERVE + observation.uncertainty)
        if free:
            return twist, shortest
    return None, shortest


def _arc(
    twist: TwistCommand, observation: Observation, motion: Motion
) -> list[tuple[float, float]]:
    """Return points that the centre passes, seen from where it is now (m), up to a stop."""
    dt = motion.period / _STEPS_A_PERIOD
    x, y, facing = 0.0, 0.0, observation.heading
    speed, rate = observation.speed, observation.turn_rate
    points: list[tuple[float, float]] = []
    heard = math.ceil(motion.latency / dt)
    for step in range(_MOST_STEPS):
        braking = step >= heard + _STEPS_A_PERIOD
        if step >= heard:
            wanted, turning = (0.0, 0.0) if braking else (twist.speed, twist.turn_rate)
            speed = _towards(speed, wanted, motion.acceleration * dt)
            rate = _towards(rate, turning, motion.turn_acceleration * dt)
        facing += rate * dt
        x, y = x + speed * math.cos(facing) * dt, y + speed * math.sin(facing) * dt
        if not points or math.dist(points[-1], (x, y)) >= _APART:
            points.append((x, y))
        if braking and speed == 0.0:
            break
    return [*points, (x, y)]


def _free(
    points: list[tuple[float, float]], observation: Observation, reserve: float
) -> tuple[bool, float]:
    """Return whether all points are free, and the shortest of the lengths that say so (m)."""
    needs: dict[float, float] = {}
    for x, y in points:
        distance = math.hypot(x, y)
        if distance < 1e-3:  # where it is already
            continue
        bearing = math.atan2(y, x)
        line = next((b for b in needs if abs(math.remainder(b - bearing, math.tau)) <= SAME), None)
        line = bearing if line is None else line
        needs[line] = max(distance, needs.get(line, 0.0))
    if not needs:
        return True, observation.range
    lengths = observation.sense(list(needs))
    fits = all(far <= free - reserve for far, free in zip(needs.values(), lengths, strict=True))
    return fits, min(lengths)


def _towards(now: float, wanted: float, most: float) -> float:
    return max(now - most, min(wanted, now + most))
