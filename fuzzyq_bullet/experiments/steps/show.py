"""The table of ``fuzzyq bench steps`` for a terminal, and all of it for programs as JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from rich.console import Group
from rich.table import Table

from fuzzyq_bullet.experiments.steps.table import Summary

WIDTH = 100
"""Columns that the table needs."""


def as_tables(summary: Summary, about: str, limit: int, kinematic: bool) -> Group:
    """Return the table for a terminal; it fits into ``WIDTH`` columns.

    Args:
        summary: What to show.
        about: How it was made, in words.
        limit: M_s.
        kinematic: Whether steps are the paper's, and not those of the physics.
    """
    unit = (
        "Steps are moves by Eq. 17, the paper's steps."
        if kinematic
        else "Steps are those of the physics, 240 a second: not the paper's, look at the time."
    )
    table = Table(
        box=None,
        padding=(0, 1, 0, 0),
        caption=(
            f"{about} {unit} {summary.feasible} of {summary.environments} environments have a way "
            "for a disc of radius 0.22 m.\n"
            "paper: Table 5, whose rules for failures it does not say. steps: mean over the runs "
            "that reached the goal, failures have no steps, with a bootstrapped 95 % interval; "
            f"all reached: mean over the {summary.common} environments that all planners with "
            f"ways out solved; as M_s: mean over all runs, each failure counting as {limit}."
        ),
        caption_justify="left",
    )
    table.add_column("planner", no_wrap=True)
    for name in ("paper", "reached", "hits", "steps", "all reached", "as M_s", "time s"):
        table.add_column(name, justify="right", no_wrap=True)
    for line in summary.lines:
        steps = line.steps
        shown = "–" if steps is None else f"{steps.value:.1f} [{steps.low:.1f}, {steps.high:.1f}]"
        table.add_row(
            line.role,
            "–" if line.paper is None else str(line.paper),
            f"{line.reached} of {line.runs}",
            str(line.collisions),
            shown,
            _number(line.common),
            _number(line.punished),
            _number(line.time),
        )
    told = orders_in_words(summary)
    return Group(table, *(["", *told] if told else []))


def as_json(summary: Summary, settings: Mapping[str, Any], limit: int) -> str:
    """Return all of it as JSON, with the settings of the sweeps and M_s."""
    return json.dumps({"settings": dict(settings), "m_s": limit, **asdict(summary)}, indent=2)


def orders_in_words(summary: Summary) -> list[str]:
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


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.1f}"
