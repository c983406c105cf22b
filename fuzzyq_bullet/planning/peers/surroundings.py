"""What the peers share: their two common keys, and what the rays of one instant have hit."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, Strict

from fuzzyq_bullet.planning.base import LONGEST_STRIDE, Floats, Observation
from fuzzyq_bullet.planning.commands import CommandSettings
from fuzzyq_bullet.planning.scan import ray_headings

TOUCHING = 1e-3
"""What stands nearer than the disc's edge is taken to be this much beyond it (m): nothing that the
robot stands beside already may stop it."""


class PeerSettings(CommandSettings):
    """The keys that all peers have: how often they decide, and the safety filter."""

    guard: Annotated[bool, Strict()] = Field(
        default=True,
        description="Whether the safety filter limits what it answers to what is free.",
    )


@dataclass(frozen=True, slots=True)
class Surroundings:
    """One scan by single rays, as many as the other planners have, evenly spaced all around.

    Attributes:
        headings: World headings of the rays (rad), shape (K,).
        distances: How far each of them got (m), shape (K,).
        met: Whether it met something, shape (K,).
        radius: Radius of the disc that must stay free of what was met (m).
        reserve: Free distance that is never used up, for the sensor's noise (m).
    """

    headings: Floats
    distances: Floats
    met: NDArray[np.bool_]
    radius: float
    reserve: float

    @property
    def points(self) -> Floats:
        """Where the rays met something, seen from the robot, world axes (m), shape (H, 2)."""
        headings, distances = self.headings[self.met], self.distances[self.met]
        points: Floats = distances[:, None] * np.column_stack([np.cos(headings), np.sin(headings)])
        return points

    @property
    def clearances(self) -> Floats:
        """Distance (m) from the disc's edge to what each ray met, at least 1 mm; shape (K,)."""
        return np.maximum(self.distances - self.radius - self.reserve, TOUCHING)


def look_around(observation: Observation) -> Surroundings:
    """Cast single rays in all directions: 120, or 720 where the robot sees farther than usual."""
    headings, _ = ray_headings(observation)
    distances = observation.look(headings)
    met = distances < observation.range + observation.radius - 1e-9
    return Surroundings(
        np.array(headings), distances, met, observation.radius, observation.uncertainty
    )


def to_goal(observation: Observation) -> tuple[float, float]:
    """Return the heading (rad) and the distance (m) of the next via point, or of the goal."""
    (x, y), (goal_x, goal_y) = observation.position, observation.goal
    return math.atan2(goal_y - y, goal_x - x), math.dist((x, y), (goal_x, goal_y))


def full_step(observation: Observation) -> float:
    """Return the step (m) that wheels drive at their greatest speed: the longest of Eq. 17."""
    return LONGEST_STRIDE * observation.unit
