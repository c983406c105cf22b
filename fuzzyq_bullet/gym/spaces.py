"""What is seen, as numbers between fixed bounds: one float32 vector for a policy to read."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

if TYPE_CHECKING:
    from fuzzyq_bullet.planning import Observation
    from fuzzyq_bullet.scenario import Robot

Vector: TypeAlias = NDArray[np.float32]

HALFWAY = 5.0
"""Distance (m) that is told as a half."""


def box_of(lows: Mapping[str, float]) -> Box:
    """Return the space of vectors whose elements have these least values and go up to 1."""
    low = np.array(list(lows.values()), dtype=np.float32)
    return Box(low, np.ones_like(low))


def vector_of(seen: Mapping[str, float], lows: Mapping[str, float]) -> Vector:
    """Return what is seen as a vector in the order of ``lows``, each element within its bounds.

    A wheel that swings past its speed by a thousandth must not leave the space.
    """
    values = [seen[name] for name in lows]
    return np.clip(values, list(lows.values()), 1.0).astype(np.float32)


def goal_seen(observation: Observation) -> dict[str, float]:
    """Return where the goal is as the robot faces, and how far away.

    The distance d is told as d / (d + ``HALFWAY``): below 1 however large the arena, and finest
    where the robot must stop.
    """
    x, y = np.subtract(observation.goal, observation.position).tolist()
    aside = math.atan2(y, x) - observation.heading
    distance = math.hypot(x, y)
    return {
        "goal_ahead": math.cos(aside),
        "goal_left": math.sin(aside),
        "goal_distance": distance / (distance + HALFWAY),
    }


def motion_seen(observation: Observation, robot: Robot) -> dict[str, float]:
    """Return how fast the robot moves, as parts of the greatest speed and turn rate."""
    return {
        "speed": observation.speed / robot.max_speed,
        "turn_rate": observation.turn_rate / robot.max_turn_rate,
    }
