"""Whether a planner finds a way wherever there is one: ``fuzzyq bench escape``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, replace
from typing import Any, ClassVar

from pydantic import Field

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.planning import PlannerSettings
from fuzzyq_bullet.planning.settings import RecoverySettings
from fuzzyq_bullet.scenario import Drive, Limits, cellular_task
from fuzzyq_bullet.sensors import SENSOR_MARGIN
from fuzzyq_bullet.studies.episodes import USUAL, Environment, Job, Outfit
from fuzzyq_bullet.studies.escape.comparison import BESIDE, compare, shown_comparison
from fuzzyq_bullet.studies.escape.table import TRAPS, shown_table, table_of
from fuzzyq_bullet.studies.options import (
    RULES_HELP,
    counts_of,
    drives_of,
    outfit_with,
    planner_of,
    rules_told,
    with_rules,
)
from fuzzyq_bullet.studies.plan import PATIENT, Episode, Number, Plan, PlannerDescription, Seed
from fuzzyq_bullet.studies.registry import register_study
from fuzzyq_bullet.studies.study import (
    Findings,
    Results,
    Study,
    Work,
    numbers,
)

BRIEF = Limits(time=120.0, steps=100_000)
"""Without a memory the robot goes in circles where it does not find its way soon."""


class EscapePlan(Plan):
    """Scatter fields, rectangles, traps and cellular fields, each with every drive.

    Attributes:
        planner: The settings of the planner that is asked.
        drives: Every environment is run with each.
        runs: Environments for every count.
        counts: Numbers of scattered obstacles, of radius 0.2 m.
        traps: How many traps.
        rectangles: Numbers of rectangles.
        cellular: How many cellular fields.
        seed: Of the sweep.
        beside: What else runs in the same environments, with the first drive alone: ``BESIDE``.
        limits: When an episode is given up.
        outfit: What drives instead of the environments' own robot.
    """

    planner: PlannerDescription
    drives: tuple[Drive, ...] = Field(("wheels", "kinematic"), min_length=1)
    runs: Number = 50
    counts: tuple[Number, ...] = (5, 25, 50, 75, 100, 125)
    traps: Number = 100
    rectangles: tuple[Number, ...] = (30, 40, 60)
    cellular: Number = 0
    seed: Seed = 0
    beside: tuple[str, ...] = ()
    limits: Limits = PATIENT
    outfit: Outfit = USUAL

    def environments(self) -> Iterator[Environment]:
        """Yield all environments."""
        for layout, counts in (("scatter", self.counts), ("rectangles", self.rectangles)):
            for count in counts:
                for run in range(self.runs):
                    yield Environment.of(layout, count, run, self.seed)
        for run in range(self.traps):
            yield Environment.of(TRAPS[run % len(TRAPS)], None, run, self.seed)
        for run in range(self.cellular):
            yield Environment.of("cellular", None, run, self.seed)

    def schedule(self) -> Iterator[Episode]:
        """Yield all episodes, those of one environment one after the other."""
        for where in self.environments():
            for drive in self.drives:
                yield where, self.planner["name"], drive
            for name in self.beside:
                yield where, name, self.drives[0]

    def jobs(self, planners: Mapping[str, PlannerSettings]) -> list[Job]:
        """Return all jobs; what goes in circles is given up sooner."""
        return [
            replace(
                one,
                limits=BRIEF if one.planner == "no-memory" else one.limits,
                outfit=self.outfit,
            )
            for one in super().jobs(planners)
        ]


@register_study
class Escape(Study):
    """Run a planner in random fields, traps and rectangles; print how often it finds its way.

    With --beside also without its controller, without its memory, told where exits lead, and the
    true shortest path driven: what each is worth, and how much there is to gain.

    May be ended at any moment: the same command goes on where it was. Writes escape.csv, a row for
    every episode, escape.json, and in records/ the runs that failed although there was a way, for
    fuzzyq replay. Exit code 1 when a target is missed.
    """

    name: ClassVar[str] = "escape"
    title: ClassVar[str] = "Out of dead ends"
    stage_plans: ClassVar[Mapping[str, type[Plan]]] = {"escape": EscapePlan}
    width: ClassVar[int] = 100
    kept: ClassVar[bool] = True

    runs: int = Field(50, ge=1, le=100_000, description="Environments for every count.")
    counts: str = Field(
        "5,25,50,75,100,125", description="Numbers of scattered obstacles, or none."
    )
    traps: int = Field(
        100, ge=0, le=100_000, description="Semicircles, arcs, U-shapes and walls, in turn."
    )
    rectangles: str = Field("30,40,60", description="Numbers of rectangles, or none.")
    cellular: int = Field(
        0, ge=0, le=100_000, description="Corridors of clumped pillars, with their score."
    )
    drive: str = Field("both", description="wheels (physics), kinematic, or both.")
    planner: str = Field("improved-fuzzy", description="Planner to ask.")
    weights: str | None = Field(None, description="Its weights ω1,ω2; 1,1 where it takes any.")
    rules: str | None = Field(None, description=RULES_HELP)
    robot: str | None = Field(None, description="Robot that drives; by default the usual one.")
    max_speed: float | None = Field(
        None, description="Its greatest speed (m/s); by default that of its model."
    )
    range: float | None = Field(None, description="How far it sees (m); by default 5·S_p.")
    beside: bool = Field(
        False, description="Run it without parts of it, and what knows the truth, as well."
    )

    def planner_set(self) -> dict[str, PlannerSettings]:
        """Return the one that is asked, and its variants."""
        settings = with_rules(planner_of(self.planner, self.weights), self.rules)
        return {self.planner: settings, **(variants_of(settings) if self.beside else {})}

    def outfit(self) -> Outfit:
        """Return what drives.

        Raises:
            UserError: If there is no such robot, or it cannot be so fast or see so far.
        """
        return outfit_with(self.robot, self.max_speed, self.range)

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
            cellular=self.cellular,
            seed=self.seed,
            beside=tuple(BESIDE) if beside else (),
            outfit=self.outfit(),
        )
        if not any(True for _ in plan.environments()):
            raise UserError(
                "nothing to run: --counts, --traps, --rectangles and --cellular all ask for none"
            )
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
            cellular=plan.cellular,
            drive=plan.drives[0] if len(plan.drives) == 1 else "both",
            planner=plan.planner["name"],
            weights=None if not weights else ",".join(f"{one:g}" for one in weights),
            rules=rules_told(plan.planner),
            seed=plan.seed,
            **plan.outfit.model_dump(exclude={"disturbed", "movers"}),
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
        outfit: Outfit = swept.plan.outfit
        robot = outfit.on(cellular_task(0)).robot
        speed = None if outfit.robot is None and outfit.max_speed is None else robot.max_speed
        lines = table_of((row for row in swept.rows if row.planner == self.planner), speed)
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
        drive = swept.plan.drives[0]
        driven = [row for row in swept.rows if row.drive == drive]
        compared = compare(driven, (self.planner, *swept.plan.beside), speed)
        shown = shown_table(lines, named, self.seed, _told(outfit), robot.radius + SENSOR_MARGIN)
        tables = (shown, shown_comparison(compared, drive))
        told = {**told, "rows": rows, "compared": [asdict(one) for one in compared]}
        return Findings(tables, told, missed=tuple(missed))

    def work(self) -> Work:
        """Return what does a job: a bound is driven by what knows the truth."""
        from fuzzyq_bullet.studies.escape.bounds import work

        return work


def _told(outfit: Outfit) -> str:
    """Return which robot drives, in words."""
    if outfit == USUAL:
        return "there at 1 m/s"
    parts = [
        f"robot {outfit.robot}" if outfit.robot else "",
        f"at most {outfit.max_speed:g} m/s" if outfit.max_speed else "",
        f"sees {outfit.range:g} m" if outfit.range else "",
    ]
    return ", ".join(filter(None, parts))


def variants_of(settings: PlannerSettings) -> dict[str, PlannerSettings]:
    """Return what runs beside a planner, by what rows call it; the bounds have its settings.

    Raises:
        UserError: If it has neither.
    """
    if not isinstance(settings, RecoverySettings):
        raise UserError(f"--beside: {settings.name} has no controller and no memory to leave out")
    return {
        "no-controller": settings.model_copy(update={"rules": "none"}),
        "no-memory": settings.model_copy(update={"following": False}),
        "true-exits": settings,
        "true-path": settings,
    }
