"""Which obstacles of a scenario move, which stand, and the ways of those that move."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.scenario.places import Arena
from fuzzyq_bullet.shapes import Shape, Still
from fuzzyq_bullet.shapes.motion import Course, Surroundings

STREAM = 20
"""Where the streams of random numbers of the motions begin among those of the seed: obstacle i has
the stream (20, i) to itself."""
SAMPLE = 0.05
"""Time between two looks at a motion (s)."""
LONGEST = 60.0
"""How much of a motion is looked at (s)."""


def moves(obstacle: Shape) -> bool:
    """Return whether an obstacle has a motion."""
    return not isinstance(obstacle.motion, Still)


def standing(obstacles: Sequence[Shape]) -> tuple[Shape, ...]:
    """Return the obstacles that stand still, in their order."""
    return tuple(one for one in obstacles if not moves(one))


def movers(obstacles: Sequence[Shape]) -> tuple[int, ...]:
    """Return the indices of those that move."""
    return tuple(i for i, one in enumerate(obstacles) if moves(one))


def standing_field(obstacles: Sequence[Shape], arena: Arena) -> Field:
    """Return the geometry of what stands still; edges of the arena without walls count as walls."""
    return Field.of(standing(obstacles), arena.model_copy(update={"walls": True}))


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


def courses_of(obstacles: Sequence[Shape], arena: Arena, seed: int) -> dict[int, Course]:
    """Return the way of each obstacle that moves, by its index.

    Args:
        obstacles: All obstacles of a realised scenario.
        arena: Its arena.
        seed: Its seed.
    """
    field = standing_field(obstacles, arena)
    return {
        i: obstacles[i].motion.course(
            obstacles[i],
            Surroundings(
                field,
                np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(STREAM, i))),
            ),
        )
        for i in movers(obstacles)
    }
