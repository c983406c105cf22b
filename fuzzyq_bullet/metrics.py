"""Figures of one run, taken from its trajectory alone."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict

from fuzzyq_bullet.planning import MODES
from fuzzyq_bullet.trajectory import Outcome, Trajectory


class ModeCounts(BaseModel):
    """Decisions taken in each mode."""

    model_config = ConfigDict(frozen=True)

    routine: int
    breakout: int
    following: int


class Result(BaseModel):
    """What a run came to: the contents of ``NAME.json`` and of ``--json``.

    Attributes:
        scenario: Name of the scenario.
        planner: Name of the planner.
        drive: ``wheels`` or ``kinematic``.
        seed: Seed of the run.
        outcome: ``goal``, ``collision``, ``timeout`` or ``stuck``.
        steps: Steps of the simulation: physics steps with wheels, moves (Eq. 17) without.
        decisions: Decisions of the planner.
        time_s: Simulated time (s).
        path_length_m: Length of the driven path (m).
        shortest_path_m: Length of the shortest path there is (m); null until it is computed.
        spl: Success weighted by path length; null until the shortest path is computed.
        min_clearance_m: Least distance to anything (m); null when nothing came near.
        collisions: Contacts: 0, or 1, since the first one ends the run.
        turning_rad: Sum of all changes of direction, left and right (rad).
        modes: Decisions in each mode.
        digest: Hash of the exact trajectory.
        version: Version of fuzzyq_bullet.
    """

    model_config = ConfigDict(frozen=True)

    scenario: str
    planner: str
    drive: Literal["wheels", "kinematic"]
    seed: int
    outcome: Outcome
    steps: int
    decisions: int
    time_s: float
    path_length_m: float
    shortest_path_m: float | None
    spl: float | None
    min_clearance_m: float | None
    collisions: int
    turning_rad: float
    modes: ModeCounts
    digest: str
    version: str


def result_of(trajectory: Trajectory) -> Result:
    """Return the figures of a run."""
    ticks, scenario = trajectory.ticks, trajectory.scenario
    moves = np.diff(ticks.position, axis=0)
    turns = np.remainder(np.diff(ticks.heading) + np.pi, 2 * np.pi) - np.pi
    clearance = float(ticks.clearance.min())
    counts = np.bincount(trajectory.decisions.mode, minlength=len(MODES))
    return Result(
        scenario=scenario.name,
        planner=scenario.planner.name,
        drive=scenario.drive,
        seed=scenario.seed,
        outcome=trajectory.outcome,
        steps=trajectory.physics_steps,
        decisions=trajectory.decisions.tick.size,
        time_s=round(float(ticks.time[-1]), 6),
        path_length_m=round(float(np.hypot(*moves.T).sum()), 6),
        shortest_path_m=None,
        spl=None,
        min_clearance_m=round(clearance, 6) if math.isfinite(clearance) else None,
        collisions=int(trajectory.collision is not None),
        turning_rad=round(float(np.abs(turns).sum()), 6),
        modes=ModeCounts(**dict(zip(MODES, counts.tolist(), strict=True))),
        digest=trajectory.digest(),
        version=trajectory.version,
    )
