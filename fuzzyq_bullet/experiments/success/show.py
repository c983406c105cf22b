"""The tables of ``fuzzyq bench success`` for a terminal, and all of it for programs as JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from rich.console import Group
from rich.table import Table

from fuzzyq_bullet.experiments.success.table import Line, Summary
from fuzzyq_bullet.experiments.wilson import Share

WIDTH = 110
"""Columns that the tables of five planners need."""
HOW_FAILURES_COUNT = (
    "Success is the goal reached without touching anything; a collision, standing still, M_s "
    "decisions without the goal, and an error of the run itself are failures all the same."
)


def as_tables(summary: Summary, about: str, steps: int) -> Group:
    """Return the tables for a terminal; they fit into ``WIDTH`` columns.

    Args:
        summary: What to show.
        about: How it was made, in words.
        steps: M_s: decisions after which a run is given up.
    """
    everywhere = _table(
        f"Success over all environments, with Wilson's 95 % intervals. {about} "
        f"{HOW_FAILURES_COUNT} M_s is {steps}."
    )
    feasible = _table(
        "The same over the environments that have a way for a disc of radius 0.22 m (the robot's "
        "is 0.20)."
    )
    for table, whole in ((everywhere, True), (feasible, False)):
        table.add_column("obstacles", justify="right", no_wrap=True)
        table.add_column("runs", justify="right", no_wrap=True)
        for name in summary.planners:
            table.add_column(name, justify="right", no_wrap=True)
        for line in (*summary.lines, summary.total):
            cells = [line.cells[name] for name in summary.planners]
            table.add_row(
                "all" if line.count is None else str(line.count),
                str(line.environments if whole else line.feasible),
                *(_shown(cell.all if whole else cell.feasible) for cell in cells),
            )
    return Group(everywhere, "", feasible, "", *_ends(summary.total), *_claims(summary))


def as_json(summary: Summary, settings: Mapping[str, Any]) -> str:
    """Return all of it as JSON, with the settings of the sweep."""
    return json.dumps(
        {"settings": dict(settings), "failures": HOW_FAILURES_COUNT, **asdict(summary)}, indent=2
    )


def _ends(total: Line) -> list[str]:
    """Say how the episodes ended that did not end well."""
    told = []
    for name, cell in total.cells.items():
        failures = [f"{n} {kind}" for kind, n in cell.outcomes.items() if kind != "goal"]
        told.append(f"{name}: {', '.join(failures) or 'no failures'} of {cell.all.of}")
    return told


def _claims(summary: Summary) -> list[str]:
    return [
        f'The paper\'s order "{claim.what}": {"seen" if claim.reproduced else "NOT seen"} here.'
        for claim in summary.claims
    ]


def _table(caption: str) -> Table:
    return Table(box=None, padding=(0, 1, 0, 0), caption=caption, caption_justify="left")


def _shown(share: Share | None) -> str:
    if share is None:
        return "–"
    return f"{share.value:.2f} [{share.low:.2f}, {share.high:.2f}]"
