"""The sweeps of a folder, sorted by what they are, and what there is to be made of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from fuzzyq_bullet.experiments.report.films import Wanted
from fuzzyq_bullet.experiments.report.found import Found, sweeps_below
from fuzzyq_bullet.experiments.report.measures import by_planner
from fuzzyq_bullet.experiments.report.pick import picked
from fuzzyq_bullet.experiments.report.settings import Comparison, Escape, Planners, Search


@dataclass(frozen=True)
class Evaluation:
    """What a folder holds.

    Attributes:
        folder: The folder.
        success: Sweeps of Fig. 13.
        steps: Tables of steps; each with the search for its best pair, None where it was given.
        learning: Comparisons of learned weights; each with its search.
        escape: Sweeps of dead ends.
        alone: Searches whose other half has not begun.
    """

    folder: Path
    success: tuple[tuple[Found, Planners], ...]
    steps: tuple[tuple[Found, Planners, Found | None], ...]
    learning: tuple[tuple[Found, Comparison, Found], ...]
    escape: tuple[tuple[Found, Escape], ...]
    alone: tuple[Found, ...]

    @property
    def sweeps(self) -> tuple[Found, ...]:
        """All of them."""
        steps = (one for table, _, search in self.steps for one in (table, search) if one)
        learning = (one for table, _, search in self.learning for one in (table, search))
        first = (found for found, _ in (*self.success, *self.escape))
        return (*first, *steps, *learning, *self.alone)


def evaluation_of(folder: Path) -> Evaluation:
    """Return what a folder holds.

    Raises:
        UserError: If that is no sweep, or one is damaged.
    """
    found = sweeps_below(folder)
    searches = {
        (one.folder.parent, str(one.settings.sweep).split()[0]): one
        for one in found
        if isinstance(one.settings, Search)
    }
    success, steps, learning, escape = [], [], [], []
    for one in found:
        settings, home = one.settings, one.folder.parent
        if isinstance(settings, Planners):
            if settings.sweep == "success":
                success.append((one, settings))
            else:
                steps.append((one, settings, searches.pop((home, "steps"), None)))
        elif isinstance(settings, Comparison):
            search = searches.pop((home, "learning"), None)
            if search is not None:  # without it nobody knows which weights were the best
                learning.append((one, settings, search))
        elif isinstance(settings, Escape):
            escape.append((one, settings))
    return Evaluation(
        folder=folder,
        success=tuple(success),
        steps=tuple(steps),
        learning=tuple(learning),
        escape=tuple(escape),
        alone=tuple(searches.values()),
    )


Place = tuple[Path, str, str]
"""Folder of a sweep, planner, and what the run is."""


def wanted_films(sweeps: Sequence[tuple[Found, Planners]]) -> dict[Place, Wanted]:
    """Return which runs are to be made again: the best, median and worst of each planner."""
    return {
        (sweep.folder, name, role): Wanted(row, settings.planners[name], settings.limits)
        for sweep, settings in sweeps
        for name in by_planner(sweep.rows)
        for role, row in picked(sweep.rows, name).items()
    }
