"""How long, how far and how near: what the runs that reached the goal have in common.

Pure arithmetic over rows; nothing is run or drawn.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from fuzzyq_bullet.studies.planner_sets import in_order
from fuzzyq_bullet.studies.runner.rows import Row

Place = tuple[str, int, int]
"""Layout, number of obstacles and number of an environment."""


@dataclass(frozen=True)
class Quartiles:
    """Where the middle half of some figures lies.

    Attributes:
        low: A quarter of them is below.
        middle: The median.
        high: A quarter is above.
    """

    low: float
    middle: float
    high: float


@dataclass(frozen=True)
class Measures:
    """What some runs that reached the goal came to; all are None without any.

    Attributes:
        runs: How many.
        path: Driven over shortest path.
        time: Simulated time to the goal (s).
        clearance: Least distance to anything in a run (m).
        least: The least of these (m).
    """

    runs: int
    path: Quartiles | None
    time: Quartiles | None
    clearance: Quartiles | None
    least: float | None


MEASURES: dict[str, Callable[[Measures], Quartiles | None]] = {
    "driven ÷ shortest path": lambda one: one.path,
    "time to the goal (s)": lambda one: one.time,
    "least distance to anything (m)": lambda one: one.clearance,
}
"""What is drawn, by what it is called."""


def place_of(row: Row) -> Place:
    """Return the environment of a row."""
    return row.layout, -1 if row.count is None else row.count, row.run


def measures_of(rows: Iterable[Row], places: Collection[Place] | None = None) -> Measures:
    """Return the figures of those runs that reached the goal.

    Args:
        rows: Rows of one planner.
        places: The environments to look at; None for all.
    """
    reached = [row for row in rows if row.success and (places is None or place_of(row) in places)]
    near = [row.min_clearance_m for row in reached if row.min_clearance_m is not None]
    return Measures(
        runs=len(reached),
        path=_quartiles(
            [
                row.path_length_m / row.shortest_path_m
                for row in reached
                if row.shortest_path_m and row.path_length_m is not None
            ]
        ),
        time=_quartiles([row.time_s for row in reached if row.time_s is not None]),
        clearance=_quartiles(near),
        least=min(near, default=None),
    )


def by_planner(rows: Iterable[Row]) -> dict[str, list[Row]]:
    """Return rows by planner, in the order in which planners are shown."""
    table: dict[str, list[Row]] = {}
    for row in rows:
        table.setdefault(row.planner, []).append(row)
    return {name: table[name] for name in in_order(list(table))}


def solved_by_all(rows: Iterable[Row]) -> set[Place]:
    """Return the environments in which every planner reached the goal."""
    table = [{place_of(row) for row in mine if row.success} for mine in by_planner(rows).values()]
    return set.intersection(*table) if table else set()


def _quartiles(values: Sequence[float]) -> Quartiles | None:
    if not values:
        return None
    low, middle, high = np.quantile(np.asarray(values), (0.25, 0.5, 0.75)).tolist()
    return Quartiles(low, middle, high)
