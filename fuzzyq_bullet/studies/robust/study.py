"""Planners that are disturbed, each disturbance on a scale of four: ``fuzzyq bench robust``."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from typing import Any, ClassVar

from pydantic import Field

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.planning import PlannerSettings
from fuzzyq_bullet.scenario import Limits
from fuzzyq_bullet.scenario.layouts import Wanderers
from fuzzyq_bullet.studies.episodes import Environment, Job, Outfit
from fuzzyq_bullet.studies.options import described, planners_of
from fuzzyq_bullet.studies.plan import PATIENT, Episode, Number, Plan, PlannerDescription, Seed
from fuzzyq_bullet.studies.registry import register_study
from fuzzyq_bullet.studies.robust.table import ALL, MOVING, lines_of, shown, targets_of
from fuzzyq_bullet.studies.study import Findings, Picture, Results, Study, Swept, met_by_all
from fuzzyq_bullet.wording import not_one_of

DEGREE_A_CENTIMETRE = math.radians(1.0) / 0.01
"""Error of the heading (rad) beside one of the position (m)."""
SCALES: Mapping[str, tuple[float, float, float, float]] = {
    "noise": (0.005, 0.01, 0.02, 0.04),
    "dropout": (0.003, 0.01, 0.03, 0.1),
    "pose_noise": (0.003, 0.01, 0.03, 0.1),
    "slip": (0.01, 0.03, 0.1, 0.2),
    "latency": (0.05, 0.1, 0.2, 0.4),
    MOVING: (5, 10, 20, 40),
}
"""Four strengths of each disturbance, by the key of the scenario file; the second is usual. What
moves is so many wanderers (``random.movers``) beside the obstacles that stand."""
UNDISTURBED = "none"
_TOGETHER = tuple(name for name in SCALES if name != MOVING)
NAMES = (*_TOGETHER, ALL, MOVING)
LEVELS = 4


def strengths(name: str, level: int) -> dict[str, float]:
    """Return the keys of the scenario file that a disturbance sets, and to what.

    Args:
        name: One of ``NAMES``; ``all`` stands for all at once but what moves.
        level: Its place on the scale, from 1; 0 for none.
    """
    if level == 0:
        return {}
    found = {key: SCALES[key][level - 1] for key in (_TOGETHER if name == ALL else (name,))}
    if "pose_noise" in found:
        found["heading_noise"] = found["pose_noise"] * DEGREE_A_CENTIMETRE
    return found


def outfit_of(name: str, level: int) -> Outfit:
    """Return what disturbs the robot in its fields; arguments as for ``strengths``."""
    told = strengths(name, level)
    if MOVING in told:
        return Outfit(movers=Wanderers(count=int(told[MOVING])))
    return Outfit(disturbed=told)


def label_of(planner: str, name: str, level: int) -> str:
    """Return what rows call a disturbed planner."""
    return f"{planner}.{UNDISTURBED}" if level == 0 else f"{planner}.{name}.{level}"


class RobustPlan(Plan):
    """Every planner with every disturbance in the same fields, and undisturbed.

    Attributes:
        planners: The settings of each, by its name.
        disturbances: Names of ``SCALES``, or ``all``.
        levels: Places on their scales, from 1.
        count: Scattered obstacles in a field, which stand.
        runs: Fields.
        seed: Of the sweep.
        limits: When an episode is given up.
    """

    planners: dict[str, PlannerDescription] = Field(min_length=1)
    disturbances: tuple[str, ...] = Field(min_length=1)
    levels: tuple[int, ...] = Field(min_length=1)
    count: Number
    runs: Number
    seed: Seed = 0
    limits: Limits = PATIENT

    def labels(self) -> Iterator[tuple[str, str, str, int]]:
        """Yield what rows call each, its planner, disturbance and level."""
        for planner in self.planners:
            yield label_of(planner, UNDISTURBED, 0), planner, UNDISTURBED, 0
            for name in self.disturbances:
                for level in self.levels:
                    yield label_of(planner, name, level), planner, name, level

    def schedule(self) -> Iterator[Episode]:
        """Yield all episodes, those of one field one after the other."""
        for run in range(self.runs):
            where = Environment.of("scatter", self.count, run, self.seed)
            for label, *_ in self.labels():
                yield where, label, "wheels"

    def jobs(self, planners: Mapping[str, PlannerSettings]) -> list[Job]:
        """Return all jobs, each with what disturbs it."""
        told = {
            label: (planners[planner], outfit_of(name, level))
            for label, planner, name, level in self.labels()
        }
        return [
            Job(where, label, told[label][0], drive, self.limits, told[label][1])
            for where, label, drive in self.schedule()
        ]


@register_study
class Robust(Study):
    """Disturb planners on their wheels by noise, slip, latency and moving obstacles.

    Each of noise, dropout, pose_noise, slip and latency comes in four strengths, alone and all
    together, in the same fields; so do 5, 10, 20 and 40 moving obstacles, which are no part of
    "all". Those wander (radius 0.25 m, 0.1 to 0.5 m/s) among the obstacles that stand.

    May be ended at any moment: the same command goes on where it was. Writes robust.csv, a row for
    every episode, robust.json and robust.png. Exit code 1 when a target is missed. The targets for
    moving obstacles count for at most 25 that stand.
    """

    name: ClassVar[str] = "robust"
    title: ClassVar[str] = "Noise, slip, latency and moving obstacles"
    stage_plans: ClassVar[Mapping[str, type[Plan]]] = {"robust": RobustPlan}
    pictured: ClassVar[bool] = True

    planners: str = Field("fuzzy-q-lambda", description="Planners, with commas between.")
    disturbances: str = Field(
        ",".join(NAMES), description="Which disturbances, with commas between."
    )
    levels: str = Field("1,2,3,4", description="Which of their four strengths.")
    count: int = Field(50, ge=0, le=1000, description="Standing obstacles in a field.")
    runs: int = Field(20, ge=1, le=100_000, description="Fields.")

    def planner_set(self) -> Mapping[str, PlannerSettings]:
        """Return those that are disturbed."""
        return planners_of(self.planners)

    def plan(self) -> RobustPlan:
        """Return what is run."""
        names = tuple(dict.fromkeys(one.strip() for one in self.disturbances.split(",")))
        for name in names:
            if name not in NAMES:
                raise UserError(f"--disturbances: {not_one_of('disturbance', name, NAMES)}")
        wanted = [one.strip() for one in self.levels.split(",")]
        allowed = [str(level) for level in range(1, LEVELS + 1)]
        for level in wanted:
            if level not in allowed:
                raise UserError(f"--levels: {not_one_of('level', level, allowed)}")
        return RobustPlan(
            sweep=self.name,
            planners=described(self.planner_set()),
            disturbances=names,
            levels=tuple(sorted({int(level) for level in wanted})),
            count=self.count,
            runs=self.runs,
            seed=self.seed,
        )

    @classmethod
    def recalled(cls, plans: Mapping[str, Any]) -> Robust:
        """Return the study whose plan this is."""
        plan: RobustPlan = plans[cls.name]
        return cls(
            planners=",".join(plan.planners),
            disturbances=",".join(plan.disturbances),
            levels=",".join(map(str, plan.levels)),
            count=plan.count,
            runs=plan.runs,
            seed=plan.seed,
        )

    def findings(self, results: Results) -> Findings:
        """Return the table, with the targets that are missed."""
        from fuzzyq_bullet.studies.robust.picture import robust_picture

        swept: Swept = results[self.name]
        plan: RobustPlan = swept.plan
        rows = met_by_all(swept.rows)
        lines = lines_of(rows, list(plan.labels()), strengths)
        fields = len({row.place for row in rows})
        about = f"wheels; seed {plan.seed}; {fields} fields, {plan.count} obstacles each"
        targets = [one for line in lines for one in targets_of(line, plan.count)]
        data = {
            "settings": dict(swept.settings),
            "lines": [asdict(line) for line in lines],
            "targets": [{**asdict(one), "met": one.met} for one in targets],
        }
        return Findings(
            (shown(lines, about),),
            data,
            missed=tuple(str(one) for one in targets if not one.met),
            pictures=(
                Picture(
                    lambda: robust_picture(lines, about),
                    "Success, contacts and time of each planner by the strength of disturbances.",
                ),
            ),
        )
