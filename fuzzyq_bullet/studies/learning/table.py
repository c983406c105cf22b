"""From the rows of the comparison to what they say. Pure arithmetic; nothing is run or printed.

How failures count: a run that did not reach the goal counts against success, and its time, steps,
path and clearance count nowhere, on neither side. A collision counts wherever it happens.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean
from typing import TypeAlias

import numpy as np

from fuzzyq_bullet.studies.episodes import Row
from fuzzyq_bullet.studies.statistics import (
    ByPlanner,
    Estimate,
    by_planner,
    difference_of_shares,
    feasible_runs,
    mean_of_differences,
    median_of_ratios,
    ratio_of_means,
    solved_by_all,
)
from fuzzyq_bullet.studies.study import Target

LEARNED = "learned"
"""What rows call the planner that has learned."""
LEAST_GAIN = 0.95
"""Most that the learned planner's mean time may be, in times of the best triple's."""

Dice: TypeAlias = Callable[[], np.random.Generator]
"""Gives a generator in the same state every time: the same pairs have the same interval."""
_Figure: TypeAlias = Callable[[Row], "float | None"]


@dataclass(frozen=True)
class Figures:
    """What one planner came to.

    Attributes:
        found: Share of the feasible environments in which it reached the goal; None where none is.
        collisions: How many of all its runs ended in one.
        errors: How many of all failed themselves.
        time: Mean time to the goal (s); so are the next four, over the environments that all
            planners solved, and None where there is none.
        steps: Mean number of steps of the simulation.
        path: Mean of driven over shortest path.
        clearance: Mean of the least distance to anything in a run (m).
        least: Least distance to anything in any of them (m).
    """

    found: float | None
    collisions: int
    errors: int
    time: float | None
    steps: float | None
    path: float | None
    clearance: float | None
    least: float | None

    @classmethod
    def of(cls, rows: Mapping[int, Row], feasible: set[int], common: Sequence[int]) -> Figures:
        """Return the figures of a planner from its rows by environment."""
        ends = [rows[run].success for run in sorted(feasible)]
        shared = [rows[run] for run in common]
        clearances = _known(shared, lambda row: row.min_clearance_m)
        return cls(
            found=sum(ends) / len(ends) if ends else None,
            collisions=sum(row.collisions or 0 for row in rows.values()),
            errors=sum(row.outcome == "error" for row in rows.values()),
            time=_mean(_known(shared, lambda row: row.time_s)),
            steps=_mean(_known(shared, lambda row: row.steps)),
            path=_mean(_known(shared, lambda row: row.path_ratio)),
            clearance=_mean(clearances),
            least=min(clearances, default=None),
        )


@dataclass(frozen=True)
class Line:
    """A line of the first table: what a planner is there for, what rows call it, its figures."""

    role: str
    planner: str
    figures: Figures


@dataclass(frozen=True)
class Against:
    """The learned planner against another, environment by environment.

    Attributes:
        role: What the other is there for.
        planner: What the rows call it.
        success: Difference of the shares of feasible environments that were solved.
        collisions: Difference of the shares of all environments that ended in a collision.
        time: Ratio of the mean times, over the feasible environments that both solved; so are the
            next four over those, and None where there is nothing to compare.
        usual_time: Median of the ratios of times.
        steps: Ratio of the mean steps.
        path: Ratio of the mean path ratios.
        clearance: Mean difference of the least distances (m).
    """

    role: str
    planner: str
    success: Estimate | None
    collisions: Estimate | None
    time: Estimate | None
    usual_time: Estimate | None
    steps: Estimate | None
    path: Estimate | None
    clearance: Estimate | None

    @classmethod
    def of(cls, role: str, planner: str, table: ByPlanner, dice: Dice) -> Against:
        """Return the comparison of the learned planner with another."""
        ours, theirs = table[LEARNED], table[planner]
        feasible, everywhere = sorted(feasible_runs(table)), sorted(ours)
        both = [(ours[run], theirs[run]) for run in solved_by_all(table, (LEARNED, planner))]
        times = _pairs(both, lambda row: row.time_s)
        return cls(
            role=role,
            planner=planner,
            success=difference_of_shares(
                [ours[run].success for run in feasible], [theirs[run].success for run in feasible]
            ),
            collisions=difference_of_shares(
                [bool(ours[run].collisions) for run in everywhere],
                [bool(theirs[run].collisions) for run in everywhere],
            ),
            time=ratio_of_means(*times, dice()),
            usual_time=median_of_ratios(*times, dice()),
            steps=ratio_of_means(*_pairs(both, lambda row: row.steps), dice()),
            path=ratio_of_means(*_pairs(both, lambda row: row.path_ratio), dice()),
            clearance=mean_of_differences(*_pairs(both, lambda row: row.min_clearance_m), dice()),
        )


@dataclass(frozen=True)
class AtCount:
    """The learned planner against its rival, at one number of obstacles.

    Attributes:
        count: How many obstacles.
        feasible: Environments that have a way.
        ours: How many of them the learned planner solved.
        theirs: How many the rival did.
        time: Ratio of the mean times, over those that both solved.
    """

    count: int
    feasible: int
    ours: int
    theirs: int
    time: Estimate | None


@dataclass(frozen=True)
class Summary:
    """What the comparison says.

    Attributes:
        environments: How many there were.
        feasible: Those that have a way.
        common: Those that all planners solved.
        lines: A line for each planner.
        against: The learned one against each other.
        counts: The learned one against its rival, by number of obstacles.
        targets: What is asked of it.
    """

    environments: int
    feasible: int
    common: int
    lines: tuple[Line, ...]
    against: tuple[Against, ...]
    counts: tuple[AtCount, ...]
    targets: tuple[Target, ...]


def summary_of(
    rows: Iterable[Row], roles: Mapping[str, str], rival: str, rng: np.random.Generator
) -> Summary:
    """Return what the rows say.

    Args:
        rows: Rows of all planners, in any order.
        roles: By what the other planners are there for, what the rows call them.
        rival: The role of the one that the targets are about.
        rng: Draws the resamples of all intervals.

    Raises:
        ValueError: If a planner has no row for an environment that another has one for.
    """
    table = by_planner(rows)
    if any(table.get(name, {}).keys() != table[LEARNED].keys() for name in roles.values()):
        raise ValueError("not every planner has a row for every environment")
    seed = int(rng.integers(2**63))
    feasible = feasible_runs(table)
    common = solved_by_all(table, {*roles.values(), LEARNED})
    lines = tuple(
        Line(role, name, Figures.of(table[name], feasible, common))
        for role, name in (*roles.items(), (LEARNED, LEARNED))
    )

    def dice() -> np.random.Generator:
        return np.random.default_rng(seed)

    against = tuple(Against.of(role, name, table, dice) for role, name in roles.items())
    headline = next(one for one in against if one.role == rival)
    return Summary(
        environments=len(table[LEARNED]),
        feasible=len(feasible),
        common=len(common),
        lines=lines,
        against=against,
        counts=_by_count(table, roles[rival], dice),
        targets=_targets(headline, lines),
    )


def time_ratios(rows: Iterable[Row], other: str) -> dict[int, list[float]]:
    """Return, by number of obstacles, learned over other time in each environment both solved."""
    table = by_planner(rows)
    ratios: dict[int, list[float]] = {}
    for run in solved_by_all(table, (LEARNED, other)):
        ours, theirs = table[LEARNED][run], table[other][run]
        if ours.time_s is not None and theirs.time_s:
            ratios.setdefault(ours.count or 0, []).append(ours.time_s / theirs.time_s)
    return dict(sorted(ratios.items()))


def _by_count(table: ByPlanner, rival: str, dice: Dice) -> tuple[AtCount, ...]:
    feasible = feasible_runs(table)
    lines = []
    for count in sorted({row.count or 0 for row in table[LEARNED].values()}):
        ours, theirs = (
            {run: row for run, row in table[name].items() if (row.count or 0) == count}
            for name in (LEARNED, rival)
        )
        here = sorted(feasible & ours.keys())
        both = [(ours[run], theirs[run]) for run in here]
        solved = [(one, two) for one, two in both if one.success and two.success]
        lines.append(
            AtCount(
                count=count,
                feasible=len(here),
                ours=sum(one.success for one, _ in both),
                theirs=sum(two.success for _, two in both),
                time=ratio_of_means(*_pairs(solved, lambda row: row.time_s), dice()),
            )
        )
    return tuple(lines)


def _targets(rival: Against, lines: Sequence[Line]) -> tuple[Target, ...]:
    learned = next(line.figures for line in lines if line.planner == LEARNED)
    time = None if rival.time is None else rival.time.value
    most = None if rival.time is None else rival.time.high
    success = None if rival.success is None else rival.success.value
    errors = sum({line.planner: line.figures.errors for line in lines}.values())
    return (
        Target(f"time over that of the {rival.role}", time, LEAST_GAIN, "at most"),
        Target("upper end of its interval", most, 1.0, "at most"),
        Target("collisions", learned.collisions, 0.0, "exactly"),
        Target(f"success less that of the {rival.role}", success, 0.0, "at least"),
        Target("errors", errors, 0.0, "exactly"),
    )


def _pairs(both: Iterable[tuple[Row, Row]], figure: _Figure) -> tuple[list[float], list[float]]:
    """Return a figure of both, from those pairs in which both have it."""
    found = [(figure(ours), figure(theirs)) for ours, theirs in both]
    known = [(one, two) for one, two in found if one is not None and two is not None]
    return [one for one, _ in known], [two for _, two in known]


def _known(rows: Iterable[Row], figure: _Figure) -> list[float]:
    return [value for value in map(figure, rows) if value is not None]


def _mean(values: Sequence[float]) -> float | None:
    return fmean(values) if values else None
