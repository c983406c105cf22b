"""Whether a planner finds a way wherever there is one: ``fuzzyq bench escape``."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from statistics import fmean, median
from typing import Any, ClassVar

from pydantic import Field

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.planning import PlannerSettings
from fuzzyq_bullet.planning.settings import RecoverySettings
from fuzzyq_bullet.scenario import Drive, Limits, Robot
from fuzzyq_bullet.studies.episodes import Environment, Row
from fuzzyq_bullet.studies.options import counts_of, drives_of, planner_of
from fuzzyq_bullet.studies.plan import PATIENT, Episode, Number, Plan, PlannerDescription, Seed
from fuzzyq_bullet.studies.registry import register_study
from fuzzyq_bullet.studies.study import (
    Findings,
    Results,
    Sense,
    Study,
    Table,
    cell,
    meets,
    numbers,
)

TRAPS = ("semicircle", "arc", "u-shape", "long-wall")
"""Taken in turn, each of a size and direction that its seed draws."""
PATH_RATIOS = {25: 1.10, 50: 1.25, 125: 2.0}
"""Most that the mean path may be, in shortest paths, by the number of scattered obstacles."""


VARIANTS = {
    "no-controller": "no controller: straight to the aim at full speed",
    "no-memory": "no memory: breakouts that are not sustained",
}
"""What rows call the variants of a planner, and what they are."""


class EscapePlan(Plan):
    """Scatter fields, rectangles and traps, each with every drive.

    Attributes:
        planner: The settings of the planner that is asked.
        drives: Every environment is run with each.
        runs: Environments for every count.
        counts: Numbers of scattered obstacles, of radius 0.2 m.
        traps: How many traps.
        rectangles: Numbers of rectangles.
        seed: Of the sweep.
        beside: Variants of the planner that run in the same environments.
        limits: When an episode is given up.
    """

    planner: PlannerDescription
    drives: tuple[Drive, ...] = Field(("wheels", "kinematic"), min_length=1)
    runs: Number = 50
    counts: tuple[Number, ...] = (5, 25, 50, 75, 100, 125)
    traps: Number = 100
    rectangles: tuple[Number, ...] = (30, 40, 60)
    seed: Seed = 0
    beside: tuple[str, ...] = ()
    limits: Limits = PATIENT

    def environments(self) -> Iterator[Environment]:
        """Yield all environments."""
        for layout, counts in (("scatter", self.counts), ("rectangles", self.rectangles)):
            for count in counts:
                for run in range(self.runs):
                    yield Environment.of(layout, count, run, self.seed)
        for run in range(self.traps):
            yield Environment.of(TRAPS[run % len(TRAPS)], None, run, self.seed)

    def schedule(self) -> Iterator[Episode]:
        """Yield all episodes, those of one environment one after the other."""
        for where in self.environments():
            for name in (self.planner["name"], *self.beside):
                for drive in self.drives:
                    yield where, name, drive


@register_study
class Escape(Study):
    """Run a planner in random fields, traps and rectangles; print how often it finds its way.

    May be ended at any moment: the same command goes on where it was. Writes escape.csv, a row for
    every episode, escape.json, and in records/ the runs that failed although there was a way, for
    fuzzyq replay. Exit code 1 when a target is missed.
    """

    name: ClassVar[str] = "escape"
    title: ClassVar[str] = "Out of dead ends"
    kinds: ClassVar[Mapping[str, type[Plan]]] = {"escape": EscapePlan}
    width: ClassVar[int] = 80
    kept: ClassVar[bool] = True

    runs: int = Field(50, ge=1, le=100_000, description="Environments for every count.")
    counts: str = Field(
        "5,25,50,75,100,125", description="Numbers of scattered obstacles, or none."
    )
    traps: int = Field(
        100, ge=0, le=100_000, description="Semicircles, arcs, U-shapes and walls, in turn."
    )
    rectangles: str = Field("30,40,60", description="Numbers of rectangles, or none.")
    drive: str = Field("both", description="wheels (physics), kinematic, or both.")
    planner: str = Field("improved-fuzzy", description="Planner to ask.")
    weights: str | None = Field(None, description="Its weights ω1,ω2; 1,1 where it takes any.")
    beside: bool = Field(
        False, description="Run it without its controller, and without its memory, as well."
    )

    def planner_set(self) -> dict[str, PlannerSettings]:
        """Return the one that is asked, and its variants."""
        settings = planner_of(self.planner, self.weights)
        return {self.planner: settings, **(variants_of(settings) if self.beside else {})}

    def plan(self) -> EscapePlan:
        """Return what is run; asking for nothing is a mistake too."""
        settings, *beside = self.planner_set().values()
        plan = EscapePlan(
            sweep=self.name,
            planner=settings.model_dump(mode="json"),
            drives=drives_of(self.drive),
            runs=self.runs,
            counts=counts_of(self.counts, "--counts"),
            traps=self.traps,
            rectangles=counts_of(self.rectangles, "--rectangles"),
            seed=self.seed,
            beside=tuple(VARIANTS) if beside else (),
        )
        if not any(True for _ in plan.environments()):
            raise UserError("nothing to run: --counts, --traps and --rectangles all ask for none")
        return plan

    @classmethod
    def recalled(cls, plans: Mapping[str, Any]) -> Escape:
        """Return the study whose plan this is."""
        plan: EscapePlan = plans["escape"]
        weights = plan.planner.get("weights")
        return cls(
            runs=plan.runs,
            counts=numbers(plan.counts),
            traps=plan.traps,
            rectangles=numbers(plan.rectangles),
            drive=plan.drives[0] if len(plan.drives) == 1 else "both",
            planner=plan.planner["name"],
            weights=None if not weights else ",".join(f"{one:g}" for one in weights),
            seed=plan.seed,
            beside=bool(plan.beside),
        )

    def heading(self) -> str:
        """Return what a report calls it."""
        return f"{self.title}, {self.planner}"

    @classmethod
    def usable(cls, results: Results) -> Results | None:
        """Return all there is: every row counts by itself."""
        return results if results["escape"].rows else None

    def findings(self, results: Results) -> Findings:
        """Return the table of families, with the targets that are missed."""
        swept = results["escape"]
        lines = table_of(row for row in swept.rows if row.planner == self.planner)
        given = swept.plan.planner.get("weights")
        named = self.planner
        if given is not None:
            named = f"{self.planner} with weights ({given[0]:g}, {given[1]:g})"
        rows = [
            {**asdict(line), "targets": [{**asdict(one), "met": one.met} for one in line.targets]}
            for line in lines
        ]
        told = {"settings": dict(swept.settings), "episodes_per_s": round(swept.rate, 3)}
        missed = [
            f"{line.family}{'' if line.count is None else f' {line.count}'}, {target.drive}: "
            f"{target.what} {target.figure:.4g} instead of {target.sense} {target.bound:g}"
            for line in lines
            for target in line.targets
            if not target.met
        ]
        tables, beside = [_table(lines, named, self.seed)], {}
        for name in swept.plan.beside:
            variant = table_of(row for row in swept.rows if row.planner == name)
            tables.append(_table(variant, f"{named}, {VARIANTS[name]}", self.seed))
            beside[name] = [asdict(line) for line in variant]
        told = {**told, "rows": rows, **({"beside": beside} if beside else {})}
        return Findings(tuple(tables), told, missed=tuple(missed))


def variants_of(settings: PlannerSettings) -> dict[str, PlannerSettings]:
    """Return the planner without its controller, and without its memory, by what rows call them.

    Raises:
        UserError: If it has neither.
    """
    if not isinstance(settings, RecoverySettings):
        raise UserError(f"--beside: {settings.name} has no controller and no memory to leave out")
    return {
        "no-controller": settings.model_copy(update={"rules": "none"}),
        "no-memory": settings.model_copy(update={"following": False}),
    }


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


def _table(lines: Sequence[Line], planner: str, seed: int) -> Table:
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
