"""Which runs are worth watching: the best, the median and the worst of each planner."""

from __future__ import annotations

import math
from collections.abc import Iterable

from fuzzyq_bullet.studies.runner.rows import Row

RULE = (
    "All runs of a planner that have a row without an error, in this order: first those that "
    "reached the goal, by the time they took over that of the shortest path at full speed; then "
    "those that failed where there is no way for a disc of radius 0.22 m; last those that failed "
    "although there is one, by their time. Best is the first, median the one in the middle, worst "
    "the last: a failure, if there is one."
)


def picked(rows: Iterable[Row], planner: str) -> dict[str, Row]:
    """Return a planner's best, median and worst run; what is the same run is one entry.

    Returns:
        Runs by what they are, such as ``best`` or ``median and worst``; empty without any run.
    """
    runs = [row for row in rows if row.planner == planner and row.outcome != "error"]
    runs.sort(key=_order)
    if not runs:
        return {}
    places = {"best": 0, "median": (len(runs) - 1) // 2, "worst": len(runs) - 1}
    roles: dict[int, list[str]] = {}
    for role, place in places.items():
        roles.setdefault(place, []).append(role)
    return {_listed(names): runs[place] for place, names in roles.items()}


def pace(row: Row) -> float | None:
    """Return the time of a run in times of the shortest path at 1 m/s; None without such a path.

    The robot's greatest speed is the same in all runs, so the order is that of the true ratio.
    """
    if row.time_s is None or not row.shortest_path_m:
        return None
    return row.time_s / row.shortest_path_m


def _order(row: Row) -> tuple[object, ...]:
    time = row.time_s or 0.0
    if row.success:
        ratio = pace(row)
        return 0, math.inf if ratio is None else ratio, time, row.key
    return 1 if row.feasible is False else 2, 0.0, time, row.key


def _listed(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
