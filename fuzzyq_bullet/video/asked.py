"""What a decision asks for, in words: a step and what is free, or a twist; not what is driven."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fuzzyq_bullet.video.timeline import NO_DECISION

if TYPE_CHECKING:
    from fuzzyq_bullet.recording.trajectory import Trajectory

_NOTHING = "–"


def asks(trajectory: Trajectory, index: int) -> tuple[tuple[str, str], tuple[str, str]]:
    """Return two names with their values, of decision ``index``.

    The step that a planner asks for may be longer than what is driven until its next decision; the
    robot brakes for what is not known to be free. A planner of twists asks for no step.
    """
    decisions = trajectory.decisions
    if index == NO_DECISION:
        return ("step asked", _NOTHING), ("known free", _NOTHING)
    if (twist := _twist(trajectory, index)) is not None:
        speed, rate = twist
        return ("speed asked", f"{speed:.2f} m/s".replace("-", "−")), ("turn asked", turning(rate))
    reach = float(decisions.reach[index])
    free = metres(reach) if math.isfinite(reach) else "not checked"
    return ("step asked", metres(float(decisions.step[index]))), ("known free", free)


def turning(rate: float) -> str:
    """Return a turn rate (rad/s) in words."""
    degrees = round(math.degrees(abs(rate)))
    return "straight on" if degrees < 1 else f"{degrees}°/s {'left' if rate > 0 else 'right'}"


def metres(length: float) -> str:
    """Return a length (m) in at most four signs and its unit."""
    return f"{length:.{2 if length < 9.995 else 1 if length < 99.95 else 0}f} m"


def _twist(trajectory: Trajectory, index: int) -> tuple[float, float] | None:
    speeds = trajectory.decisions.twist_speed
    if speeds is None or not math.isfinite(float(speeds[index])):
        return None
    return float(speeds[index]), float(trajectory.decisions.twist_turn_rate[index])
