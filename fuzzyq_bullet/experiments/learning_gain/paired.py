"""Rows side by side: which planner met which environment, and where two can be compared."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import TypeAlias

from fuzzyq_bullet.experiments.sweep.rows import Row

ByPlanner: TypeAlias = Mapping[str, Mapping[int, Row]]
"""Rows by planner and number of the environment."""


def by_planner(rows: Iterable[Row]) -> ByPlanner:
    """Return rows by what they call the planner, then by the number of the environment.

    Raises:
        ValueError: If two rows are of the same planner and number.
    """
    table: dict[str, dict[int, Row]] = {}
    for row in rows:
        mine = table.setdefault(row.planner, {})
        if row.run in mine:
            raise ValueError(f"{row.planner} has two rows for environment {row.run}")
        mine[row.run] = row
    return table


def feasible_runs(table: ByPlanner) -> set[int]:
    """Return the environments that have a way.

    Where an error left that unknown to every planner it counts as one: an error excuses nothing.
    """
    rows = [row for mine in table.values() for row in mine.values()]
    closed = {row.run for row in rows if row.feasible is False}
    return {row.run for row in rows} - closed


def solved_by_all(table: ByPlanner, planners: Collection[str]) -> list[int]:
    """Return the feasible environments in which each of the planners reached the goal, sorted."""
    feasible = feasible_runs(table)
    return sorted(
        run
        for run in feasible
        if all(run in table[name] and table[name][run].success for name in planners)
    )
