"""Mean steps to the goal among 50 obstacles (Table 5), with failures told in three ways.

``fuzzyq bench steps``: the paper's five planners, and the rows that honesty needs.
"""

from __future__ import annotations

from collections.abc import Generator, Mapping
from dataclasses import asdict
from typing import Any, ClassVar

import numpy as np
from pydantic import Field

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.planning import ImprovedFuzzySettings, PlannerSettings
from fuzzyq_bullet.planning.fuzzy_q_lambda import rule_policy
from fuzzyq_bullet.planning.settings import FuzzyQLambdaSettings
from fuzzyq_bullet.studies.options import (
    GUARDED,
    PAPER,
    POSITIONAL,
    VARIANTS,
    described,
    one_drive_of,
    planner_of,
    planners_of,
)
from fuzzyq_bullet.studies.plan import FieldsPlan, Plan, limits_with
from fuzzyq_bullet.studies.registry import register_study
from fuzzyq_bullet.studies.selection import (
    ONE,
    PAIRS,
    USUAL_BREAKOUT,
    SearchPlan,
    Weights,
    best_of,
    label_of,
    search,
    settings_of,
    words_of,
)
from fuzzyq_bullet.studies.steps.table import Summary, summary_of
from fuzzyq_bullet.studies.study import Findings, Results, Stage, Study, Swept, Table, Work, cell

COUNT = 50
"""Obstacles of Table 5."""
RUNS = 20
"""Its repetitions."""


def contenders(pair: Weights) -> dict[str, PlannerSettings]:
    """Return all planners of the table by what rows call them.

    The paper's five as they are set by default (fixed weights are 0.5/0.5); the direct ones with
    safety filter and ways out, which the improved ones have, and with a table of places that they
    learn in each environment before they drive it; then the improved fuzzy planner with
    weights 1/1, which nobody had to learn, and with the best fixed pair. Without these two, longer
    steps alone would look like something learned.

    Args:
        pair: The best fixed pair.
    """
    fixed = {label_of(one): settings_of(one) for one in (ONE, pair)}
    return planners_of((*PAPER, *VARIANTS)) | fixed


def roles(pair: Weights) -> dict[str, str]:
    """Return what the extra rows are called for a person, by what rows call the planner."""
    variants = {name: f"{name.removesuffix('-guarded')} with ways out" for name in GUARDED}
    variants |= {name: f"{name.removesuffix('-position')}, by place" for name in POSITIONAL}
    if label_of(pair) == label_of(ONE):
        return {**variants, label_of(ONE): "fixed 1/1, the best pair"}
    words = f"best pair {pair.step:g}/{pair.turn:g}"
    return {**variants, label_of(ONE): "fixed 1/1", label_of(pair): words}


