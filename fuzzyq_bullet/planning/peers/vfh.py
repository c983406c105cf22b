"""The planner ``vfh``: VFH+ of Ulrich and Borenstein (1998).

I. Ulrich, J. Borenstein: VFH+: reliable obstacle avoidance for fast mobile robots. IEEE
International Conference on Robotics and Automation, 1998. Each decision goes through its stages:

1. *Certainty grid*: a window of square cells moves with the robot. A cell that a ray hits becomes
   more certain, one that a ray passes less.
2. *Primary polar histogram*: each cell adds m = c²·(a - b·d²) to all sectors within
   γ = arcsin(r_rs / d) of its bearing, where r_rs is the robot's radius and a safety distance.
   a and b are such that m = c² at the rim of the window.
3. *Binary histogram*: a sector becomes blocked above τ_high, free below τ_low, and else stays what
   it was (hysteresis).
4. *Masked histogram*: while the robot moves, what stands within the circle of its tightest turn, of
   radius v/ω, blocks what lies beyond it.
5. *Candidates*: the middle of a narrow opening; the two edges of a wide one, half of its least
   width inside, and the goal's direction if it lies between them.
6. *Cost*: μ1·Δ(c, goal) + μ2·Δ(c, where it faces) + μ3·Δ(c, what was chosen before); least wins.

The paper leaves the speed to the vehicle; here it is that of the first VFH (Borenstein and Koren
1991): less by the density of the direction taken. What is different here: the robot turns on the
spot, so nothing is masked at rest, and if everything is masked it stops and turns. If every sector
is blocked it creeps to the least dense. Cells behind the goal do not count, because a wall behind
it would close the way into it. The paper's grid is filled by sonar over a longer time; here 120
rays fill it at once.

Tuning (docs/results/peers.md): the cost is the paper's. The rest is the best of 20 settings
on 24 training fields: 20 goals reached within 90 s, in 35.2 s on average.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, ValidationInfo, field_validator
from pydantic_core import PydanticCustomError

from fuzzyq_bullet.planning.base import Floats, Observation
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.planning.peers.surroundings import (
    PeerSettings,
    Surroundings,
    full_step,
    look_around,
    to_goal,
)
from fuzzyq_bullet.quantities import Number

SECTORS = 72
"""Sectors of the histogram: α = 5°, the paper's."""
ALPHA = math.tau / SECTORS
CERTAIN = 3
"""A cell is certain after so many hits."""
SLOWEST = 0.2
"""The robot never goes slower than this part of its greatest speed, unless it stops."""
MOVING = 0.02
"""Slower than this (m/s) it can turn on the spot."""

Bools = NDArray[np.bool_]
_Share = Annotated[Number, Field(ge=0.0, le=1000.0)]


class VfhSettings(PeerSettings):
    """VFH+ of Ulrich and Borenstein (1998)."""

    name: Literal["vfh"] = "vfh"
    safety: Annotated[Number, Field(ge=0.0, le=1.0)] = Field(
        default=0.05, description="r_s: distance to keep besides half a detection line (m)."
    )
    high: _Share = Field(default=8.0, description="τ_high: a sector above it becomes blocked.")
    low: _Share = Field(default=1.0, description="τ_low: a sector below it becomes free.")
    steepness: _Share = Field(
        default=10.0, description="How much more a near cell counts than one at the rim."
    )
    wide: Annotated[int, Field(strict=True, ge=2, le=SECTORS)] = Field(
        default=8, description="s_max: an opening of more sectors is wide."
    )
    goal_cost: _Share = Field(default=5.0, description="μ1: cost of a sector off the goal.")
    turn_cost: _Share = Field(default=2.0, description="μ2: of one off where it faces.")
    change_cost: _Share = Field(default=2.0, description="μ3: of one off what it chose before.")
    dense: Annotated[Number, Field(gt=0.0, le=1000.0)] = Field(
        default=40.0, description="h_m: at this density of the direction taken it goes slowest."
    )

    @field_validator("low")
    @classmethod
    def _below_high(cls, value: float, info: ValidationInfo) -> float:
        high = info.data.get("high")
        if high is not None and value > high:
            raise PydanticCustomError("low", "must be at most high, {high}", {"high": high})
        return value

    @field_validator("change_cost")
    @classmethod
    def _one_costs(cls, value: float, info: ValidationInfo) -> float:
        others = [info.data.get(key) for key in ("goal_cost", "turn_cost")]
        if value == 0.0 and others == [0.0, 0.0]:
            raise PydanticCustomError(
                "costs", "goal_cost, turn_cost and change_cost are all 0: one must be greater"
            )
        return value

    def doubts(self) -> Iterator[tuple[str, str]]:
        """Yield what is allowed and yet hardly meant: the paper demands μ1 > μ2 + μ3."""
        yield from super().doubts()
        rest = self.turn_cost + self.change_cost
        if self.goal_cost <= rest:
            yield (
                "goal_cost",
                f"{self.goal_cost:g} is not greater than turn_cost + change_cost, {rest:g}: the "
                "robot may pass by the goal",
            )


