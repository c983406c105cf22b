"""What crossing the same field again is worth: ``fuzzyq bench familiar``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict
from typing import Any, ClassVar

from pydantic import Field

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.planning import PlannerSettings
from fuzzyq_bullet.planning.settings import FuzzyQLambdaSettings
from fuzzyq_bullet.scenario import Drive, Limits
from fuzzyq_bullet.studies.episodes import Environment
from fuzzyq_bullet.studies.escape.bounds import DRIVERS
from fuzzyq_bullet.studies.escape.table import TRAPS
from fuzzyq_bullet.studies.familiar.drivers import KEPT, LEARNED, label_of
from fuzzyq_bullet.studies.familiar.table import FIRST, lines_of, shown, targets_of
from fuzzyq_bullet.studies.options import counts_of, described, one_drive_of
from fuzzyq_bullet.studies.plan import PATIENT, Episode, Number, Plan, PlannerDescription, Seed
from fuzzyq_bullet.studies.registry import register_study
from fuzzyq_bullet.studies.study import Findings, Results, Study, Swept, Work, met_by_all, numbers
from fuzzyq_bullet.training.field import RATE, TRACE
from fuzzyq_bullet.wording import shorten

KEPT_RUNS = 10
"""Runs with the map kept: more change nothing."""
MOST_CROSSINGS = 100
"""More of one field would not be done before a worker's time is up."""


def _schedules() -> dict[str, float]:
    return {"rate": RATE.start, "trace": TRACE.start}


class FamiliarPlan(Plan):
    """Fields and traps, each crossed again and again.

    Attributes:
        planner: The settings of the planner that all have, with the hash of its weights.
        learning: η and λ of the robot that learns, by name.
        drive: What moves the robot.
        runs: Fields for every count.
        counts: Numbers of scattered obstacles.
        traps: How many traps.
        crossings: After how many runs the robot that learns is asked.
        seed: Of the sweep.
        limits: When a run is given up.
    """

    planner: PlannerDescription
    learning: dict[str, float] = Field(default_factory=_schedules)
    drive: Drive = "wheels"
    runs: Number
    counts: tuple[Number, ...]
    traps: Number
    crossings: tuple[Number, ...] = Field(min_length=1)
    seed: Seed = 0
    limits: Limits = PATIENT

    def names(self) -> tuple[str, ...]:
        """Return what rows call those that are compared."""
        learned = (label_of(LEARNED, runs) for runs in self.crossings)
        return FIRST, *learned, label_of(KEPT, KEPT_RUNS), *DRIVERS

    def environments(self) -> Iterator[Environment]:
        """Yield all environments, of every kind in turn."""
        for run in range(max(self.runs, self.traps)):
            if run < self.runs:
                for count in self.counts:
                    yield Environment.of("scatter", count, run, self.seed)
            if run < self.traps:
                yield Environment.of(TRAPS[run % len(TRAPS)], None, run, self.seed)

    def schedule(self) -> Iterator[Episode]:
        """Yield all episodes, those of one environment one after the other."""
        for where in self.environments():
            for name in self.names():
                yield where, name, self.drive


@register_study
class Familiar(Study):
    """Let a robot cross the same field again and again; print how much faster it becomes.

    Beside its first run and what it has learned: a robot that keeps its map instead, one that is
    told how far it is to the goal from every exit, and the true shortest path. May be ended at any
    moment: the same command goes on where it was. Writes familiar.csv, a row for every robot and
    field, and familiar.json. Exit code 1 when a target is missed.
    """

    name: ClassVar[str] = "familiar"
    title: ClassVar[str] = "The same field again"
    stage_plans: ClassVar[Mapping[str, type[Plan]]] = {"familiar": FamiliarPlan}
    width: ClassVar[int] = 110

    runs: int = Field(20, ge=1, le=100_000, description="Fields for every count.")
    counts: str = Field("75,100,125", description="Numbers of scattered obstacles, or none.")
    traps: int = Field(
        20, ge=0, le=100_000, description="Semicircles, arcs, U-shapes and walls, in turn."
    )
    crossings: str = Field("50", description="Runs to learn from; several give a row each.")
    drive: str = Field("wheels", description="wheels (physics), or kinematic.")

    def planner_set(self) -> dict[str, PlannerSettings]:
        """Return those that are compared; all have the planner's own settings."""
        return dict.fromkeys(self.plan().names(), FuzzyQLambdaSettings())

    def plan(self) -> FamiliarPlan:
        """Return what is run; asking for nothing is a mistake too."""
        crossings = _crossings_of(self.crossings)
        plan = FamiliarPlan(
            sweep=self.name,
            planner=described({"": FuzzyQLambdaSettings()})[""],
            drive=one_drive_of(self.drive),
            runs=self.runs,
            counts=counts_of(self.counts, "--counts"),
            traps=self.traps,
            crossings=crossings,
            seed=self.seed,
        )
        if not any(True for _ in plan.environments()):
            raise UserError("nothing to run: --counts and --traps ask for none")
        return plan

    @classmethod
    def recalled(cls, plans: Mapping[str, Any]) -> Familiar:
        """Return the study whose plan this is."""
        plan: FamiliarPlan = plans["familiar"]
        return cls(
            runs=plan.runs,
            counts=numbers(plan.counts),
            traps=plan.traps,
            crossings=numbers(plan.crossings),
            drive=plan.drive,
            seed=plan.seed,
        )

    def findings(self, results: Results) -> Findings:
        """Return the table, with the targets that are missed."""
        swept: Swept = results[self.name]
        plan: FamiliarPlan = swept.plan
        lines = lines_of(met_by_all(swept.rows), plan.names())
        about = f"{plan.drive}, {len({row.place for row in swept.rows})} fields, seed {plan.seed}."
        learned = label_of(LEARNED, max(plan.crossings))
        targets = [
            one
            for line in lines[-len(plan.names()) :]
            if line.who == learned
            for one in targets_of(line)
        ]
        told = {
            "settings": dict(swept.settings),
            "rows": [asdict(line) for line in lines],
            "targets": [{**asdict(one), "met": one.met} for one in targets],
        }
        missed = tuple(str(one) for one in targets if not one.met)
        return Findings((shown(lines, about),), told, missed=missed)

    def work(self) -> Work:
        """Return what does a job: many runs of one field in one."""
        from fuzzyq_bullet.studies.familiar.drivers import work

        return work


def _crossings_of(text: str) -> tuple[int, ...]:
    """Return after how many runs the robot is asked, sorted, each once.

    Raises:
        UserError: If one is no such number.
    """
    parts = [part.strip() for part in text.split(",")]
    for part in parts:
        if not (part.isascii() and part.isdigit() and 1 <= int(part[:9]) <= MOST_CROSSINGS):
            raise UserError(
                f"--crossings: {shorten(part)} is no number of runs; give numbers from 1 to "
                f"{MOST_CROSSINGS} with commas between"
            )
    return tuple(sorted(set(map(int, parts))))
