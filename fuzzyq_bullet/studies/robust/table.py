"""What disturbances do to planners, as lines of a table."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from statistics import geometric_mean

from fuzzyq_bullet.studies.episodes import Row
from fuzzyq_bullet.studies.statistics import share
from fuzzyq_bullet.studies.study import Table, Target, cell

Strengths = Callable[[str, int], dict[str, float]]
"""Keys of the scenario file that a disturbance sets at a level, and to what."""
_SHOWN = {"noise": "m", "dropout": "", "pose_noise": "m", "slip": "", "latency": "s"}


@dataclass(frozen=True)
class Line:
    """One planner with one strength of one disturbance.

    Attributes:
        planner: Its name.
        disturbance: Its name; ``none`` without one.
        level: Place on its scale, from 1; 0 without one.
        strength: What the scenario file says, in words.
        feasible: Fields with a way.
        reached: Those of them in which the goal was reached.
        contacts: Runs that ended in a contact, in all fields.
        at_fault: Those of them for which the robot was at fault, or which do not tell.
        errors: Runs that failed themselves.
        least_clearance_m: Least distance to anything in any run (m).
        time_ratio: Geometric mean of the time over that of the undisturbed planner in the same
            field, of the fields that both solved; None where there is none.
    """

    planner: str
    disturbance: str
    level: int
    strength: str
    feasible: int
    reached: int
    contacts: int
    at_fault: int
    errors: int
    least_clearance_m: float | None
    time_ratio: float | None


def lines_of(
    rows: Sequence[Row], labels: Iterable[tuple[str, str, str, int]], strengths: Strengths
) -> list[Line]:
    """Return a line for each label (what rows say, planner, disturbance, level)."""
    by_label: dict[str, dict[tuple[str, int, int], Row]] = {}
    for row in rows:
        by_label.setdefault(row.planner, {})[row.place] = row
    undisturbed: dict[str, dict[tuple[str, int, int], Row]] = {}
    lines = []
    for label, planner, name, level in labels:
        own = by_label.get(label, {})
        plain = undisturbed.setdefault(planner, own)  # the first line of a planner is undisturbed
        both = [at for at, row in own.items() if row.success and at in plain and plain[at].success]
        ratios = [(own[at].time_s or math.nan) / (plain[at].time_s or math.nan) for at in both]
        told = strengths(name, level)
        hit = [row for row in own.values() if row.collisions]
        near = [row.min_clearance_m for row in own.values() if row.min_clearance_m is not None]
        lines.append(
            Line(
                planner=planner,
                disturbance=name,
                level=level,
                strength=_in_words(told),
                feasible=sum(bool(row.feasible) for row in own.values()),
                reached=sum(bool(row.feasible) and row.success for row in own.values()),
                contacts=len(hit),
                at_fault=sum(row.at_fault is not False for row in hit),
                errors=sum(row.error is not None for row in own.values()),
                least_clearance_m=min(near, default=None),
                time_ratio=geometric_mean(ratios) if ratios else None,
            )
        )
    return lines


def targets_of(line: Line) -> Iterable[Target]:
    """Yield what a line of usual strength should show."""
    what = f"{line.planner}, {line.disturbance} {line.strength}"
    reached = line.reached / line.feasible if line.feasible else None
    yield Target(f"{what}: contacts", line.contacts, 0, "exactly")
    yield Target(f"{what}: success", reached, 0.99, "at least")


def shown(lines: Sequence[Line], about: str) -> Table:
    """Return the lines as a table."""
    rows = []
    for line in lines:
        reached = share(line.reached, line.feasible)
        interval = "–" if reached is None else f"[{reached.low:.2f}, {reached.high:.2f}]"
        rows.append(
            [
                line.planner,
                line.disturbance,
                line.strength,
                f"{line.reached} of {line.feasible}",
                interval,
                str(line.contacts),
                str(line.at_fault),
                cell(line.least_clearance_m, ".3f"),
                cell(line.time_ratio, ".2f"),
            ]
        )
    heads = (
        "planner", "disturbance", "strength", "reached", "95 %", "contacts", "at fault", "least m",
        "time",
    )  # fmt: skip
    caption = (
        f"What disturbances do: {about}. reached: of the fields with a way, with Wilson's "
        "interval; at fault: contacts for which the robot was at fault; least: distance to "
        "anything, in any run; time: geometric mean of the time over that of the undisturbed "
        "planner in the same field, of the fields that both solved."
    )
    return Table(caption, heads, rows, left=(0, 1, 2))


def _in_words(told: dict[str, float]) -> str:
    named = {key: value for key, value in told.items() if key in _SHOWN}
    if len(named) > 1:
        return "each as above"
    return ", ".join(f"{value:g} {_SHOWN[key]}".strip() for key, value in named.items())