class CertaintyGrid:
    """How certain it is that something stands in each cell of a window about the robot.

    Args:
        cell: Side of a cell (m).
        reach: The window reaches so far in each of the four directions (m).
    """

    def __init__(self, cell: float, reach: float) -> None:
        self._cell = cell
        self._half = math.ceil(reach / cell)
        self._hits = np.zeros((2 * self._half + 1,) * 2, dtype=np.int64)
        self._middle: NDArray[np.int64] | None = None

    def add(self, position: tuple[float, float], around: Surroundings) -> None:
        """Move the window to where the robot is (m), and add what its rays have met and passed."""
        middle = np.floor(np.array(position) / self._cell).astype(np.int64)
        self._move(middle)
        every = np.arange(0.5 * self._cell, around.distances.max(), self._cell)
        directions = np.column_stack([np.cos(around.headings), np.sin(around.headings)])
        before = every[None, :] < around.distances[:, None] - self._cell
        passed = (every[None, :, None] * directions[:, None, :])[before]
        hit = np.zeros_like(self._hits, dtype=bool)
        free = np.zeros_like(hit)
        hit[self._cells(around.points, position)] = True
        free[self._cells(passed, position)] = True
        self._hits += hit
        self._hits -= free & ~hit
        np.clip(self._hits, 0, CERTAIN, out=self._hits)

    def occupied(self, position: tuple[float, float]) -> tuple[Floats, Floats]:
        """Return where cells are not empty, seen from the robot (m), (N, 2); how certain, (N,)."""
        assert self._middle is not None
        at = np.argwhere(self._hits)
        centres = (at - self._half + self._middle + 0.5) * self._cell - np.array(position)
        return centres, self._hits[tuple(at.T)] / CERTAIN

    def _move(self, middle: NDArray[np.int64]) -> None:
        if self._middle is not None and (middle != self._middle).any():
            moved = np.zeros_like(self._hits)
            size, (dx, dy) = len(self._hits), (middle - self._middle).tolist()
            if abs(dx) < size and abs(dy) < size:
                into = tuple(slice(max(0, -d), size - max(0, d)) for d in (dx, dy))
                out_of = tuple(slice(max(0, d), size - max(0, -d)) for d in (dx, dy))
                moved[into] = self._hits[out_of]
            self._hits = moved
        self._middle = middle

    def _cells(self, points: Floats, position: tuple[float, float]) -> tuple[Floats, ...]:
        at = np.floor((points + np.array(position)) / self._cell).astype(np.int64)
        at = at - self._middle + self._half
        within = ((at >= 0) & (at < len(self._hits))).all(axis=1)
        return tuple(at[within].T)


