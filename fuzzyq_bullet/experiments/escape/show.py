"""The table of ``fuzzyq bench escape`` for a terminal, and for programs as JSON."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from typing import Any

from rich.table import Table

from fuzzyq_bullet.experiments.escape.table import PATH_RATIOS, Figures, Line

_COLUMNS: tuple[tuple[str, Callable[[Figures], float | None], str], ...] = (
    ("found", lambda one: one.found, ".2f"),
    ("of all", lambda one: one.found_of_all, ".2f"),
    ("hits", lambda one: one.collisions, "d"),
    ("path", lambda one: one.path_ratio, ".2f"),
    ("time", lambda one: one.time_ratio, ".2f"),
    ("clear", lambda one: one.clearance, ".3f"),
)


def as_table(lines: Sequence[Line], planner: str, seed: int) -> Table:
    """Return the table for a terminal; it fits into 80 columns.

    Args:
        lines: Its lines.
        planner: The planner and how it is set, in words.
        seed: Seed of the sweep.
    """
    ratios = ", ".join(f"{bound:.2f} at {count}" for count, bound in PATH_RATIOS.items())
    table = Table(
        box=None,
        padding=(0, 1, 0, 0),
        caption=(
            f"{planner}; seed {seed}; walled 10 × 10 m, start and goal near corners at random.\n"
            "feasible: there is a way for a disc of radius 0.22 m; found: share of those that "
            "reached the goal; hits: collisions in all; path: mean over the successes of driven "
            "over shortest path; time: median over the successes, in times of the shortest path "
            "at full speed; clear: least distance to anything (m).\n"
            f"Targets: found 1.00, no hits, no errors; path at most {ratios} scattered obstacles."
        ),
        caption_justify="left",
    )
    table.add_column("obstacles", no_wrap=True)
    table.add_column("feasible", no_wrap=True)
    table.add_column("drive", no_wrap=True)
    for name, _, _ in _COLUMNS:
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("targets", no_wrap=True)
    for line in lines:
        what = line.family if line.count is None else f"{line.family} {line.count}"
        cells = [
            "\n".join(_shown(figure(one), form) for one in line.drives.values())
            for _, figure, form in _COLUMNS
        ]
        feasible = f"{line.feasible} of {line.environments}"
        verdicts = ("MISSED" if line.missed_by(drive) else "met" for drive in line.drives)
        table.add_row(what, feasible, "\n".join(line.drives), *cells, "\n".join(verdicts))
    return table


def as_json(lines: Sequence[Line], settings: Mapping[str, Any], rate: float) -> str:
    """Return the table as JSON, with the settings and the episodes per second of this time."""
    rows = [
        {
            **asdict(line),
            "targets": [{**asdict(one), "met": one.met} for one in line.targets],
        }
        for line in lines
    ]
    return json.dumps(
        {"settings": dict(settings), "episodes_per_s": round(rate, 3), "rows": rows}, indent=2
    )


def _shown(value: float | None, form: str) -> str:
    return "–" if value is None else format(value, form)
