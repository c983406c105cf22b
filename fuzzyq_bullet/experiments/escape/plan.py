"""Which environments the question is put to: scatter fields, traps, rectangles."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from fuzzyq_bullet.experiments.sweep.jobs import Environment, Job
from fuzzyq_bullet.planning import PlannerSettings
from fuzzyq_bullet.scenario import Drive, Limits

TRAPS = ("semicircle", "arc", "u-shape", "long-wall")
"""Taken in turn, each of a size and direction that its seed draws."""
LIMITS = Limits(time=600.0, steps=100_000)
"""Long enough to go round everything twice; the time alone ends a run."""


@dataclass(frozen=True)
class Plan:
    """What is to be run.

    Attributes:
        settings: The planner's.
        drives: Every environment is run with each.
        runs: Environments for every count.
        counts: Numbers of scattered obstacles, of radius 0.2 m.
        traps: How many traps.
        rectangles: Numbers of rectangles.
        seed: Of the sweep.
    """

    settings: PlannerSettings
    drives: tuple[Drive, ...] = ("wheels", "kinematic")
    runs: int = 50
    counts: tuple[int, ...] = (5, 25, 50, 75, 100, 125)
    traps: int = 100
    rectangles: tuple[int, ...] = (30, 40, 60)
    seed: int = 0

    def environments(self) -> Iterator[Environment]:
        """Yield all environments."""
        for layout, counts in (("scatter", self.counts), ("rectangles", self.rectangles)):
            for count in counts:
                for run in range(self.runs):
                    yield Environment.of(layout, count, run, self.seed)
        for run in range(self.traps):
            yield Environment.of(TRAPS[run % len(TRAPS)], None, run, self.seed)

    def jobs(self) -> list[Job]:
        """Return all jobs; those of one environment are neighbours, which share its oracle."""
        return [
            Job(where, self.settings.name, self.settings, drive, LIMITS)
            for where in self.environments()
            for drive in self.drives
        ]

    def described(self) -> dict[str, Any]:
        """Return all that the rows depend on, as JSON can say it."""
        return {
            "planner": self.settings.model_dump(mode="json"),
            "drives": list(self.drives),
            "runs": self.runs,
            "counts": list(self.counts),
            "traps": self.traps,
            "rectangles": list(self.rectangles),
            "seed": self.seed,
            "limits": LIMITS.model_dump(mode="json"),
        }
