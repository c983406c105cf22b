"""What learned weights gain over fixed ones, where none were learned: ``fuzzyq bench learning``.

A grid search where the training was, then a comparison where it never was.
"""

from __future__ import annotations

from collections.abc import Generator, Iterable, Iterator, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from pydantic import Field, ValidationError

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.learning import Policy, hash_of
from fuzzyq_bullet.planning.fuzzy_q_lambda import policy_spec
from fuzzyq_bullet.planning.policies import policy_of
from fuzzyq_bullet.planning.settings import FuzzyQLambdaSettings, PlannerSettings
from fuzzyq_bullet.scenario import Drive, Limits
from fuzzyq_bullet.studies.episodes import MOST_RUNS, Environment
from fuzzyq_bullet.studies.learning.table import LEARNED, summary_of, time_ratios
from fuzzyq_bullet.studies.options import counts_of, one_drive_of
from fuzzyq_bullet.studies.plan import PATIENT, Episode, Number, Plan, Seed
from fuzzyq_bullet.studies.registry import register_study
from fuzzyq_bullet.studies.selection import (
    HALF,
    ONE,
    PAIRS,
    TRIPLES,
    Choice,
    SearchPlan,
    best_of,
    label_of,
    search,
    settings_of,
    words_of,
)
from fuzzyq_bullet.studies.study import Findings, Picture, Results, Stage, Study, Swept, numbers
from fuzzyq_bullet.training.tasks import FIRST_SEED

MOST = 10_000
MOST_SEED = (FIRST_SEED - 1) // MOST_RUNS - 1
"""Greatest seed of a comparison: all its environments lie below those of any training."""
FIXED = ("0.5/0.5", "1/1", "best pair", "best triple")
"""What fixed weights are there for."""
NO_CONTROLLER = "no-controller"
"""What rows call the best triple's planner without its rules: straight to the aim at full speed."""
RIVAL = "best triple"
"""What the targets are about: the best that can be had without learning."""


class ComparisonPlan(Plan):
    """The comparison, on environments that no training ever meets.

    Attributes:
        drive: What moves the robot.
        seed: Of the sweep.
        environments: How many.
        counts: Numbers of scattered obstacles, taken in turn.
        fixed: What rows call the weights to compare with, each once.
        policy: What identifies what was learned.
        limits: When an episode is given up.
    """

    drive: Drive
    seed: Seed
    environments: Number
    counts: tuple[Number, ...] = Field(min_length=1)
    fixed: tuple[str, ...]
    policy: str = ""
    limits: Limits = PATIENT

    def places(self) -> tuple[Environment, ...]:
        """Return the environments."""
        return tuple(
            Environment.of("scatter", self.counts[run % len(self.counts)], run, self.seed)
            for run in range(self.environments)
        )

    def schedule(self) -> Iterator[Episode]:
        """Yield all episodes, those of one environment one after the other."""
        for where in self.places():
            for name in (*self.fixed, NO_CONTROLLER, LEARNED):
                yield where, name, self.drive


def unseen(environments: Iterable[Environment]) -> tuple[int, int]:
    """Make sure that no training can have met an environment; return least and greatest seed.

    Every scenario of every training has a seed of at least ``FIRST_SEED``.

    Raises:
        UserError: If a seed is a training's.
    """
    seeds = [where.seed for where in environments]
    if max(seeds) >= FIRST_SEED:
        raise UserError(f"seed {max(seeds)}: from {FIRST_SEED} on they are for training")
    return min(seeds), max(seeds)


