"""The planner ``apf``: an artificial potential field with the usual cures.

- *Field*: O. Khatib, Real-time obstacle avoidance for manipulators and mobile robots,
  International Journal of Robotics Research 5(1), 1986. The goal attracts: parabolic near it, conic
  farther away. Whatever is nearer than ρ0 repels by F = η·(1/ρ - 1/ρ0)/ρ², here in units of ρ0 and
  averaged over the rays, so that a wall repels by the angle that it fills.
- *Goals beside obstacles* (GNRON): S. S. Ge, Y. J. Cui, New potential functions for mobile robot
  path planning, IEEE Transactions on Robotics and Automation 16(5), 2000. The repulsive potential
  is multiplied by gⁿ, n = 2, where g falls with the distance to the goal; its gradient has a second
  part towards the goal. Here g = min(1, distance / ρ0): farther away the field is Khatib's, where
  the paper's would grow without bound.
- *Local minima*: X. Yun, K.-C. Tan, A wall-following method for escaping local minima in
  potential field based motion planning, International Conference on Advanced Robotics, 1997. If the
  robot has come no nearer to the goal for some time, it follows the wall that holds it up. It goes
  back to the field once it is nearer to the goal than where it was trapped, and the goal's
  direction is free. If it is trapped there again, or the escape takes too long, it tries the other
  side.

ρ is measured from the edge of the robot's disc. The force is a velocity: its direction is the
heading, its size up to 1 the part of the greatest speed. Left out: Khatib's damping and inertia,
which the velocity controller of the wheels has. Known to remain: passages between obstacles that
repel each other's side, and oscillation in narrow corridors (Koren and Borenstein 1991).

Tuning (docs/results/peers.md): of 20 settings on 24 training fields two are best; on 96 more they
reach as many goals in as much time. These are the defaults of before.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, Literal, NamedTuple

import numpy as np
from pydantic import Field, Strict

from fuzzyq_bullet.planning.base import Floats, Observation
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.planning.peers.surroundings import (
    PeerSettings,
    Surroundings,
    full_step,
    look_around,
    to_goal,
)
from fuzzyq_bullet.planning.peers.wall_following import ahead, follow_wall
from fuzzyq_bullet.planning.scan import Point
from fuzzyq_bullet.quantities import Number

PROGRESS = 0.05
"""Nearer to the goal by this much (m) is progress."""

_Positive = Annotated[Number, Field(gt=0.0, le=1000.0)]


class ApfSettings(PeerSettings):
    """An artificial potential field (Khatib 1986), with cures for its goals and its minima."""

    name: Literal["apf"] = "apf"
    repulsion: _Positive = Field(default=0.02, description="η: weight of what repels.")
    influence: Annotated[Number, Field(gt=0.0, le=10.0)] = Field(
        default=0.4, description="ρ0: what is farther from the robot's edge does not repel (m)."
    )
    slow_within: _Positive = Field(
        default=0.3, description="Nearer to the goal it attracts less (m)."
    )
    gnron: Annotated[bool, Strict()] = Field(
        default=True, description="Whether what stands beside the goal repels less (Ge, Cui 2000)."
    )
    escape: Annotated[bool, Strict()] = Field(
        default=True, description="Whether it follows walls out of minima (Yun, Tan 1997)."
    )
    patience: _Positive = Field(
        default=3.0, description="Without progress for so long it is trapped (s)."
    )
    enough: Annotated[Number, Field(gt=0.0, le=10.0)] = Field(
        default=0.3,
        description="Along a wall it takes the first heading with so much free (m, for the usual "
        "robot).",
    )
    longest: _Positive = Field(
        default=60.0, description="An escape that takes longer tries the other side (s)."
    )

    def doubts(self) -> Iterator[tuple[str, str]]:
        """Yield what is allowed and yet hardly meant."""
        yield from super().doubts()
        for key in ("patience", "enough", "longest"):
            if not self.escape and key in self.model_fields_set:
                yield key, "is of no effect: escape is false"


class Trap(NamedTuple):
    """Where the robot was trapped.

    Attributes:
        at: Its position (m).
        left: Distance to the goal there (m).
        side: +1 if it passes the wall on its left: the wall is on the robot's right; else -1.
        since: Time at which the escape began (s).
        contact: The point of the wall that stopped the robot last (m).
    """

    at: tuple[float, float]
    left: float
    side: int
    since: float
    contact: Point


class ApfPlanner:
    """Goes down the potential, and along walls out of its minima."""

    def __init__(self, settings: ApfSettings) -> None:
        self._settings = settings
        self._goal: tuple[float, float] | None = None
        self._nearest, self._nearest_at = math.inf, 0.0
        self._trap: Trap | None = None
        self._escaping = False

    def decide(self, observation: Observation, /) -> Decision:
        """Return a step along the force."""
        around = look_around(observation)
        goal, left = to_goal(observation)
        self._watch(observation, around, goal, left)
        if self._escaping:
            return self._escape(observation)
        force = force_of(around, goal, left, self._settings)
        size = math.hypot(*force)
        heading = math.atan2(force[1], force[0]) if size > 0.0 else observation.heading
        return Decision(
            heading,
            min(1.0, size) * full_step(observation),
            aim=observation.goal,
        )

    def _watch(
        self, observation: Observation, around: Surroundings, goal: float, left: float
    ) -> None:
        """Begin and end escapes."""
        settings, now = self._settings, observation.time
        if observation.goal != self._goal:
            self._goal, self._trap, self._escaping = observation.goal, None, False
            self._nearest = math.inf
        if left < self._nearest - PROGRESS:
            self._nearest, self._nearest_at = left, now
        if not settings.escape:
            return
        patient = settings.patience * observation.slowness
        if self._escaping:
            trap = self._trap
            assert trap is not None
            if left < trap.left - PROGRESS and self._is_free(around, goal, left):
                self._escaping = False
                self._nearest, self._nearest_at = left, now
            elif now - trap.since > settings.longest * observation.slowness:
                self._trap = trap._replace(side=-trap.side, since=now)
        elif now - self._nearest_at > patient and around.met.any():
            self._trap = self._trapped(observation, around, goal)
            self._escaping = True

    def _trapped(self, observation: Observation, around: Surroundings, goal: float) -> Trap:
        """Return the trap that the robot is in, and the side that it takes out of it."""
        wall = int(np.argmin(around.distances))
        heading, distance = float(around.headings[wall]), float(around.distances[wall])
        contact = ahead(observation.position, heading, distance)
        before = self._trap
        if before is not None:
            near = math.dist(before.at, observation.position) < self._settings.influence
            side = -before.side if near else before.side
        else:  # the wall lies to the right of the goal's direction: pass it on the left
            off = math.remainder(goal - heading, math.tau)
            side = int(math.copysign(1.0, off))
        left = math.dist(observation.position, observation.goal)
        return Trap(observation.position, left, side, observation.time, contact)

    def _is_free(self, around: Surroundings, goal: float, left: float) -> bool:
        """Return whether nothing repels from the goal's direction."""
        off = np.abs(np.angle(np.exp(1j * (around.headings - goal))))
        ahead = around.clearances[(off < math.radians(30.0)) & around.met]
        return bool(ahead.min(initial=np.inf) > min(left, self._settings.influence))

    def _escape(self, observation: Observation) -> Decision:
        """Return a step along the wall."""
        trap = self._trap
        assert trap is not None
        found = follow_wall(observation, trap.contact, trap.side, self._settings.enough)
        heading = observation.heading
        if found is not None:
            heading, contact = found
            self._trap = trap._replace(contact=contact)
        step = 0.0 if found is None else full_step(observation)
        return Decision(heading, step, mode="breakout", aim=trap.contact, target=trap.at)


def force_of(
    around: Surroundings, goal: float, left: float, settings: ApfSettings
) -> tuple[float, float]:
    """Return the force of the field, x and y of the world; the conic attraction has size 1.

    Args:
        around: What the robot sees.
        goal: Heading of the goal (rad).
        left: Distance to it (m).
        settings: ρ0, η, and whether Ge and Cui's potential counts.
    """
    reach = settings.influence
    towards = np.array([math.cos(goal), math.sin(goal)])
    attraction = towards * min(1.0, left / settings.slow_within)
    rho = around.clearances / reach
    close = around.met & (rho < 1.0)
    excess = np.where(close, 1.0 / np.minimum(rho, 1.0) - 1.0, 0.0)
    g = min(1.0, left / reach) if settings.gnron else 1.0
    away = -np.column_stack([np.cos(around.headings), np.sin(around.headings)])
    size = settings.repulsion * excess / rho**2 * g**2
    force: Floats = attraction + (size[:, None] * away).mean(axis=0)
    if g < 1.0:
        force = force + settings.repulsion * float((excess**2).mean()) * g * towards
    return float(force[0]), float(force[1])
