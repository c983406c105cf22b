"""The ways of the obstacles that move; a motion may be anybody's, so its poses are checked."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import numpy as np

from fuzzyq_bullet.errors import MotionError, UserError
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.scenario.movers import movers, standing_field
from fuzzyq_bullet.scenario.places import Arena
from fuzzyq_bullet.shapes import Pose, Shape
from fuzzyq_bullet.shapes.motion import Course, Surroundings
from fuzzyq_bullet.wording import error_in_words, shorten

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
    if told is None or (isinstance(told, int | float) and 0.0 <= told < math.inf):
        return told
    raise _error(obstacle, f"top_speed must return a speed (m/s) or None, not {shorten(told)}")


class _Checked:
    """A course whose poses are finite numbers, or else one line says what they are."""

    def __init__(self, obstacle: Shape, course: Course) -> None:
        self._obstacle, self._course = obstacle, course

    def pose(self, time: float, /) -> Pose:
        try:
            pose = self._course.pose(time)
        except Exception as error:  # of a motion of the user's own
            raise _stopped(self._obstacle, error, f"in pose({time:g})") from error
        try:
            if math.isfinite(sum(pose)) and len(pose) == 3:
                return pose
        except TypeError:
            pass
        what = "must return Pose(x, y, yaw), three finite numbers"
        raise _error(self._obstacle, f"pose({time:g}) {what}, not {shorten(pose)}")


@contextmanager
def _blamed(obstacle: Shape, when: str) -> Iterator[None]:
    """Turn whatever a motion raises into one line that blames it."""
    try:
        yield
    except UserError:
        raise
    except Exception as error:  # of a motion of the user's own
        raise _stopped(obstacle, error, when) from error


def _stopped(obstacle: Shape, error: Exception, when: str) -> MotionError:
    return _error(obstacle, f"stopped by {error_in_words(error)}, {when}")


def _error(obstacle: Shape, what: str) -> MotionError:
    return MotionError(f"motion {obstacle.motion.kind}: {what}")
