"""From rows to Table 5: mean steps to the goal, with failures told in three ways.

Pure arithmetic; nothing is run or printed.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from statistics import fmean

import numpy as np

from fuzzyq_bullet.studies.episodes import Row
from fuzzyq_bullet.studies.options import POSITIONAL
from fuzzyq_bullet.studies.statistics import (
    ByPlanner,
    Estimate,
    by_planner,
    feasible_runs,
    mean_of_differences,
    solved_by_all,
)

PAPER_STEPS = {
    "fuzzy": 2342,
    "improved-fuzzy": 115,
    "q-learning": 128,
    "q-lambda": 146,
    "fuzzy-q-lambda": 82,
}
"""Table 5 as printed: average number of steps."""


@dataclass(frozen=True)
class Line:
    """What one planner came to.

    Attributes:
        planner: What rows call it.
        role: What it is called for a person.
        paper: The paper's mean; None for rows that the paper does not have.
        runs: Its episodes.
        reached: Those that reached the goal.
        collisions: Those that ended in a collision.
        steps: Mean over those that reached the goal, with its interval; None without any.
        common: Mean over the environments that all planners compared solved; None without any.
        punished: Mean over all, every failure counting as M_s.
        time: Mean simulated time (s) over those that reached the goal; None without any.
    """

    planner: str
    role: str
    paper: int | None
    runs: int
    reached: int
    collisions: int
    steps: Estimate | None
    common: float | None
    punished: float | None
    time: float | None


@dataclass(frozen=True)
class Order:
    """Two planners of which the paper says that one takes fewer steps.

    Attributes:
        fewer: The one with fewer steps in the paper.
        more: The other.
        environments: Those that both solved, on which they are compared.
        fewer_steps: Mean steps of the first there; None without any such environment.
        more_steps: Mean steps of the second there.
        reproduced: Whether the first takes fewer steps here too; None where nobody can tell.
    """

    fewer: str
    more: str
    environments: int
    fewer_steps: float | None
    more_steps: float | None
    reproduced: bool | None


@dataclass(frozen=True)
class Summary:
    """The table.

    Attributes:
        environments: How many there were.
        feasible: Those that have a way for a disc of radius 0.22 m.
        common: Those that all of ``compared`` solved.
        compared: The planners that ``common`` is about: those with ways out, which solve most.
        lines: One for each planner.
        orders: The paper's orders, two by two.
    """

    environments: int
    feasible: int
    common: int
    compared: tuple[str, ...]
    lines: tuple[Line, ...]
    orders: tuple[Order, ...]


def summary_of(
    rows: Iterable[Row],
    roles: Mapping[str, str],
    limit: int | None,
    rng: np.random.Generator,
) -> Summary:
    """Return the table.

    Args:
        rows: Rows of one drive and one number of obstacles, in any order.
        roles: What rows beside the paper's are called for a person, by what rows call the planner.
        limit: M_s, which a failure counts as; None where steps are no decisions, as with wheels.
        rng: Draws the resamples of the intervals.
    """
    table = by_planner(rows)
    names = [name for name in (*PAPER_STEPS, *roles) if name in table]
    compared = tuple(
        name for name in names if name not in ("fuzzy", "q-learning", "q-lambda", *POSITIONAL)
    ) or tuple(names)
    common = solved_by_all(table, compared)
    seed = int(rng.integers(2**63))
    lines = []
    for name in names:
        mine = list(table[name].values())
        reached = [row for row in mine if row.success]
        steps = [float(row.steps) for row in reached if row.steps is not None]
        dice = np.random.default_rng(seed)
        lines.append(
            Line(
                planner=name,
                role=roles.get(name, name),
                paper=PAPER_STEPS.get(name),
                runs=len(mine),
                reached=len(reached),
                collisions=sum(row.collisions or 0 for row in mine),
                # The mean alone, by the same bootstrap: the difference to nothing.
                steps=mean_of_differences(steps, [0.0] * len(steps), dice),
                common=_mean([table[name][run] for run in common]) if name in compared else None,
                punished=None if limit is None else _punished(mine, limit),
                time=fmean(row.time_s or 0.0 for row in reached) if reached else None,
            )
        )
    return Summary(
        environments=len({row.run for mine in table.values() for row in mine.values()}),
        feasible=len(feasible_runs(table)),
        common=len(common),
        compared=compared,
        lines=tuple(lines),
        orders=_orders_of(table),
    )


def _orders_of(table: ByPlanner) -> tuple[Order, ...]:
    known = sorted((name for name in PAPER_STEPS if name in table), key=PAPER_STEPS.__getitem__)
    orders = []
    for fewer, more in combinations(known, 2):
        both = [
            run for run, row in table[fewer].items() if row.success and table[more][run].success
        ]
        one, two = (_mean([table[name][run] for run in both]) for name in (fewer, more))
        seen = None if one is None or two is None else one < two
        orders.append(Order(fewer, more, len(both), one, two, seen))
    return tuple(orders)


def _mean(rows: Sequence[Row]) -> float | None:
    return fmean(float(row.steps or 0) for row in rows) if rows else None


def _punished(rows: Sequence[Row], limit: int) -> float | None:
    return fmean(float(row.steps or 0) if row.success else float(limit) for row in rows)
