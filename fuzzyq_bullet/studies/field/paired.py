"""Paired comparisons: a planner against another one in the same fields, with intervals."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fuzzyq_bullet.studies.episodes import Row
from fuzzyq_bullet.studies.field.plan import BOUND
from fuzzyq_bullet.studies.field.table import (
    FEWEST_PAIRS,
    Rows,
    estimate_cell,
    paired_figures,
    turning_of,
)
from fuzzyq_bullet.studies.statistics import Estimate, difference_of_shares, ratio_of_means
from fuzzyq_bullet.studies.study import Table


class Measure(NamedTuple):
    """A figure by which planners are compared.

    Attributes:
        figure: Returns the figure of a run; for a share 1 or 0.
        share: Whether it is a share: then its difference is given, otherwise its ratio.
        more: Whether more is better.
        solved: Whether only the fields count that both planners solved.
    """

    figure: Callable[[Row], float | None]
    share: bool = False
    more: bool = False
    solved: bool = True


MEASURES: Mapping[str, Measure] = {
    "success": Measure(
        lambda row: None if row.feasible is False else float(row.success),
        share=True,
        more=True,
        solved=False,
    ),
    "contacts": Measure(lambda row: float(row.collisions or 0), share=True, solved=False),
    "time": Measure(lambda row: row.time_s),
    "path": Measure(lambda row: row.path_length_m),
    "turning": Measure(turning_of),
    "jerk": Measure(lambda row: row.mean_jerk),
    "decision": Measure(lambda row: row.decision_ms, solved=False),
}
"""What is compared, by the column of the table."""
_SHOWN = tuple(name for name in MEASURES if name != "contacts")
"""The columns that there is room for; a contact is a failure too."""


@dataclass(frozen=True)
class Paired:
    """One planner against the reference planner, in one kind of fields.

    Attributes:
        kind: The kind.
        planner: Name of the planner.
        than: Name of the reference planner.
        figures: By name of the measure: its share − the reference's, or its figure ÷ the
            reference's. None if there is nothing to compare.
    """

    kind: str
    planner: str
    than: str
    figures: Mapping[str, Estimate | None]

    def better(self) -> list[str]:
        """Return the measures in which it is better, by an interval that excludes "equal"."""
        return [
            name
            for name, one in self.figures.items()
            if one is not None and _is_better(MEASURES[name], one)
        ]


def paired(kinds: Mapping[str, Mapping[str, Rows]], than: str) -> list[Paired]:
    """Return every planner except the bound against a reference planner."""
    return [
        Paired(
            kind,
            planner,
            than,
            {name: _compared(measure, met, group[than]) for name, measure in MEASURES.items()},
        )
        for kind, group in kinds.items()
        for planner, met in group.items()
        if planner not in (than, BOUND)
    ]


def _compared(measure: Measure, ours: Rows, theirs: Rows) -> Estimate | None:
    one, two = paired_figures(ours, theirs, measure.figure, solved=measure.solved)
    if measure.share:
        return difference_of_shares([value > 0.5 for value in one], [value > 0.5 for value in two])
    return ratio_of_means(one, two, np.random.default_rng(0))


def _is_better(measure: Measure, one: Estimate) -> bool:
    even = 0.0 if measure.share else 1.0
    if one.pairs < FEWEST_PAIRS:
        return False
    return one.low > even if measure.more else one.high < even


def better_table(pairs: Sequence[Paired], than: str) -> Table | None:
    """Return the table of what others do better than a planner: a reader should see it first.

    Returns:
        None if no comparison has enough fields for an interval.
    """
    rows = [
        [one.kind, one.planner, name, estimate_cell(one.figures[name], form_of(name))]
        for one in pairs
        for name in one.better()
    ]
    count = sum(
        figure is not None and figure.pairs >= FEWEST_PAIRS
        for one in pairs
        for figure in one.figures.values()
    )
    if not count:
        return None
    caption = (
        f"What others do better than {than}, by an interval of 95 % that excludes chance: the "
        f"difference of a share, the ratio of anything else. Of {count} comparisons chance alone "
        f"would put about {count / 40:.0f} here."
    )
    heads = ("fields", "planner", "in", "figure")
    return Table(caption, heads, rows or [["nothing", "–", "–", "–"]], left=(0, 1, 2))


def paired_table(pairs: Sequence[Paired], than: str) -> Table:
    """Return the comparisons as a table."""
    groups: dict[str, list[Paired]] = {}
    for one in pairs:
        groups.setdefault(one.kind, []).append(one)
    rows = [
        [
            kind,
            "\n".join(one.planner for one in group),
            *(
                "\n".join(estimate_cell(one.figures[name], form_of(name)) for one in group)
                for name in _SHOWN
            ),
        ]
        for kind, group in groups.items()
    ]
    caption = (
        f"Each beside {than} in the same fields [95 %, of {FEWEST_PAIRS} and more]. success: share "
        f"less that of {than}, exact interval; the rest over that of {than}, bootstrapped over "
        "fields: time, path, turning and jerk in those that both solved, the median time of a "
        "decision in all."
    )
    return Table(caption, ("fields", "planner", *_SHOWN), rows, left=(0, 1))


def form_of(name: str) -> str:
    """Return how a figure of a measure is written."""
    return "+.2f" if MEASURES[name].share else ".2f"
