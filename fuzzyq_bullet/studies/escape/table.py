"""The table of ``fuzzyq bench escape``: what the episodes of a family came to."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from statistics import fmean, median

from fuzzyq_bullet.scenario import Robot, cellular_task
from fuzzyq_bullet.studies.episodes import Row
from fuzzyq_bullet.studies.study import Sense, Table, cell, meets

TRAPS = ("semicircle", "arc", "u-shape", "long-wall")
"""Taken in turn, each of a size and direction that its seed draws."""
PATH_RATIOS = {25: 1.10, 50: 1.25, 125: 1.6}
"""Most that the mean path may be, in shortest paths, by the number of scattered obstacles."""
TIME_RATIOS = {25: 1.09, 50: 1.16, 75: 1.38, 100: 1.6, 125: 2.2}
"""Most that the mean time on wheels may be, in times of the shortest path at full speed."""
SCORE = 0.47
"""Least mean score in cellular fields on wheels."""
FAMILIES = ("scatter", "traps", "rectangles", "cellular")
"""Kinds of environments, in the order of the table."""
CELLULAR_SPEED = cellular_task(0).robot.max_speed
"""Greatest speed of the robot in cellular fields (m/s)."""
CELLULAR_GOAL = cellular_task(0).goal.radius
"""Radius of their goal (m)."""


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
        score: Mean of ``score_of`` over those that have one; None outside of cellular fields.
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
    score: float | None

    @classmethod
    def of(cls, rows: Sequence[Row], speed: float | None = None) -> Figures:
        """Return the figures of at least one row.

        Args:
            rows: The rows.
            speed: Full speed (m/s), if it is not that of the environments' own robot.
        """
        feasible = [row for row in rows if row.feasible is not False]
        found = [row for row in rows if row.success]
        ways = [
            (
                row.path_length_m / row.shortest_path_m,
                row.time_s * (speed or full_speed(row)) / row.shortest_path_m,
            )
            for row in found
            if row.shortest_path_m and row.path_length_m is not None and row.time_s is not None
        ]
        scores = [one for row in rows if (one := score_of(row)) is not None]
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
            score=fmean(scores) if scores else None,
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
        family: One of ``FAMILIES``.
        count: Number of obstacles; None where there is none.
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


def full_speed(row: Row) -> float:
    """Return the greatest speed (m/s) of the robot of an environment."""
    return CELLULAR_SPEED if row.layout == "cellular" else Robot().max_speed


def score_of(row: Row) -> float | None:
    """Return the score of the literature for a run in a cellular field.

    Returns:
        0 to 0.5; None for other environments, and where there is no way.
    """
    return literature_score(row, CELLULAR_GOAL) if row.layout == "cellular" else None


def literature_score(row: Row, goal_radius: float) -> float | None:
    """Return the score in which the literature on cellular fields (BARN) counts a run.

    It is success · OT / clip(time, 2·OT, 8·OT), so 0.5 at most. OT is 0.6 s for each metre of the
    shortest path to the goal's centre: 2 m/s along a grid path, about a fifth longer.

    Args:
        row: What the run came to.
        goal_radius: Radius of the goal (m): the shortest path ends at its edge.

    Returns:
        0 to 0.5; None where there is no way.
    """
    if row.shortest_path_m is None:
        return None
    if not row.success or row.time_s is None:
        return 0.0
    optimal = 0.6 * (row.shortest_path_m + goal_radius)
    return optimal / min(max(row.time_s, 2.0 * optimal), 8.0 * optimal)


def by_family(rows: Iterable[Row]) -> dict[tuple[str, int | None], list[Row]]:
    """Return rows by family and count: scatter by count, traps, rectangles by count, cellular."""
    groups: dict[tuple[int, int], list[Row]] = {}
    for row in rows:
        family = "traps" if row.layout in TRAPS else row.layout
        place = FAMILIES.index(family), -1 if row.count is None else row.count
        groups.setdefault(place, []).append(row)
    return {
        (FAMILIES[place], None if count < 0 else count): group
        for (place, count), group in sorted(groups.items())
    }


def table_of(rows: Iterable[Row], speed: float | None = None) -> list[Line]:
    """Return the table of one planner's rows, in any order: a line for each family and count.

    Args:
        rows: The rows.
        speed: Full speed (m/s), if it is not that of the environments' own robot.
    """
    return [
        _line(family, count, group, speed) for (family, count), group in by_family(rows).items()
    ]


def _line(family: str, count: int | None, rows: Sequence[Row], speed: float | None) -> Line:
    group: dict[str, list[Row]] = {}
    for row in rows:
        group.setdefault(row.drive, []).append(row)
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
        if family == "scatter" and count in TIME_RATIOS and drive == "wheels":
            bound = TIME_RATIOS[count]
            targets.append(Target("time ratio", drive, figures.mean_time_ratio, bound, "at most"))
        if family == "cellular" and drive == "wheels":
            targets.append(Target("score", drive, figures.score, SCORE, "at least"))
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


def family_name(family: str, count: int | None) -> str:
    """Return what a table calls a family."""
    return family if count is None else f"{family} {count}"


def _listed(bounds: dict[int, float]) -> str:
    return ", ".join(f"{bound:g} at {count}" for count, bound in bounds.items())


def shown_table(lines: Sequence[Line], planner: str, seed: int, driven: str, room: float) -> Table:
    """Return the table, which fits into 80 columns.

    Args:
        lines: Its lines.
        planner: What it calls the planner.
        seed: Of the sweep.
        driven: Which robot drives, in words.
        room: Radius of the disc for which there must be a way (m).
    """
    rows = []
    for line in lines:
        cells = [
            "\n".join(cell(figure(one), form) for one in line.drives.values())
            for _, figure, form in _COLUMNS
        ]
        feasible = f"{line.feasible} of {line.environments}"
        verdicts = ("MISSED" if line.missed_by(drive) else "met" for drive in line.drives)
        rows.append(
            [
                family_name(line.family, line.count),
                feasible,
                "\n".join(line.drives),
                *cells,
                "\n".join(verdicts),
            ]
        )
    columns = ("obstacles", "feasible", "drive", *(name for name, _, _ in _COLUMNS), "targets")
    caption = (
        f"{planner}; seed {seed}; walled 10 × 10 m, start and goal near corners at random; "
        f"cellular: a corridor of 10 × 5 m with open sides; {driven}.\n"
        f"feasible: there is a way for a disc of radius {room:.3g} m; found: share of those that "
        "reached the goal; hits: collisions in all; path: mean over the successes of driven "
        "over shortest path; time: mean over the successes, in times of the shortest path at "
        "full speed, and its median; clear: least distance to anything (m).\n"
        f"Targets: found 1.00, no hits, no errors; among scattered obstacles path at most "
        f"{_listed(PATH_RATIOS)}, time on wheels at most {_listed(TIME_RATIOS)}; score in cellular "
        f"fields on wheels at least {SCORE:g}."
    )
    return Table(caption, columns, rows, left=(0, 1, 2, len(columns) - 1))