@register_study
class Steps(Study):
    """Print the mean number of steps to the goal beside the paper's, and what failures do to it.

    The paper's five planners, and the improved fuzzy one with fixed weights: 1/1, and the best pair
    on environments of the training. May be ended at any moment: the same command goes on where it
    was. Writes table/steps.csv, a row for every episode, and steps.json.
    """

    name: ClassVar[str] = "steps"
    title: ClassVar[str] = "Steps to the goal (Table 5)"
    stage_plans: ClassVar[Mapping[str, type[Plan]]] = {"grid": SearchPlan, "steps": FieldsPlan}
    folders: ClassVar[Mapping[str, str]] = {"grid": "grid", "steps": "table"}

    runs: int = Field(RUNS, ge=1, le=100_000, description="Environments.")
    count: int = Field(COUNT, ge=0, le=10_000, description="Obstacles in each.")
    pair: str | None = Field(
        None, description="The best fixed pair ω1,ω2; by default it is searched for."
    )
    grid: int = Field(48, ge=1, le=10_000, description="Training environments to search it on.")
    drive: str = Field(
        "kinematic", description="wheels (physics), or kinematic (the paper's steps)."
    )

    def stages(self) -> Generator[Stage, Swept, None]:
        """Yield the search for the best pair, unless that is given, and the table."""
        drive = one_drive_of(self.drive)
        notes: tuple[str, ...] = ()
        if self.pair is None:
            # On environments of the training, never on those of the table.
            learned = rule_policy(FuzzyQLambdaSettings())
            tried = yield search(self.name, drive, learned.seed, self.grid, PAIRS)
            best = best_of(tried.rows, PAIRS).best
            notes = (f"best pair on the training's environments: {words_of(best)}",)
        else:
            best = _pair_of(self.pair)
        planners = contenders(best)
        plan = FieldsPlan(
            sweep="steps steps",
            planners=described(planners),
            drive=drive,
            counts=(self.count,),
            runs=self.runs,
            seed=self.seed,
            limits=limits_with(drive),
        )
        yield Stage("steps", plan, planners, notes=notes)

    @classmethod
    def recalled(cls, plans: Mapping[str, Any]) -> Steps | None:
        """Return the study whose plans these are; without a search the pair was given."""
        if "steps" not in plans:
            return None
        plan: FieldsPlan = plans["steps"]
        found: SearchPlan | None = plans.get("grid")
        pair = _pair_in(plan)
        how: dict[str, Any] = {"pair": f"{pair.step:g},{pair.turn:g}"}
        if found is not None:
            how = {"grid": found.episodes}
        return cls(runs=plan.runs, count=plan.counts[0], drive=plan.drive, seed=plan.seed, **how)

    def work(self) -> Work:
        """Return what does a job; some planners learn the environment first."""
        from fuzzyq_bullet.studies.positional import work_for_row

        return work_for_row

    def findings(self, results: Results) -> Findings:
        """Return the table, beside the paper's."""
        plan: FieldsPlan = results["steps"].plan
        found = results.get("grid")
        pair, limit, kinematic = _pair_in(plan), plan.limits.steps, plan.drive == "kinematic"
        rng = np.random.default_rng(plan.seed)
        summary = summary_of(results["steps"].rows, roles(pair), limit if kinematic else None, rng)
        how = (
            "given"
            if found is None
            else f"best on {found.plan.episodes} environments of the training"
        )
        about = (
            f"{plan.drive}; seed {plan.seed}; {plan.counts[0]} obstacles, walled 10 × 10 m; "
            f"improved-fuzzy has weights 0.5/0.5; the pair {pair.step:g}/{pair.turn:g} was {how}."
        )
        settings = {
            "search": None if found is None else found.plan.described(),
            "table": plan.described(),
        }
        return Findings(
            (_table(summary, about, limit, kinematic),),
            {"settings": settings, "m_s": limit, **asdict(summary)},
            remarks=tuple(_orders_in_words(summary)),
        )


def _pair_of(text: str) -> Weights:
    """Return the weights that ``--pair`` gives, with the usual c_f."""
    try:
        settings = planner_of("improved-fuzzy", text)
    except UserError as error:
        told = (problem.replace("--weights", "--pair") for problem in error.problems)
        raise UserError(*told) from error
    assert isinstance(settings, ImprovedFuzzySettings)
    return Weights(*settings.weights, USUAL_BREAKOUT)


def _pair_in(plan: FieldsPlan) -> Weights:
    """Return the best fixed pair of a table: the fixed weights in it that are not 1/1, if any."""
    pairs = [
        Weights(float(told["weights"][0]), float(told["weights"][1]), USUAL_BREAKOUT)
        for name, told in plan.planners.items()
        if name.startswith("fixed-")
    ]
    return next((one for one in pairs if label_of(one) != label_of(ONE)), ONE)


def _table(summary: Summary, about: str, limit: int, kinematic: bool) -> Table:
    """Return the table; steps are the paper's where ``kinematic``, else those of the physics."""
    unit = (
        "Steps are moves by Eq. 17, the paper's steps."
        if kinematic
        else "Steps are those of the physics, 240 a second: not the paper's, look at the time."
    )
    rows = [
        [
            line.role,
            cell(line.paper),
            f"{line.reached} of {line.runs}",
            str(line.collisions),
            *(cell(one, ".1f") for one in (line.steps, line.common, line.punished, line.time)),
        ]
        for line in summary.lines
    ]
    return Table(
        f"{about} {unit} {summary.feasible} of {summary.environments} environments have a way "
        "for a disc of radius 0.22 m.\n"
        "paper: Table 5, whose rules for failures it does not say. steps: mean over the runs "
        "that reached the goal, failures have no steps, with a bootstrapped 95 % interval; "
        f"all reached: mean over the {summary.common} environments that all planners with "
        f"ways out solved; as M_s: mean over all runs, each failure counting as {limit}.",
        ("planner", "paper", "reached", "hits", "steps", "all reached", "as M_s", "time s"),
        rows,
    )


def _orders_in_words(summary: Summary) -> list[str]:
    """Name the orders of the paper that are not seen, on the environments that both solved."""
    told = []
    for one in summary.orders:
        if one.reproduced is False:
            told.append(
                f"The paper's order {one.fewer} < {one.more} is NOT seen: {one.fewer_steps:.1f} "
                f"and {one.more_steps:.1f} steps in the {one.environments} that both solved."
            )
        elif one.reproduced is None:
            told.append(f"{one.fewer} and {one.more} solved no environment both: no order.")
    return told
