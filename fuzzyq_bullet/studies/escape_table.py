"""The table of ``fuzzyq bench escape``: what the episodes of a family came to."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from statistics import fmean, median

from fuzzyq_bullet.scenario import Robot
from fuzzyq_bullet.studies.episodes import Row
from fuzzyq_bullet.studies.study import Sense, Table, cell, meets

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
        mean_time_ratio: The mean of the same.
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
    mean_time_ratio: float | None
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
            mean_time_ratio=fmean(time for _, time in ways) if ways else None,
            clearance=min(clearances, default=None),
        )


@dataclass(frozen=True)
class Target:
    """What a figure should be with a drive; it is None where there was nothing to measure."""

    what: str
    drive: str
    figure: float | None
    bound: float
    sense: Sense = "exactly"

    @property
    def met(self) -> bool:
        """Whether it is met; what could not be measured misses nothing."""
        return self.figure is None or meets(self.figure, self.sense, self.bound)


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
    seen = {row.place: row.feasible is not False for rows in group.values() for row in rows}
    targets: list[Target] = []
    for drive, figures in drives.items():
        targets.append(Target("found", drive, figures.found, 1.0))
        targets.append(Target("collisions", drive, figures.collisions, 0.0))
        targets.append(Target("errors", drive, figures.errors, 0.0))
        if family == "scatter" and count in PATH_RATIOS:
            bound = PATH_RATIOS[count]
            targets.append(Target("path ratio", drive, figures.path_ratio, bound, "at most"))
    return Line(family, count, len(seen), sum(seen.values()), drives, tuple(targets))


_COLUMNS: tuple[tuple[str, Callable[[Figures], float | None], str], ...] = (
    ("found", lambda one: one.found, ".2f"),
    ("of all", lambda one: one.found_of_all, ".2f"),
    ("hits", lambda one: one.collisions, "d"),
    ("path", lambda one: one.path_ratio, ".2f"),
    ("time", lambda one: one.mean_time_ratio, ".2f"),
    ("median", lambda one: one.time_ratio, ".2f"),
    ("clear", lambda one: one.clearance, ".3f"),
)


def shown_table(lines: Sequence[Line], planner: str, seed: int) -> Table:
    """Return the table, which fits into 80 columns."""
    ratios = ", ".join(f"{bound:.2f} at {count}" for count, bound in PATH_RATIOS.items())
    rows = []
    for line in lines:
        what = line.family if line.count is None else f"{line.family} {line.count}"
        cells = [
            "\n".join(cell(figure(one), form) for one in line.drives.values())
            for _, figure, form in _COLUMNS
        ]
        feasible = f"{line.feasible} of {line.environments}"
        verdicts = ("MISSED" if line.missed_by(drive) else "met" for drive in line.drives)
        rows.append([what, feasible, "\n".join(line.drives), *cells, "\n".join(verdicts)])
    columns = ("obstacles", "feasible", "drive", *(name for name, _, _ in _COLUMNS), "targets")
    caption = (
        f"{planner}; seed {seed}; walled 10 × 10 m, start and goal near corners at random.\n"
        "feasible: there is a way for a disc of radius 0.22 m; found: share of those that "
        "reached the goal; hits: collisions in all; path: mean over the successes of driven "
        "over shortest path; time: mean over the successes, in times of the shortest path at "
        "full speed, and its median; clear: least distance to anything (m).\n"
        f"Targets: found 1.00, no hits, no errors; path at most {ratios} scattered obstacles."
    )
    return Table(caption, columns, rows, left=(0, 1, 2, len(columns) - 1))