@register_study
class Learning(Study):
    """Compare learned weights with the best fixed ones, on environments that no training saw.

    First every pair (ω1, ω2) and triple (ω1, ω2, c_f) is tried on the environments of the training,
    then the best of them, 0.5/0.5, 1/1, no controller and the learned planner meet on others. May
    be ended at any moment: the same command goes on where it was. Writes grid/grid.csv,
    comparison/comparison.csv, learning.json and learning.png. Exit code 1 when a target is missed.
    """

    name: ClassVar[str] = "learning"
    title: ClassVar[str] = "What learning gains"
    stage_plans: ClassVar[Mapping[str, type[Plan]]] = {
        "grid": SearchPlan,
        "comparison": ComparisonPlan,
    }
    folders: ClassVar[Mapping[str, str]] = {"grid": "grid", "comparison": "comparison"}
    pictured: ClassVar[bool] = True

    environments: int = Field(200, ge=1, le=MOST, description="Environments to compare on.")
    counts: str = Field(
        "25,50,75,100,125", description="Their numbers of scattered obstacles, in turn."
    )
    grid: int = Field(
        48, ge=1, le=MOST, description="Training environments to find the best fixed on."
    )
    policy: Path | None = Field(default=None, description="What was learned; else what is shipped.")
    drive: str = Field("wheels", description="wheels (physics), or kinematic.")
    seed: int = Field(0, ge=0, le=MOST_SEED, description="Seed of the sweep.")

    def stages(self) -> Generator[Stage, Swept, None]:
        """Yield the search for the best fixed weights, then the comparison."""
        counts = counts_of(self.counts, "--counts")
        if not counts:
            raise UserError("--counts: none leaves nothing to compare on")
        drive = one_drive_of(self.drive)
        settings, policy = self._learned()
        tried = yield search(self.name, drive, policy.seed, self.grid, TRIPLES)
        choices = _choices(tried)
        fixed = {label_of(one): one for one in (HALF, ONE, *(one.best for one in choices.values()))}
        plan = ComparisonPlan(
            sweep="learning comparison",
            drive=drive,
            seed=self.seed,
            environments=self.environments,
            counts=counts,
            fixed=tuple(fixed),
            policy=hash_of(policy),
        )
        least, greatest = unseen(plan.places())
        notes = [
            f"{role} on the training's environments: {words_of(choice.best)}"
            for role, choice in choices.items()
        ]
        notes.append(
            f"no training saw any of the {self.environments} environments: their seeds are {least} "
            f"to {greatest}, those of trainings begin at {FIRST_SEED}"
        )
        planners: dict[str, PlannerSettings] = {
            **{name: settings_of(weights) for name, weights in fixed.items()},
            NO_CONTROLLER: settings_of(choices[RIVAL].best).model_copy(update={"rules": "none"}),
            LEARNED: settings,
        }
        yield Stage("comparison", plan, planners, notes=tuple(notes))

    def _learned(self) -> tuple[FuzzyQLambdaSettings, Policy]:
        """Return the planner that has learned, and what.

        Raises:
            UserError: If the policy cannot be used.
        """
        try:
            path = None if self.policy is None else str(self.policy)
            settings = FuzzyQLambdaSettings(policy=path)
        except ValidationError as error:
            raise UserError(f"--policy: {error.errors(include_url=False)[0]['msg']}") from error
        return settings, policy_of(settings, policy_spec(settings))

    @classmethod
    def recalled(cls, plans: Mapping[str, Any]) -> Learning | None:
        """Return the study whose plans these are; a policy of one's own is not among them."""
        if len(plans) < len(cls.stage_plans):  # without the search nobody knows the best weights
            return None
        plan: ComparisonPlan = plans["comparison"]
        return cls(
            environments=plan.environments,
            counts=numbers(plan.counts),
            grid=plans["grid"].episodes,
            drive=plan.drive,
            seed=plan.seed,
        )

    @classmethod
    def usable(cls, results: Results) -> Results | None:
        """Return finished results alone: until then nobody knows which weights are the best."""
        return results if all(one.finished for one in results.values()) else None

    def findings(self, results: Results) -> Findings:
        """Return what learning gains, with its intervals."""
        from fuzzyq_bullet.studies.learning.shown import picture, tables_of

        found, plan = results["grid"].plan, results["comparison"].plan
        rows = results["comparison"].rows
        choices = _choices(results["grid"])
        chosen = (HALF, ONE, *(one.best for one in choices.values()))
        roles = dict(zip(FIXED, map(label_of, chosen), strict=True)) | {
            "no controller": NO_CONTROLLER
        }
        summary = summary_of(rows, roles, RIVAL, np.random.default_rng(plan.seed))
        _, policy = self._learned()
        known = hash_of(policy) == plan.policy  # of a report: it may be another by now
        same = known and found.tasks == policy.scenario
        learned = f"policy {plan.policy}"
        if known:
            learned = f"policy of {policy.episodes} episodes, seed {policy.seed}, {policy.drive}"
        about = (
            f"{plan.drive}; seed {plan.seed}; {', '.join(map(str, plan.counts))} obstacles in "
            f"turn, walled 10 × 10 m; {learned}; best weights of {len(TRIPLES)} on "
            f"{choices[RIVAL].feasible} environments "
            f"{'of that training' if same else 'with training seeds, not those it learned on'}."
        )
        least, greatest = unseen(plan.places())
        data = {
            "settings": {
                "search": found.described(),
                "comparison": plan.described(),
                "same_tasks": same,
            },
            "seeds": {"least": least, "greatest": greatest, "first_of_trainings": FIRST_SEED},
            "search": {role: _choice(choice) for role, choice in choices.items()},
            **asdict(summary),
            "targets": [{**asdict(one), "met": one.met} for one in summary.targets],
        }
        title = (
            f"What learning gains: {plan.drive}, {summary.feasible} environments that no training "
            "saw"
        )
        shown = Picture(
            lambda: picture(summary, time_ratios(rows, roles[RIVAL]), title),
            "Time of the learned planner over that of the best fixed triple in each environment, "
            "and the intervals of all comparisons; the tables have the figures.",
        )
        missed = tuple(str(one) for one in summary.targets if not one.met)
        return Findings(tables_of(summary, about), data, missed=missed, pictures=(shown,))


def _choices(tried: Swept) -> dict[str, Choice]:
    return {"best pair": best_of(tried.rows, PAIRS), "best triple": best_of(tried.rows, TRIPLES)}


def _choice(choice: Choice) -> dict[str, Any]:
    return {
        "best": label_of(choice.best),
        "feasible": choice.feasible,
        "common": choice.common,
        "trials": [
            {**asdict(one), "weights": one.weights._asdict(), "planner": label_of(one.weights)}
            for one in choice.trials
        ],
    }
