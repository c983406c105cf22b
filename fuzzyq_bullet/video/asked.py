"""What a decision asks for, in words: a step and what is free, or a twist; not what is driven."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fuzzyq_bullet.drives.base import longest_step_time
from fuzzyq_bullet.planning.safety_filter import ROLLS
from fuzzyq_bullet.video.timeline import NO_DECISION, jumps, sensor_range

if TYPE_CHECKING:
    from fuzzyq_bullet.recording.trajectory import Trajectory

_NOTHING = "–"


def asks(trajectory: Trajectory, index: int) -> tuple[tuple[str, str], tuple[str, str]]:
    """Return two names with their values, of decision ``index``.

    Wheels drive a step as a speed, the longest at full speed: that is what is asked of them. The
    robot drives more slowly where it must brake for what is not known to be free. A planner of
    twists asks for no step.
    """
    decisions = trajectory.decisions
    name = "step asked" if jumps(trajectory) else "speed asked"
    if index == NO_DECISION:
        return (name, _NOTHING), ("known free", _NOTHING)
    if (twist := _twist(trajectory, index)) is not None:
        speed, rate = twist
        return ("speed asked", _speed(speed)), ("turn asked", turning(rate))
    step = float(decisions.step[index])
    if jumps(trajectory):
        return (name, metres(step)), _free(trajectory, index)
    robot = trajectory.scenario.robot
    speed = min(step / longest_step_time(robot), robot.max_speed)
    asked = _speed(-speed if _backs_up(trajectory, index) else speed)
    return (name, asked), _free(trajectory, index)


def _free(trajectory: Trajectory, index: int) -> tuple[str, str]:
    """Return what is known to be free along the heading decided, with its name.

    It is what the safety filter sensed there. The reach is another thing: the distance within which
    the wheels could stop, 0 where the robot must turn first. It is told if nothing else is.
    """
    guard, reach = (float(getattr(trajectory.decisions, one)[index]) for one in ("guard", "reach"))
    if math.isfinite(guard) and not _rolls_the_other_way(trajectory, index):
        beyond = guard >= sensor_range(trajectory) - 1e-9
        return "known free", f"{'> ' if beyond else ''}{metres(guard)}"
    if math.isfinite(reach) and not math.isfinite(guard):
        return ("known free", _NOTHING) if jumps(trajectory) else ("stops within", metres(reach))
    return "known free", "not checked"


def _rolls_the_other_way(trajectory: Trajectory, index: int) -> bool:
    """Whether the filter only stopped the robot, which rolled the other way; it sensed nothing."""
    speed = float(trajectory.ticks.speed[int(trajectory.decisions.tick[index])])
    return (-speed if _backs_up(trajectory, index) else speed) < -ROLLS


def _backs_up(trajectory: Trajectory, index: int) -> bool:
    backward = trajectory.decisions.backward
    return backward is not None and float(backward[index]) == 1.0


def _speed(speed: float) -> str:
    """Return a speed (m/s) in words."""
    return f"{round(speed, 2) + 0.0:.2f} m/s".replace("-", "−")


def turning(rate: float) -> str:
    """Return a turn rate (rad/s) in words."""
    degrees = round(math.degrees(abs(rate)))
    return "straight on" if degrees < 1 else f"{degrees}°/s {'left' if rate > 0 else 'right'}"


def nearest(trajectory: Trajectory) -> str:
    """Return what the clearance of a tick is called: of a robot that jumps, it is the least."""
    return "nearest in step" if jumps(trajectory) else "nearest thing"


def metres(length: float) -> str:
    """Return a length (m) in at most four signs and its unit; a nothing has no sign."""
    digits = 2 if length < 9.995 else 1 if length < 99.95 else 0
    return f"{round(length, digits) + 0.0:.{digits}f} m".replace("-", "−")


def _twist(trajectory: Trajectory, index: int) -> tuple[float, float] | None:
    speeds = trajectory.decisions.twist_speed
    if speeds is None or not math.isfinite(float(speeds[index])):
        return None
    return float(speeds[index]), float(trajectory.decisions.twist_turn_rate[index])
