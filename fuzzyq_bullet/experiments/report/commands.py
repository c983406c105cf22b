"""The commands that made the sweeps of a report, said again from their settings."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path

from fuzzyq_bullet.experiments.report.settings import Comparison, Escape, Planners, Search


def success(settings: Planners, out: Path) -> str:
    """Return the command of a sweep of Fig. 13."""
    return _line(
        "success",
        ("--planners", ",".join(settings.planners)),
        ("--counts", _numbers(settings.counts)),
        ("--runs", settings.runs),
        ("--drive", settings.drive),
        ("--seed", settings.seed),
        ("--out", out),
    )


def steps(settings: Planners, search: Search | None, pair: tuple[float, float], out: Path) -> str:
    """Return the command of a sweep of Table 5; without a search the pair was given."""
    step, turn = pair
    how = ("--pair", f"{step:g},{turn:g}") if search is None else ("--grid", search.episodes)
    return _line(
        "steps",
        ("--runs", settings.runs),
        ("--count", settings.counts[0]),
        how,
        ("--drive", settings.drive),
        ("--seed", settings.seed),
        ("--out", out),
    )


def learning(settings: Comparison, search: Search, out: Path) -> str:
    """Return the command of a comparison of learned weights with fixed ones."""
    return _line(
        "learning",
        ("--environments", settings.environments),
        ("--counts", _numbers(settings.counts)),
        ("--grid", search.episodes),
        ("--drive", settings.drive),
        ("--seed", settings.seed),
        ("--out", out),
    )


def escape(settings: Escape, out: Path) -> str:
    """Return the command of a sweep of dead ends."""
    weights = settings.planner.get("weights")
    given = [] if not weights else [("--weights", ",".join(f"{one:g}" for one in weights))]
    return _line(
        "escape",
        ("--planner", settings.planner.get("name", "")),
        *given,
        ("--runs", settings.runs),
        ("--counts", _numbers(settings.counts)),
        ("--traps", settings.traps),
        ("--rectangles", _numbers(settings.rectangles)),
        ("--drive", settings.drives[0] if len(settings.drives) == 1 else "both"),
        ("--seed", settings.seed),
        ("--out", out),
    )


def _numbers(counts: Sequence[int]) -> str:
    return ",".join(map(str, counts)) or "none"


def _line(name: str, *options: tuple[str, object]) -> str:
    given = (f"{option} {shlex.quote(str(value))}" for option, value in options)
    return f"fuzzyq bench {name} {' '.join(given)}"
