"""The paper's planners beside those of the field, in the same fields: ``fuzzyq bench field``."""

from __future__ import annotations

from collections.abc import Generator, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any, ClassVar

from pydantic import Field

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.planning import PlannerSettings, settings_for
from fuzzyq_bullet.planning.registry import DEFAULT_PLANNER
from fuzzyq_bullet.studies.episodes import Row
from fuzzyq_bullet.studies.escape.table import literature_score, score_of
from fuzzyq_bullet.studies.field.paired import better_table, paired, paired_table
from fuzzyq_bullet.studies.field.plan import BOUND, KINDS, WORLDS, FieldPlan, WorldsPlan
from fuzzyq_bullet.studies.field.table import by_kind, summaries_of, summary_table, worlds_table
from fuzzyq_bullet.studies.field.worlds import WorldFolder, WorldOptions, worlds_in
from fuzzyq_bullet.studies.options import PAPER, described, outfit_with, planners_of
from fuzzyq_bullet.studies.plan import Plan
from fuzzyq_bullet.studies.registry import register_study
from fuzzyq_bullet.studies.study import Findings, Picture, Results, Stage, Study, Swept, Work
from fuzzyq_bullet.wording import not_one_of

PEERS = ("dwa", "vfh", "apf", "tangent-bug")
"""Planners of the field that come with the package and need nothing else."""
FEW_WORLDS = 40
"""Up to so many worlds are printed one by one; more are only in the report."""


