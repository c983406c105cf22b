"""The ways of the obstacles that move; a motion may be anybody's, so its poses are checked."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import AbstractContextManager
from numbers import Real

import numpy as np

from fuzzyq_bullet.blame import blame, blamed
from fuzzyq_bullet.columns import FAR
from fuzzyq_bullet.errors import MotionError
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.scenario.movers import movers, standing_field
from fuzzyq_bullet.scenario.places import Arena
from fuzzyq_bullet.shapes import Pose, Shape
from fuzzyq_bullet.shapes.motion import Course, Surroundings
from fuzzyq_bullet.wording import shorten

STREAM = 20
"""Where the streams of random numbers of the motions begin among those of the seed: obstacle i has
the stream (20, i) to itself."""
SAMPLE = 0.05
"""Time between two looks at a motion (s)."""
LONGEST = 60.0
"""How much of a motion is looked at (s)."""


def courses_of(obstacles: Sequence[Shape], arena: Arena, seed: int) -> dict[int, Course]:
    """Return the way of each obstacle that moves, by its index.

    Args:
        obstacles: All obstacles of a realised scenario.
        arena: Its arena.
        seed: Its seed.

    Raises:
        MotionError: If a motion has no course; its poses may raise it, too.
    """
    field = standing_field(obstacles, arena)
    return {i: course_of(i, obstacles[i], field, seed) for i in movers(obstacles)}


def course_of(index: int, obstacle: Shape, standing: Field, seed: int) -> Course:
    """Return the way of one obstacle.

    Args:
        index: Which of the scenario's obstacles it is.
        obstacle: The obstacle.
        standing: All that stands still (``standing_field``).
        seed: Seed of the scenario.

    Raises:
        MotionError: If its motion has no course; its poses may raise it, too.
    """
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(STREAM, index)))
    with _blamed(obstacle, "as its course began"):
        course = obstacle.motion.course(obstacle, Surroundings(standing, rng))
    return _Checked(obstacle, course)


def fastest(course: Course, extent: float, time: float) -> float:
    """Return the greatest speed (m/s) of any part of an obstacle, as far as it is looked at.

    Args:
        course: Its way.
        extent: Radius of the circle that holds all of it (m).
        time: Until when (s); at most a minute is looked at.
    """
    times = np.arange(0.0, min(time, LONGEST) + SAMPLE, SAMPLE).tolist()
    steps = np.diff(np.array([course.pose(t) for t in times]), axis=0)
    turned = np.abs(np.remainder(steps[:, 2] + np.pi, 2.0 * np.pi) - np.pi)
    return float((np.hypot(steps[:, 0], steps[:, 1]) + extent * turned).max(initial=0.0)) / SAMPLE


def told_top_speed(obstacle: Shape) -> float | None:
    """Return the top speed (m/s) that the obstacle's motion tells, if it tells one.

    Raises:
        MotionError: If that is no speed.
    """
    with _blamed(obstacle, "in top_speed"):
        told = obstacle.motion.top_speed(obstacle)
    if told is None:
        return None
    if isinstance(told, Real) and 0.0 <= told < math.inf:  # numpy's numbers are real, too
        return float(told)
    raise _error(obstacle, f"top_speed must return a speed (m/s) or None, not {shorten(told)}")


def conflicts_of(obstacle: Shape, standing: Field) -> list[tuple[str, str]]:
    """Return what the obstacle's motion finds wrong with itself; see ``Motion.conflicts``.

    Args:
        obstacle: The obstacle.
        standing: All that stands still (``standing_field``).

    Raises:
        MotionError: If it raises, or returns something else.
    """
    with _blamed(obstacle, "in conflicts"):
        told = obstacle.motion.conflicts(obstacle, standing)
    try:
        found = [(key, why) for key, why in told]
        if all(isinstance(part, str) for one in found for part in one):
            return found
    except (TypeError, ValueError):
        pass
    what = "must return a list of keys and messages"
    raise _error(obstacle, f"conflicts {what}, not {shorten(told)}")


class _Checked:
    """A course whose poses are finite numbers, or else one line says what they are."""

    def __init__(self, obstacle: Shape, course: Course) -> None:
        self._obstacle, self._course = obstacle, course

    def pose(self, time: float, /) -> Pose:
        try:
            pose = self._course.pose(time)
        except BaseException as error:
            blame(error, _name(self._obstacle), f"in pose({time:g})", MotionError)
        try:
            x, y, yaw = map(float, pose)
            if abs(x) + abs(y) + abs(yaw) < FAR:  # not so if one is not a number
                return Pose(x, y, yaw)
        except (TypeError, ValueError, OverflowError):
            pass
        what = f"must return Pose(x, y, yaw), three numbers below {FAR:g}"
        raise _error(self._obstacle, f"pose({time:g}) {what}, not {shorten(pose)}")


def _name(obstacle: Shape) -> str:
    return f"motion {obstacle.motion.kind}"


def _blamed(obstacle: Shape, when: str) -> AbstractContextManager[None]:
    """Turn whatever a motion raises into one line that blames it."""
    return blamed(_name(obstacle), when, MotionError)


def _error(obstacle: Shape, what: str) -> MotionError:
    return MotionError(f"{_name(obstacle)}: {what}")
