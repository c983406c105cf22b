"""The tables of ``fuzzyq bench learning`` for a terminal, and all of it for programs as JSON."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict
from typing import Any

from rich.console import Group
from rich.table import Table

from fuzzyq_bullet.experiments.learning_gain.candidates import label_of
from fuzzyq_bullet.experiments.learning_gain.choice import Choice
from fuzzyq_bullet.experiments.learning_gain.statistics import Estimate
from fuzzyq_bullet.experiments.learning_gain.table import Against, Figures, Summary

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


WIDTH = 100
"""Columns that the tables need."""


def as_tables(summary: Summary, about: str) -> Group:
    """Return the tables for a terminal; they fit into ``WIDTH`` columns.

    Args:
        summary: What to show.
        about: How it was made, in words.
    """
    return Group(_planners(summary, about), "", _against(summary), "", _counts(summary))


def as_json(
    summary: Summary,
    choices: Mapping[str, Choice],
    settings: Mapping[str, Any],
    unseen: Mapping[str, int],
) -> str:
    """Return all of it as JSON.

    Args:
        summary: What the comparison says.
        choices: What the search chose, by role.
        settings: Those of both sweeps.
        unseen: Least and greatest seed of the comparison, and the first of any training.
    """
    return json.dumps(
        {
            "settings": dict(settings),
            "seeds": dict(unseen),
            "search": {role: _choice(choice) for role, choice in choices.items()},
            **asdict(summary),
            "targets": [{**asdict(one), "met": one.met} for one in summary.targets],
        },
        indent=2,
    )


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


def _planners(summary: Summary, about: str) -> Table:
    table = _table(
        f"{about}\n{summary.feasible} of {summary.environments} environments have a way for a disc "
        "of radius 0.22 m. success: share of these in which the goal was reached; hits: collisions "
        f"in all. The rest are means over the {summary.common} environments that all planners "
        "solved: time to the goal, steps of the simulation, driven over shortest path, least "
        "distance to anything in a run; least: the least of any run."
    )
    table.add_column("planner", no_wrap=True)
    table.add_column("weights", no_wrap=True)
    for name, _, _ in _FIGURES:
        table.add_column(name, justify="right", no_wrap=True)
    for line in summary.lines:
        cells = [_shown(figure(line.figures), form) for _, figure, form in _FIGURES]
        weights = line.planner.removeprefix("fixed-").replace("-", "/")
        table.add_row(line.role, "by situation" if line.role == line.planner else weights, *cells)
    return table


def _against(summary: Summary) -> Table:
    met = "; ".join(f"{one}: {'met' if one.met else 'MISSED'}" for one in summary.targets)
    table = _table(
        "÷: learned over the other, −: learned less the other, with 95 % intervals from the same "
        "environments: over those that both solved, except success (all feasible) and hits (all). "
        "time, steps, path: ratio of means; usual time: median of the ratios. %: in 100 runs.\n"
        f"Targets: {met}."
    )
    table.add_column("learned to", no_wrap=True)
    for one in summary.against:
        table.add_column(one.role, justify="right", no_wrap=True)
    for name, figure, form in _AGAINST:
        cells = [_interval(figure(one), form) for one in summary.against]
        table.add_row(name, *cells)
    pairs = ["–" if one.time is None else str(one.time.pairs) for one in summary.against]
    table.add_row("solved by both", *pairs)
    return table


def _counts(summary: Summary) -> Table:
    table = _table("The learned planner and the best pair by the number of obstacles.")
    for name in ("obstacles", "feasible", "learned solved", "pair solved", "time ÷"):
        table.add_column(name, justify="right", no_wrap=True)
    for one in summary.counts:
        table.add_row(
            *map(str, (one.count, one.feasible, one.ours, one.theirs)), _interval(one.time, ".3f")
        )
    return table


def _table(caption: str) -> Table:
    return Table(box=None, padding=(0, 1, 0, 0), caption=caption, caption_justify="left")


def _interval(estimate: Estimate | None, form: str) -> str:
    if estimate is None:
        return "–"
    value, low, high = (format(v, form) for v in (estimate.value, estimate.low, estimate.high))
    return f"{value} [{low}, {high}]"


def _times(estimate: Estimate | None, factor: float) -> Estimate | None:
    """Return an estimate in another unit, a positive ``factor`` smaller."""
    if estimate is None:
        return None
    value, low, high = (factor * one for one in (estimate.value, estimate.low, estimate.high))
    return Estimate(value, low, high, estimate.pairs)


def _shown(value: float | None, form: str) -> str:
    return "–" if value is None else format(value, form)