@register_study
class AgainstField(Study):
    """Drive the paper's planners and those of the field through the same fields, on wheels.

    Fields are of six kinds: scatter, cellular, rectangles, traps, moving, noise. With --worlds they
    are the scenario files and maps of a folder instead, with the score of the literature. May be
    ended at any moment: the same command goes on where it was. Writes field.csv (or worlds.csv), a
    row for every episode, field.json and field.png. Exit code 1 when an episode failed itself, 2
    when a world could not be read: the others are driven through all the same.
    """

    name: ClassVar[str] = "field"
    title: ClassVar[str] = "Against the field"
    stage_plans: ClassVar[Mapping[str, type[Plan]]] = {"field": FieldPlan, WORLDS: WorldsPlan}
    width: ClassVar[int] = 150
    pictured: ClassVar[bool] = True

    planners: str = Field(",".join((*PAPER, *PEERS)), description="Planners, with commas between.")
    kinds: str = Field(",".join(KINDS), description="Kinds of fields, with commas between.")
    runs: int = Field(20, ge=1, le=100_000, description="Fields of each kind.")
    worlds: Path | None = Field(
        None,
        description="Folder of scenario files, or maps that fuzzyq import reads, instead.",
        json_schema_extra={"metavar": "DIR"},
    )
    repeat: int = Field(1, ge=1, le=10_000, description="Runs of each world, with other seeds.")
    start: str | None = Field(
        None, description="X,Y[,HEADING]: start in every world, instead of its own."
    )
    goal: str | None = Field(
        None, description="X,Y[,RADIUS]: goal in every world, instead of its own."
    )
    robot: str | None = Field(None, description="Robot that drives; by default the usual one.")
    max_speed: float | None = Field(
        None, description="Its greatest speed (m/s); by default that of its model."
    )
    range: float | None = Field(None, description="How far it sees (m); by default 5·S_p.")
    drive: str = Field("wheels", description="wheels: the point robot has no time to compare.")

    def planner_set(self) -> dict[str, PlannerSettings]:
        """Return the planners, and the bound, whose settings are not used."""
        usual = settings_for(DEFAULT_PLANNER).model_validate({"name": DEFAULT_PLANNER})
        return {**planners_of(self.planners), BOUND: usual}

    def stages(self) -> Generator[Stage, Swept, None]:
        """Yield the one sweep: of kinds of fields, or of the worlds of a folder."""
        if self.drive != "wheels":
            raise UserError(f"--drive: {not_one_of('drive', self.drive, ['wheels'])}")
        planners = self.planner_set()
        told = described({name: one for name, one in planners.items() if name != BOUND})
        if self.worlds is None:
            yield Stage("field", self._fields(told), planners)
            return
        found = worlds_in(self._asked(self.worlds))
        notes = [
            f"left out in {count} world{'' if count == 1 else 's'}: {what}"
            for what, count in found.left_out.items()
        ]
        yield Stage(WORLDS, self._worlds(told, found), planners, tuple(notes))

    def _fields(self, planners: Mapping[str, Any]) -> FieldPlan:
        kinds = tuple(dict.fromkeys(one.strip() for one in self.kinds.split(",")))
        for name in kinds:
            if name not in KINDS:
                raise UserError(f"--kinds: {not_one_of('kind', name, tuple(KINDS))}")
        for option in ("start", "goal"):
            if getattr(self, option) is not None:
                raise UserError(f"--{option}: is for the worlds of --worlds; fields have their own")
        return FieldPlan(
            sweep=self.name,
            planners=dict(planners),
            kinds=kinds,
            runs=self.runs,
            seed=self.seed,
            outfit=outfit_with(self.robot, self.max_speed, self.range),
        )

    def _asked(self, folder: Path) -> WorldOptions:
        return WorldOptions(folder, self.start, self.goal, self.robot, self.max_speed, self.range)

    def _worlds(self, planners: Mapping[str, Any], found: WorldFolder) -> WorldsPlan:
        options = ("worlds", "start", "goal", "robot", "max_speed", "range")
        asked = {name: getattr(self, name) for name in options}
        return WorldsPlan(
            sweep=f"{self.name} {WORLDS}",
            planners=dict(planners),
            worlds=found.worlds,
            repeat=self.repeat,
            asked={name: str(one) if name == "worlds" else one for name, one in asked.items()},
            unread=tuple(found.problems),
            contents=found.contents,
        )

    @classmethod
    def recalled(cls, plans: Mapping[str, Any]) -> AgainstField:
        """Return the study whose plan this is."""
        (plan,) = plans.values()
        planners = ",".join(plan.planners)
        if isinstance(plan, WorldsPlan):
            return cls.model_validate({"planners": planners, "repeat": plan.repeat, **plan.asked})
        told = {"planners": planners, "kinds": ",".join(plan.kinds), "runs": plan.runs}
        outfit = plan.outfit.model_dump(include={"robot", "max_speed", "range"})
        return cls.model_validate({**told, "seed": plan.seed, **outfit})

    @classmethod
    def usable(cls, results: Results) -> Results | None:
        """Return the results if there is a field that every planner has driven through."""
        (swept,) = results.values()
        return results if by_kind(swept.rows, swept.plan.labels()) else None

    def work(self) -> Work:
        """Return the function that does a job in a worker."""
        from fuzzyq_bullet.studies.field.drive import work

        return work

    def findings(self, results: Results) -> Findings:
        """Return what others do better, the main table, and the paired comparisons."""
        from fuzzyq_bullet.studies.field.picture import field_picture

        (swept,) = results.values()
        plan: FieldPlan | WorldsPlan = swept.plan
        kinds = by_kind(swept.rows, plan.labels())
        than = DEFAULT_PLANNER if DEFAULT_PLANNER in plan.planners else next(iter(plan.planners))
        score = score_of if isinstance(plan, FieldPlan) else _score_in(plan)
        lines, pairs = summaries_of(kinds, score), paired(kinds, than)
        about = f"wheels; seed {plan.seed}" if isinstance(plan, FieldPlan) else "wheels"
        better = better_table(pairs, than)
        tables = [*([better] if better else []), summary_table(lines, about)]
        if pairs:
            tables.append(paired_table(pairs, than))
        each = (worlds_table(kinds[WORLDS], score),) if WORLDS in kinds else ()
        few = len(getattr(plan, "worlds", ())) <= FEW_WORLDS
        data = {
            "settings": dict(swept.settings),
            "lines": [asdict(line) for line in lines],
            "paired": [{**asdict(one), "better": one.better()} for one in pairs],
            "worlds": [
                dict(zip(one.columns, cells, strict=True)) for one in each for cells in one.rows
            ],
        }
        return Findings(
            (*tables, *(each if few else ())),
            data,
            problems=getattr(plan, "unread", ()),
            pictures=(
                Picture(
                    lambda: field_picture(lines, about),
                    "Success, and time over the bound, of each planner in each kind of fields.",
                ),
            ),
            details=() if few else each,
        )


def _score_in(plan: WorldsPlan) -> Any:
    def score(row: Row) -> float | None:
        return literature_score(row, plan.worlds[row.layout].goal_radius)

    return score
