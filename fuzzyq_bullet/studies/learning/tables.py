"""The tables of ``fuzzyq bench learning``: planners, the learned one against each, and by count."""

from __future__ import annotations

from collections.abc import Callable

from fuzzyq_bullet.studies.learning.table import Against, Figures, Summary
from fuzzyq_bullet.studies.statistics import Estimate
from fuzzyq_bullet.studies.study import Table

_FIGURES: tuple[tuple[str, Callable[[Figures], float | None], str], ...] = (
    ("success", lambda one: one.found, ".3f"),
    ("hits", lambda one: one.collisions, "d"),
    ("time s", lambda one: one.time, ".2f"),
    ("steps", lambda one: one.steps, ".0f"),
    ("path", lambda one: one.path, ".3f"),
    ("clear m", lambda one: one.clearance, ".3f"),
    ("least m", lambda one: one.least, ".3f"),
)
_AGAINST: tuple[tuple[str, Callable[[Against], Estimate | None], str], ...] = (
    ("success − %", lambda one: _times(one.success, 100.0), "+.1f"),
    ("hits − %", lambda one: _times(one.collisions, 100.0), "+.1f"),
    ("time ÷", lambda one: one.time, ".3f"),
    ("usual time ÷", lambda one: one.usual_time, ".3f"),
    ("steps ÷", lambda one: one.steps, ".3f"),
    ("path ÷", lambda one: one.path, ".3f"),
    ("clear − mm", lambda one: _times(one.clearance, 1000.0), "+.0f"),
)


def tables_of(summary: Summary, about: str) -> tuple[Table, ...]:
    """Return the tables; they fit into 100 columns.

    Args:
        summary: What to show.
        about: How it was made, in words.
    """
    return _planners(summary, about), _against(summary), _counts(summary)


def _planners(summary: Summary, about: str) -> Table:
    rows = []
    for line in summary.lines:
        weights = line.planner.removeprefix("fixed-").replace("-", "/")
        named = "by situation" if line.role == line.planner else weights
        cells = [_shown(figure(line.figures), form) for _, figure, form in _FIGURES]
        rows.append([line.role, named, *cells])
    return Table(
        f"{about}\n{summary.feasible} of {summary.environments} environments have a way for a disc "
        "of radius 0.22 m. success: share of these in which the goal was reached; hits: collisions "
        f"in all. The rest are means over the {summary.common} environments that all planners "
        "solved: time to the goal, steps of the simulation, driven over shortest path, least "
        "distance to anything in a run; least: the least of any run.",
        ("planner", "weights", *(name for name, _, _ in _FIGURES)),
        rows,
        left=(0, 1),
    )


def _against(summary: Summary) -> Table:
    met = "; ".join(f"{one}: {'met' if one.met else 'MISSED'}" for one in summary.targets)
    rows = [
        [name, *(_interval(figure(one), form) for one in summary.against)]
        for name, figure, form in _AGAINST
    ]
    pairs = ["–" if one.time is None else str(one.time.pairs) for one in summary.against]
    return Table(
        "÷: learned over the other, −: learned less the other, with 95 % intervals from the same "
        "environments: over those that both solved, except success (all feasible) and hits (all). "
        "time, steps, path: ratio of means; usual time: median of the ratios. %: in 100 runs.\n"
        f"Targets: {met}.",
        ("learned to", *(one.role for one in summary.against)),
        [*rows, ["solved by both", *pairs]],
    )


def _counts(summary: Summary) -> Table:
    return Table(
        "The learned planner and the best pair by the number of obstacles.",
        ("obstacles", "feasible", "learned solved", "pair solved", "time ÷"),
        [
            [*map(str, (one.count, one.feasible, one.ours, one.theirs)), _interval(one.time, ".3f")]
            for one in summary.counts
        ],
        left=(),
    )


def _interval(estimate: Estimate | None, form: str) -> str:
    return "–" if estimate is None else format(estimate, form)


def _times(estimate: Estimate | None, factor: float) -> Estimate | None:
    return None if estimate is None else estimate.times(factor)


def _shown(value: float | None, form: str) -> str:
    return "–" if value is None else format(value, form)