class VfhPlanner:
    """Steers to the cheapest opening of a polar histogram."""

    def __init__(self, settings: VfhSettings) -> None:
        self._settings = settings
        self._grid: CertaintyGrid | None = None
        self._blocked = np.zeros(SECTORS, dtype=bool)
        self._chosen: float | None = None

    def decide(self, observation: Observation, /) -> Decision:
        """Return the next heading and speed."""
        settings, position = self._settings, observation.position
        around = look_around(observation)
        reach = observation.range + observation.radius
        if self._grid is None:
            self._grid = CertaintyGrid(observation.unit / 4.0, reach)
        self._grid.add(position, around)
        goal, left = to_goal(observation)
        wide = around.radius + settings.safety + around.reserve
        points, certain = self._grid.occupied(position)
        near = np.hypot(points[:, 0], points[:, 1]) < min(reach, left + wide)
        points, certain = points[near], certain[near]

        density = polar_histogram(points, certain, wide, reach, settings.steepness)
        self._blocked = np.where(
            density > settings.high, True, np.where(density < settings.low, False, self._blocked)
        )
        masked = self._blocked | self._mask(observation, points, wide)
        stop = bool(masked.all()) and not self._blocked.all()
        candidates = candidates_of(self._blocked if stop else masked, goal, settings.wide)
        if candidates:
            before = observation.heading if self._chosen is None else self._chosen
            heading = min(candidates, key=lambda one: self._cost(one, goal, observation, before))
            dense = min(density[_sector(heading)], settings.dense) / settings.dense
            part = 0.0 if stop else max(SLOWEST, 1.0 - dense)
        else:
            heading, part = float(np.argmin(density)) * ALPHA, SLOWEST
        self._chosen = heading
        step = part * full_step(observation)
        return Decision(heading, step, aim=observation.goal)

    def _mask(self, observation: Observation, points: Floats, wide: float) -> Bools:
        """Return the sectors that the robot cannot turn into at its speed, shape (72,)."""
        masked = np.zeros(SECTORS, dtype=bool)
        motion, facing = observation.motion, observation.heading
        if motion is None or observation.speed < MOVING or not len(points):
            return masked
        tightest = observation.speed / motion.max_turn_rate
        off = np.angle(np.exp(1j * (np.arctan2(points[:, 1], points[:, 0]) - facing)))
        far = np.hypot(points[:, 0], points[:, 1])
        x, y = far * np.cos(off), far * np.sin(off)
        left = off[(off >= 0.0) & (np.hypot(x, y - tightest) < tightest + wide)]
        right = off[(off <= 0.0) & (np.hypot(x, y + tightest) < tightest + wide)]
        sectors = np.angle(np.exp(1j * (np.arange(SECTORS) * ALPHA - facing)))
        beyond: Bools = sectors > left.min(initial=math.pi)
        beyond |= sectors < right.max(initial=-math.pi)
        return beyond

    def _cost(self, one: float, goal: float, seen: Observation, before: float) -> float:
        settings = self._settings
        return (
            settings.goal_cost * _apart(one, goal)
            + settings.turn_cost * _apart(one, seen.heading)
            + settings.change_cost * _apart(one, before)
        )


def polar_histogram(
    points: Floats, certain: Floats, radius: float, reach: float, steepness: float
) -> Floats:
    """Return the density of each sector, world axes, shape (72,).

    Args:
        points: Cells that are not empty, seen from the robot (m), shape (N, 2).
        certain: c of each, from 0 to 1, shape (N,).
        radius: r_rs, by which each is enlarged (m).
        reach: Radius of the window (m), where m = c².
        steepness: How much more a cell at the robot would count, in c².
    """
    far = np.hypot(points[:, 0], points[:, 1])
    counts = certain**2 * (1.0 + steepness * np.maximum(0.0, 1.0 - (far / reach) ** 2))
    bearing = np.arctan2(points[:, 1], points[:, 0])
    enlarged = np.arcsin(np.minimum(1.0, radius / np.maximum(far, 1e-6)))
    sectors = np.arange(SECTORS)[:, None] * ALPHA
    off = np.abs(np.angle(np.exp(1j * (sectors - bearing[None, :]))))
    density: Floats = np.where(off <= enlarged[None, :], counts[None, :], 0.0).sum(axis=1)
    return density


def candidates_of(blocked: Bools, goal: float, wide: int) -> list[float]:
    """Return the candidate headings (rad) of all openings.

    Args:
        blocked: Whether each sector is, shape (72,).
        goal: Heading of the goal (rad).
        wide: s_max: an opening of more sectors is wide.
    """
    if not blocked.any():
        return [goal]
    found: list[float] = []
    start = int(np.argmax(blocked))
    around = np.roll(blocked, -start)
    edges = np.flatnonzero(np.diff(np.append(around, True).astype(int)))
    for last, end in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        right, size = start + last + 1, end - last
        if size <= wide:
            found.append((right + (size - 1) / 2.0) * ALPHA)
            continue
        inner, span = (right + wide / 2.0) * ALPHA, (size - 1 - wide) * ALPHA
        found += [inner, inner + span]
        if (goal - inner) % math.tau <= span:
            found.append(goal)
    return found


def _sector(heading: float) -> int:
    return round(heading / ALPHA) % SECTORS


def _apart(one: float, other: float) -> float:
    """Return the angle between two headings, in sectors."""
    return abs(math.remainder(one - other, math.tau)) / ALPHA
