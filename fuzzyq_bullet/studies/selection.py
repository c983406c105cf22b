"""Fixed weights that learned ones are held against, and which of them are best.

They are what a rule may choose, but for ω2 = 0, and more, with c_f, which no rule chooses: a search
over fewer values than the learned planner has would let it win for having more of them. They are
tried on a training's environments.

The best are safe first, then sure, then fast. Times are compared over the same environments for all
that are left by then: otherwise weights would look fast that fail where the way is long.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product, starmap
from statistics import fmean
from typing import NamedTuple

from pydantic import Field

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.planning import ImprovedFuzzySettings
from fuzzyq_bullet.scenario import Drive, Limits
from fuzzyq_bullet.studies.episodes import Environment, Row
from fuzzyq_bullet.studies.plan import PATIENT, Episode, Number, Plan, Seed
from fuzzyq_bullet.studies.statistics import by_planner, feasible_runs
from fuzzyq_bullet.studies.study import Stage
from fuzzyq_bullet.training.registry import recipe_of

USUAL_BREAKOUT = ImprovedFuzzySettings().breakout_at
"""c_f in S_p of a planner that is told nothing else."""


class Weights(NamedTuple):
    """Weights that stay the same for a whole run.

    Attributes:
        step: ω1 of Eq. 17.
        turn: ω2 of Eq. 17.
        breakout_at: c_f in S_p: with less than this free towards the goal, it breaks out.
    """

    step: float
    turn: float
    breakout_at: float


HALF = Weights(0.5, 0.5, USUAL_BREAKOUT)
"""What the paper calls the optimum that it found."""
ONE = Weights(1.0, 1.0, USUAL_BREAKOUT)
"""What the controller says, as it says it."""

PAIRS = (
    HALF,
    ONE,
    *starmap(Weights, product((2.0, 5.0, 10.0, 20.0), (0.1, 0.25, 0.5, 1.0), (USUAL_BREAKOUT,))),
)
"""(ω1, ω2) with the usual c_f."""
TRIPLES = (*PAIRS, *starmap(Weights, product((5.0, 10.0, 20.0), (0.1, 0.25, 0.5), (2.5, 4.0))))
"""(ω1, ω2, c_f): the pairs too, so that the best triple is never worse than the best pair there."""


def label_of(weights: Weights) -> str:
    """Return what rows call a planner with these weights; no two of them share it."""
    label = f"fixed-{weights.step:g}-{weights.turn:g}"
    return label if weights.breakout_at == USUAL_BREAKOUT else f"{label}-{weights.breakout_at:g}"


def words_of(weights: Weights) -> str:
    """Return the weights for a person: ``1/0.5``, and c_f where it is another than usual."""
    pair = f"{weights.step:g}/{weights.turn:g}"
    return pair if weights.breakout_at == USUAL_BREAKOUT else f"{pair}, c_f {weights.breakout_at:g}"


def settings_of(weights: Weights) -> ImprovedFuzzySettings:
    """Return the planner that always has these weights."""
    return ImprovedFuzzySettings(
        weights=(weights.step, weights.turn), breakout_at=weights.breakout_at
    )


class SearchPlan(Plan):
    """The grid search, on the environments of a training.

    Attributes:
        drive: What moves the robot.
        training_seed: Of the training.
        episodes: How many of its environments: those of its first episodes.
        tasks: What identifies what the training was given.
        candidates: What rows call the weights to try.
        limits: When an episode is given up.
    """

    drive: Drive
    training_seed: Seed = 0
    episodes: Number
    tasks: str = ""
    candidates: tuple[str, ...] = Field(min_length=1)
    limits: Limits = PATIENT

    def environments(self) -> Iterator[Environment]:
        """Yield the environments of the first episodes, with the seeds that training uses."""
        tasks = recipe_of("fuzzy-q-lambda").tasks(self.drive, self.training_seed)
        for episode in range(1, self.episodes + 1):
            scenario = tasks.scenario_of(episode)
            if tasks.is_corridor(episode):
                yield Environment("cellular", None, episode, scenario.seed)
            else:
                yield Environment("scatter", len(scenario.obstacles), episode, scenario.seed)

    def schedule(self) -> Iterator[Episode]:
        """Yield all episodes, those of one environment one after the other."""
        for where in self.environments():
            for name in self.candidates:
                yield where, name, self.drive

    @property
    def total(self) -> int:
        """Its episodes; no environment is drawn for that."""
        return len(self.candidates) * self.episodes

    def holds(self, row: Row) -> bool:
        """Tell whether a row is one of the sweep's."""
        mine = row.planner in self.candidates and row.drive == self.drive
        return mine and 1 <= row.run <= self.episodes


