"""What the robot touched, in words: the same ones for every door."""

from __future__ import annotations

from fuzzyq_bullet.scenario.models import Scenario
from fuzzyq_bullet.trajectory import Trajectory


def collision_text(trajectory: Trajectory, listed: int) -> str:
    """Say what the robot touched, where and when; nothing if it touched nothing.

    Args:
        trajectory: The record of the run.
        listed: How many of its obstacles, the first ones, are in the scenario file.
    """
    collision = trajectory.collision
    if collision is None:
        return ""
    what = name_of(trajectory.scenario, collision.obstacle, listed)
    return touch_in_words(what, collision.point, collision.time)


def name_of(scenario: Scenario, index: int, listed: int) -> str:
    """Return what an obstacle is called.

    Args:
        scenario: A realised scenario.
        index: Which of its obstacles; −1 for a wall.
        listed: How many of them, the first ones, are in the scenario file.
    """
    if index < 0:
        return "a wall"
    drawn = "" if index < listed else " (drawn)"
    return f"the {scenario.obstacles[index].shape} obstacles[{index}]{drawn}"


def touch_in_words(what: str, point: tuple[float, float], time: float, place: str = "") -> str:
    """Say what was touched, where and when.

    Args:
        what: Its name.
        point: Where the two touched (m).
        time: When (s).
        place: Where the file has it.
    """
    x, y = (plain(value, 2) for value in point)
    noted = f" ({place})" if place else ""
    return f"touched {what}{noted} at ({x}, {y}) after {time:.2f} s"


def plain(value: float, digits: int) -> str:
    """Return a number with so many digits, and no negative zero."""
    return f"{round(float(value), digits) + 0.0:.{digits}f}"
