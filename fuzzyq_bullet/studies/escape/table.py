"""From the rows of a sweep to what they say: figures for every family, and targets met or missed.

Pure arithmetic; nothing is run or printed.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from statistics import fmean, median
from typing import Literal

from fuzzyq_bullet.scenario import Robot
from fuzzyq_bullet.studies.runner.episodes import Row

TRAPS = ("semicircle", "arc", "u-shape", "long-wall")
"""Taken in turn, each of a size and direction that its seed draws."""
PATH_RATIOS = {25: 1.10, 50: 1.25, 125: 2.0}
"""Most that the mean path may be, in shortest paths, by the number of scattered obstacles."""


@dataclass(frozen=True)
class Figures:
    """What the episodes of one family with one drive came to.

    Attributes:
        episodes: How many.
        feasible: Those among them that have a way for a disc of radius 0.22 m. Where an error left
            that unknown it counts as one: an error excuses nothing.
        found: Share of the feasible that reached the goal; None where none is.
        found_of_all: Share of all that did.
        collisions: How many ended in a collision.
        errors: How many failed themselves.
        path_ratio: Mean over the successes of driven over shortest path; None without any.
        time_ratio: Median over the successes of the time to the goal over that of the shortest path
            at full speed; None without any.
        clearance: Least distance to anything in any of them (m); None when there was nothing.
    """

    episodes: int
    feasible: int
    found: float | None
    found_of_all: float
    collisions: int
    errors: int
    path_ratio: float | None
    time_ratio: float | None
    clearance: float | None

    @classmethod
    def of(cls, rows: Sequence[Row], speed: float) -> Figures:
        """Return the figures of at least one row; ``speed`` is the robot's greatest (m/s)."""
        feasible = [row for row in rows if row.feasible is not False]
        found = [row for row in rows if row.success]
        ways = [
            (row.path_length_m / row.shortest_path_m, row.time_s * speed / row.shortest_path_m)
            for row in found
            if row.shortest_path_m and row.path_length_m is not None and row.time_s is not None
        ]
        clearances = [row.min_clearance_m for row in rows if row.min_clearance_m is not None]
        return cls(
            episodes=len(rows),
            feasible=len(feasible),
            found=sum(row.success for row in feasible) / len(feasible) if feasible else None,
            found_of_all=len(found) / len(rows),
            collisions=sum(row.collisions or 0 for row in rows),
            errors=sum(row.outcome == "error" for row in rows),
            path_ratio=fmean(path for path, _ in ways) if ways else None,
            time_ratio=median(time for _, time in ways) if ways else None,
            clearance=min(clearances, default=None),
        )


@dataclass(frozen=True)
class Target:
    """What a figure should be.

    Attributes:
        what: Which figure.
        drive: With which drive.
        figure: What it is; None where there was nothing to measure.
        bound: What it should be.
        sense: Whether it should be just that, or at most.
    """

    what: str
    drive: str
    figure: float | None
    bound: float
    sense: Literal["exactly", "at most"] = "exactly"

    @property
    def met(self) -> bool:
        """Whether it is met; what could not be measured misses nothing."""
        if self.figure is None:
            return True
        if self.sense == "at most":
            return self.figure <= self.bound
        return self.figure == self.bound


@dataclass(frozen=True)
class Line:
    """One line of the table.

    Attributes:
        family: ``scatter``, ``traps`` or ``rectangles``.
        count: Number of obstacles; None for traps.
        environments: How many different ones.
        feasible: Those that have a way.
        drives: The figures for each drive.
        targets: What is asked of them.
    """

    family: str
    count: int | None
    environments: int
    feasible: int
    drives: dict[str, Figures]
    targets: tuple[Target, ...]

    def missed_by(self, drive: str) -> tuple[Target, ...]:
        """Return the targets that are not met with a drive."""
        return tuple(one for one in self.targets if one.drive == drive and not one.met)


def table_of(rows: Iterable[Row], *, speed: float | None = None) -> list[Line]:
    """Return the table: scatter fields by count, traps, rectangles by count.

    Args:
        rows: Rows of one planner, in any order.
        speed: Greatest speed of the robot (m/s); by default that of a scenario that says nothing.
    """
    full = Robot().max_speed if speed is None else speed
    groups: dict[tuple[int, str, int], dict[str, list[Row]]] = {}
    for row in rows:
        family = "traps" if row.layout in TRAPS else row.layout
        place = ("scatter", "traps", "rectangles").index(family)
        group = groups.setdefault((place, family, -1 if row.count is None else row.count), {})
        group.setdefault(row.drive, []).append(row)
    return [
        _line(family, None if count < 0 else count, group, full)
        for (_, family, count), group in sorted(groups.items())
    ]


def _line(family: str, count: int | None, group: dict[str, list[Row]], speed: float) -> Line:
    # Wheels first: what is measured in physics counts, the point robot stands beside it.
    drives = {name: Figures.of(group[name], speed) for name in sorted(group, reverse=True)}
    seen = {row.key[2:]: row.feasible is not False for rows in group.values() for row in rows}
    targets: list[Target] = []
    for drive, figures in drives.items():
        targets.append(Target("found", drive, figures.found, 1.0))
        targets.append(Target("collisions", drive, figures.collisions, 0.0))
        targets.append(Target("errors", drive, figures.errors, 0.0))
        if family == "scatter" and count in PATH_RATIOS:
            bound = PATH_RATIOS[count]
            targets.append(Target("path ratio", drive, figures.path_ratio, bound, "at most"))
    return Line(family, count, len(seen), sum(seen.values()), drives, tuple(targets))
