"""The study that the soak disturbs: every planner in every kind of field, every record kept.

It is known to the command line by ``plugin.py`` alone: whoever imports it here registers nothing.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Iterator, Mapping
from importlib.util import find_spec
from itertools import count, islice
from pathlib import Path
from typing import Any, ClassVar

from pydantic import Field

from fuzzyq_bullet.episode import run
from fuzzyq_bullet.planning import PlannerSettings, ProcessSettings, planner_names, settings_for
from fuzzyq_bullet.platforms import data_folder
from fuzzyq_bullet.recording.trajectory import Trajectory
from fuzzyq_bullet.scenario import Drive, Limits, Scenario, load_scenario
from fuzzyq_bullet.studies import (
    Environment,
    Findings,
    Plan,
    Results,
    Study,
    Table,
    described,
)
from fuzzyq_bullet.studies.episodes import Job
from fuzzyq_bullet.studies.plan import Episode, PlannerDescription, Seed
from fuzzyq_bullet.studies.study import Work
from fuzzyq_bullet.studies.sweep import Done, answer, run_job

ROOT = Path(__file__).resolve().parents[2]
LIMITS = Limits(time=40.0, steps=20_000)
"""Long enough to arrive in most fields; many episodes count here, not how they end."""
BUNDLED = "bundled."
"""What a layout begins with that is a scenario of the package."""
FIELDS: tuple[tuple[str, int | None], ...] = (
    *(("scatter", count) for count in (10, 25, 50, 75)),
    ("rectangles", 20),
    *((name, None) for name in ("maze", "semicircle", "u-shape", "arc", "long-wall", "cellular")),
)
"""Layouts of the random fields, with their numbers of obstacles."""
DRIVES: tuple[Drive, ...] = ("wheels", "kinematic")
ON_WHEELS_ALONE = ("process",)
"""Its program commands speeds, and the kinematic drive tells it of no greatest one. Others say
themselves that they need wheels."""
OWN: Mapping[str, PlannerSettings] = {
    "process": ProcessSettings(
        command=(sys.executable, str(ROOT / "examples" / "controllers" / "gap.py")),
        guard=True,
        # A machine that is busy with other things is no fault of the program.
        time_limit=300.0,
        start_limit=300.0,
    )
}
"""Settings of the planners that cannot do without."""


def all_planners() -> dict[str, PlannerSettings]:
    """Return every planner that can be built here, by its name."""
    return {
        name: OWN.get(name) or settings_for(name).model_validate({"name": name})
        for name in planner_names()
        if name != "navground" or find_spec("navground") is not None
    }


def _needs_wheels(planner: str) -> bool:
    return planner in ON_WHEELS_ALONE or settings_for(planner).needs_wheels


class SoakJob(Job):
    """An episode that may take place in a bundled scenario."""

    def scenario(self) -> Scenario:
        """Return what is to be run."""
        where = self.environment
        if not where.layout.startswith(BUNDLED):
            return super().scenario()
        given = load_scenario(where.layout.removeprefix(BUNDLED), policies=False)
        return given.model_copy(
            update={
                "planner": self.settings,
                "drive": self.drive,
                "seed": where.seed,
                "limits": self.limits,
            }
        )


class SoakPlan(Plan):
    """Every planner with both drives in one field after the other, bundled and random by turns."""

    planners: dict[str, PlannerDescription]
    episodes: int
    seed: Seed = 0
    limits: Limits = LIMITS

    def environments(self) -> Iterator[Environment]:
        """Yield fields without end."""
        names = sorted(path.stem for path in data_folder("scenarios").glob("*.yaml"))
        for k in count():
            run, i = divmod(k, len(names))
            yield Environment.of(BUNDLED + names[i], None, run, self.seed)
            run, i = divmod(k, len(FIELDS))
            yield Environment.of(*FIELDS[i], run, self.seed)

    def schedule(self) -> Iterator[Episode]:
        """Yield all episodes."""
        endless = (
            (where, name, drive)
            for where in self.environments()
            for name in self.planners
            for drive in DRIVES
            if drive == "wheels" or not _needs_wheels(name)
        )
        return islice(endless, self.episodes)

    def jobs(self, planners: Mapping[str, PlannerSettings]) -> list[Job]:
        """Return all jobs."""
        return [
            SoakJob(where, name, planners[name], drive, self.limits)
            for where, name, drive in self.schedule()
        ]


def work(order: dict[str, Any]) -> dict[str, Any]:
    """Run an episode in a worker, and hand on its record however it ended."""
    kept: list[Trajectory] = []

    def recorded(scenario: Scenario) -> Trajectory:
        kept.append(run(scenario))
        return kept[0]

    done = run_job(SoakJob.of_order(order), recorded)
    return answer(Done(done.row, kept[0].to_bytes() if kept else None))


class Soak(Study):
    """Run every planner in every kind of field, with both drives, and keep every record."""

    name: ClassVar[str] = "soak"
    kinds: ClassVar[Mapping[str, type[Plan]]] = {"soak": SoakPlan}
    kept: ClassVar[bool] = True

    episodes: int = Field(2000, ge=1, le=1_000_000, description="How many.")

    def planner_set(self) -> Mapping[str, PlannerSettings]:
        """Return all that can be built here."""
        return all_planners()

    def plan(self) -> SoakPlan:
        """Return what is run."""
        told = described(self.planner_set())
        return SoakPlan(sweep=self.name, planners=told, episodes=self.episodes, seed=self.seed)

    def work(self) -> Work:
        """Return what does a job."""
        return work

    def findings(self, results: Results) -> Findings:
        """Return how the episodes of each planner ended."""
        rows = results[self.name].rows
        ended = Counter((row.planner, row.outcome) for row in rows)
        columns = sorted({row.outcome for row in rows})
        lines = {
            name: {outcome: ended[name, outcome] for outcome in columns}
            for name in results[self.name].plan.planners
        }
        cells = [[name, *map(str, line.values())] for name, line in lines.items()]
        return Findings((Table("How episodes ended.", ("planner", *columns), cells),), lines)