def search(study: str, drive: Drive, seed: int, episodes: int, tried: Sequence[Weights]) -> Stage:
    """Return the stage ``grid`` of a study, which tries fixed weights where a training was.

    Args:
        study: Name of the study.
        drive: What moves the robot.
        seed: Of the training.
        episodes: How many of its environments.
        tried: The weights.
    """
    plan = SearchPlan(
        sweep=f"{study} grid",
        drive=drive,
        training_seed=seed,
        episodes=episodes,
        tasks=recipe_of("fuzzy-q-lambda").tasks(drive, seed).digest(),
        candidates=tuple(label_of(one) for one in tried),
    )
    return Stage("grid", plan, {label_of(one): settings_of(one) for one in tried})


@dataclass(frozen=True)
class Trial:
    """What some weights came to in the search.

    Attributes:
        weights: They themselves.
        collisions: How many runs ended in one.
        solved: Feasible environments in which they reached the goal.
        time: Mean time to the goal (s) over the environments that the search compares times on;
            None for weights that were out before.
    """

    weights: Weights
    collisions: int
    solved: int
    time: float | None


@dataclass(frozen=True)
class Choice:
    """The best of some weights.

    Attributes:
        best: They themselves.
        feasible: Environments that have a way.
        common: Environments that the times were compared on.
        trials: All weights that were tried, in their order.
    """

    best: Weights
    feasible: int
    common: int
    trials: tuple[Trial, ...]


def best_of(rows: Iterable[Row], candidates: Sequence[Weights]) -> Choice:
    """Return the best of ``candidates``.

    Those with the fewest collisions (none, if any has none); of these, those that reached the goal
    in the most feasible environments; of these, the one with the least mean time over the
    environments that all of these solved. Among equals the first.

    Args:
        rows: Rows of the search; others than the candidates' are passed over.
        candidates: The weights, at least one.

    Raises:
        UserError: If there is no environment that all of the last solved.
    """
    table = by_planner(rows)
    feasible = feasible_runs(table)
    runs = {weights: table[label_of(weights)] for weights in candidates}
    hits = {one: sum(row.collisions or 0 for row in runs[one].values()) for one in candidates}
    solved = {
        one: {run for run, row in runs[one].items() if row.success and run in feasible}
        for one in candidates
    }
    safe = [one for one in candidates if hits[one] == min(hits.values())]
    most = max(len(solved[one]) for one in safe)
    left = [one for one in safe if len(solved[one]) == most]
    common = set.intersection(*(solved[one] for one in left))
    if not common:
        told = "; ".join(words_of(one) for one in left[:3])
        raise UserError(
            f"--grid: no environment of the search was solved by all of the best weights ({told}"
            f"{', …' if len(left) > 3 else ''}); give more environments"
        )
    times = {one: _mean_time(runs[one], common) for one in left}
    best = min(left, key=lambda one: times[one])
    trials = tuple(Trial(one, hits[one], len(solved[one]), times.get(one)) for one in candidates)
    return Choice(best, len(feasible), len(common), trials)


def _mean_time(rows: Mapping[int, Row], runs: Iterable[int]) -> float:
    return fmean(rows[run].time_s or 0.0 for run in runs)
