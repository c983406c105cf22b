"""Whether a planner finds a way wherever there is one: ``fuzzyq bench escape``."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import Any, ClassVar

from pydantic import Field

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.planning import PlannerSettings
from fuzzyq_bullet.scenario import Drive, Limits
from fuzzyq_bullet.studies.escape.table import PATH_RATIOS, TRAPS, Figures, Line, table_of
from fuzzyq_bullet.studies.options import counts_of, drives_of, planner_of
from fuzzyq_bullet.studies.plan import PATIENT, Episode, Number, Plan, PlannerDescription, Seed
from fuzzyq_bullet.studies.registry import register_study
from fuzzyq_bullet.studies.runner.episodes import Environment
from fuzzyq_bullet.studies.study import Findings, Results, Stage, Study, Swept, Table, numbers

_COLUMNS: tuple[tuple[str, Callable[[Figures], float | None], str], ...] = (
    ("found", lambda one: one.found, ".2f"),
    ("of all", lambda one: one.found_of_all, ".2f"),
    ("hits", lambda one: one.collisions, "d"),
    ("path", lambda one: one.path_ratio, ".2f"),
    ("time", lambda one: one.time_ratio, ".2f"),
    ("clear", lambda one: one.clearance, ".3f"),
)


def _table(lines: Sequence[Line], planner: str, seed: int) -> Table:
    """Return the table, which fits into 80 columns."""
    ratios = ", ".join(f"{bound:.2f} at {count}" for count, bound in PATH_RATIOS.items())
    rows = []
    for line in lines:
        what = line.family if line.count is None else f"{line.family} {line.count}"
        cells = [
            "\n".join(_shown(figure(one), form) for one in line.drives.values())
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
        "over shortest path; time: median over the successes, in times of the shortest path "
        "at full speed; clear: least distance to anything (m).\n"
        f"Targets: found 1.00, no hits, no errors; path at most {ratios} scattered obstacles."
    )
    return Table(caption, columns, rows, left=(0, 1, 2, len(columns) - 1))


def _shown(value: float | None, form: str) -> str:
    return "–" if value is None else format(value, form)


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
        limits: When an episode is given up.
    """

    planner: PlannerDescription
    drives: tuple[Drive, ...] = Field(("wheels", "kinematic"), min_length=1)
    runs: Number = 50
    counts: tuple[Number, ...] = (5, 25, 50, 75, 100, 125)
    traps: Number = 100
    rectangles: tuple[Number, ...] = (30, 40, 60)
    seed: Seed = 0
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
            for drive in self.drives:
                yield where, self.planner["name"], drive


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

    def planner_set(self) -> dict[str, PlannerSettings]:
        """Return the one that is asked."""
        return {self.planner: planner_of(self.planner, self.weights)}

    def plan(self) -> EscapePlan:
        """Return what is run.

        Raises:
            UserError: If an option is wrong, or nothing is asked for.
        """
        (settings,) = self.planner_set().values()
        plan = EscapePlan(
            sweep=self.name,
            planner=settings.model_dump(mode="json"),
            drives=drives_of(self.drive),
            runs=self.runs,
            counts=counts_of(self.counts, "--counts"),
            traps=self.traps,
            rectangles=counts_of(self.rectangles, "--rectangles"),
            seed=self.seed,
        )
        if not any(True for _ in plan.environments()):
            raise UserError("nothing to run: --counts, --traps and --rectangles all ask for none")
        return plan

    def stages(self) -> Generator[Stage, Swept, None]:
        """Yield its one sweep, which keeps the records of failures."""
        yield Stage(self.name, self.plan(), self.planner_set(), keep_records=True)

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
        lines = table_of(swept.rows)
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
        table = _table(lines, named, self.seed)
        return Findings((table,), {**told, "rows": rows}, missed=tuple(missed))
