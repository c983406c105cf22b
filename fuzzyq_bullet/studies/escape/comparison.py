"""How a planner drives, beside itself without a part, and beside what knows the truth."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from statistics import fmean

import numpy as np

from fuzzyq_bullet.studies.episodes import Row
from fuzzyq_bullet.studies.escape.table import Figures, by_family, family_name
from fuzzyq_bullet.studies.statistics import Estimate, ratio_of_means
from fuzzyq_bullet.studies.study import Table, cell

BESIDE = {
    "no-controller": "straight to the aim at full speed",
    "no-memory": "breakouts that are not sustained, given up after 120 s",
    "true-exits": "the planner, told how far it is to the goal from every exit",
    "true-path": "the true shortest path, driven under the same safety filter",
}
"""What rows call what runs beside the planner, and what it is."""
SUM = "all scatter"
"""What the table calls the scattered fields together."""


@dataclass(frozen=True)
class Contender:
    """How one of those that are compared drove through the environments of a family.

    Attributes:
        family: What the table calls it, with its count.
        planner: What rows call the contender.
        found: Share of the feasible that reached the goal; None where none is.
        collisions: How many ended in one.
        path_ratio: Mean over the successes of driven over shortest path; None without any.
        time_ratio: Mean over the successes of the time, in times of the shortest path at full
            speed; None without any.
        of_planners: Its time over the planner's, in the environments that both crossed; None for
            the planner itself.
        jerk: Mean of |jerk| over all (m/s³); None in the kinematic drive.
        turning: Mean over all of the turning per metre (rad/m); None where nothing was driven.
        rules_turn: Mean share of decisions near something in which the rules turn the robot.
        score: Mean score; None outside of cellular fields.
    """

    family: str
    planner: str
    found: float | None
    collisions: int
    path_ratio: float | None
    time_ratio: float | None
    of_planners: Estimate | None
    jerk: float | None
    turning: float | None
    rules_turn: float | None
    score: float | None


def compare(
    rows: Iterable[Row], planners: Sequence[str], speed: float | None = None
) -> list[Contender]:
    """Return how each drove, by family; the scattered fields of all counts together once more.

    Args:
        rows: Rows with one drive.
        planners: What they call those that are compared, first the planner itself.
        speed: Full speed (m/s), if it is not that of the environments' own robot.
    """
    families = {family_name(*key): group for key, group in by_family(rows).items()}
    scattered = [name for name in families if name.startswith("scatter")]
    if len(scattered) > 1:
        families[SUM] = [row for name in scattered for row in families[name]]
    return [
        contender
        for family, group in families.items()
        for contender in _compared(family, group, planners, speed)
    ]


def _compared(
    family: str, rows: Sequence[Row], planners: Sequence[str], speed: float | None
) -> Iterable[Contender]:
    sets = {name: {row.place: row for row in rows if row.planner == name} for name in planners}
    ours = sets[planners[0]]
    for name, theirs in sets.items():
        if not theirs:
            continue
        figures = Figures.of(list(theirs.values()), speed)
        both = [
            (row.time_s, ours[place].time_s)
            for place, row in sorted(theirs.items())
            if place in ours and row.success and ours[place].success
        ]
        times = [(one, two) for one, two in both if one is not None and two is not None]
        ratio = ratio_of_means(
            [one for one, _ in times], [two for _, two in times], np.random.default_rng(0)
        )
        yield Contender(
            family=family,
            planner=name,
            found=figures.found,
            collisions=figures.collisions,
            path_ratio=figures.path_ratio,
            time_ratio=figures.mean_time_ratio,
            of_planners=None if name == planners[0] else ratio,
            jerk=_mean(row.mean_jerk for row in theirs.values()),
            turning=_mean(_turning(row) for row in theirs.values()),
            rules_turn=_mean(row.rules_turn for row in theirs.values()),
            score=figures.score,
        )


def _turning(row: Row) -> float | None:
    """Return the turning of a run per metre (rad/m)."""
    if row.turning_rad is None or not row.path_length_m:
        return None
    return row.turning_rad / row.path_length_m


def _mean(figures: Iterable[float | None]) -> float | None:
    known = [one for one in figures if one is not None]
    return fmean(known) if known else None


_COLUMNS: tuple[tuple[str, Callable[[Contender], object], str], ...] = (
    ("found", lambda one: one.found, ".2f"),
    ("hits", lambda one: one.collisions, "d"),
    ("path", lambda one: one.path_ratio, ".2f"),
    ("time", lambda one: one.time_ratio, ".2f"),
    ("of its time", lambda one: one.of_planners, ".2f"),
    ("jerk", lambda one: one.jerk, ".2f"),
    ("turning", lambda one: one.turning, ".2f"),
    ("rules", lambda one: one.rules_turn, ".2f"),
    ("score", lambda one: one.score, ".3f"),
)


_MEANINGS = {
    "of its time": "in times of the planner's in the environments that both crossed [95 %]",
    "jerk": "mean of |jerk| (m/s³)",
    "turning": "changes of direction (rad/m)",
    "rules": "share of the decisions near something in which the rules turn the robot",
    "score": "success · OT / clip(time, 2·OT, 8·OT), at most 0.5",
}
"""What the columns mean that the table above does not have."""


def shown_comparison(contenders: Sequence[Contender], drive: str) -> Table:
    """Return the table; columns of which nothing is known are left out."""
    columns = [
        (name, figure, form)
        for name, figure, form in _COLUMNS
        if any(figure(one) is not None for one in contenders)
    ]
    families = list(dict.fromkeys(one.family for one in contenders))
    rows = []
    for family in families:
        some = [one for one in contenders if one.family == family]
        cells = ["\n".join(cell(figure(one), form) for one in some) for _, figure, form in columns]
        rows.append([family, "\n".join(one.planner for one in some), *cells])
    shown = {one.planner for one in contenders} | {name for name, _, _ in columns}
    notes = [
        f"{name}: {meaning}" for name, meaning in (BESIDE | _MEANINGS).items() if name in shown
    ]
    caption = f"How it drives, {drive}. " + "; ".join(notes) + "."
    return Table(caption, ("obstacles", "who", *(name for name, _, _ in columns)), rows, (0, 1))
