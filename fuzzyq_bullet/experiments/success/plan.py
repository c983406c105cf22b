"""Which episodes Fig. 13 is made of: every planner in the same environments, by count."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from fuzzyq_bullet.experiments.success.contenders import described
from fuzzyq_bullet.experiments.sweep.jobs import Environment, Job
from fuzzyq_bullet.planning import PlannerSettings
from fuzzyq_bullet.scenario import Drive, Limits

LAYOUT = "scatter"
COUNTS = tuple(range(5, 130, 5))
"""Numbers of obstacles of Fig. 13."""
RUNS = 50
"""Tests at each of them, in the paper."""
M_S = 3000
"""Decisions after which a run is given up: M_s of Step 12. The paper gives no number; it must be
more than the 2342 steps that it reports as a mean."""
LIMITS = Limits(time=3600.0, steps=M_S)
"""M_s alone ends a run: the time is more than so many decisions take with either drive."""


@dataclass(frozen=True)
class Plan:
    """What is to be run.

    Attributes:
        planners: Settings, by what rows call the planner.
        drive: What moves the robot.
        counts: Numbers of scattered obstacles, of radius 0.2 m.
        runs: Environments for every count.
        seed: Of the sweep.
    """

    planners: Mapping[str, PlannerSettings]
    drive: Drive = "kinematic"
    counts: tuple[int, ...] = COUNTS
    runs: int = RUNS
    seed: int = 0

    def jobs(self) -> list[Job]:
        """Return all jobs; those of one environment are neighbours, which share its oracle."""
        return [
            Job(Environment.of(LAYOUT, count, run, self.seed), label, settings, self.drive, LIMITS)
            for count in self.counts
            for run in range(self.runs)
            for label, settings in self.planners.items()
        ]

    def described(self) -> dict[str, Any]:
        """Return all that the rows depend on, as JSON can say it.

        Raises:
            UserError: If the policy of a planner is missing or damaged.
        """
        return {
            "planners": described(self.planners),
            "drive": self.drive,
            "counts": list(self.counts),
            "runs": self.runs,
            "seed": self.seed,
            "limits": LIMITS.model_dump(mode="json"),
        }
