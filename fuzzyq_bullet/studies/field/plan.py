"""What ``bench field`` runs: every planner, and the bound, in the same fields of each kind."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from pydantic import BaseModel, ConfigDict, Field

from fuzzyq_bullet.planning import PlannerSettings
from fuzzyq_bullet.scenario import Limits, Scenario
from fuzzyq_bullet.studies.episodes import USUAL, Environment, Job, Outfit
from fuzzyq_bullet.studies.escape.table import TRAPS
from fuzzyq_bullet.studies.plan import Episode, Number, Plan, PlannerDescription, Seed
from fuzzyq_bullet.studies.robust.study import strengths
from fuzzyq_bullet.studies.robust.table import ALL

Label: TypeAlias = tuple[str, str, str]
"""What rows call a planner, its name, and the kind of fields."""
BOUND = "true-path"
"""What rows call the bound: it knows the field, and drives its shortest path."""
WORLDS = "worlds"
"""The kind of worlds that were read from files."""
FIELD_LIMITS = Limits(time=240.0, steps=100_000)
"""Ten times what the bound takes: a planner that has not arrived by then goes in circles."""
_USUAL_LEVEL = 2
"""Strength of the disturbances, on the scales of ``bench robust``."""


@dataclass(frozen=True)
class Kind:
    """A kind of fields.

    Attributes:
        layouts: Its layouts; fields take them in turn.
        count: Number of obstacles; None for layouts that have no count.
        changes: Keys of ``Outfit`` that differ from the default.
    """

    layouts: tuple[str, ...]
    count: int | None
    changes: Mapping[str, Any] = field(default_factory=dict)


KINDS: Mapping[str, Kind] = {
    "scatter": Kind(("scatter",), 50),
    "cellular": Kind(("cellular",), None),
    "rectangles": Kind(("rectangles",), 40),
    "traps": Kind(TRAPS, None),
    "moving": Kind(("scatter",), 25, {"movers": {"count": 10}}),
    "noise": Kind(("scatter",), 50, {"disturbed": strengths(ALL, _USUAL_LEVEL)}),
}
"""Kinds of fields, in the order of the table."""


class FieldPlan(Plan):
    """Every planner in the same fields of each kind, on wheels.

    Attributes:
        planners: The settings of each, by its name.
        kinds: Names of ``KINDS``.
        runs: Fields of each kind.
        seed: Seed of the sweep.
        limits: When an episode is given up.
        outfit: Changes to the robot and sensor of the fields.
    """

    planners: dict[str, PlannerDescription] = Field(min_length=1)
    kinds: tuple[str, ...] = Field(min_length=1)
    runs: Number
    seed: Seed = 0
    limits: Limits = FIELD_LIMITS
    outfit: Outfit = USUAL

    def labels(self) -> Iterator[Label]:
        """Yield what rows call each planner in each kind of fields, the bound last."""
        for kind in self.kinds:
            for planner in (*self.planners, BOUND):
                yield f"{planner}.{kind}", planner, kind

    def schedule(self) -> Iterator[Episode]:
        """Yield all episodes, those of one field one after the other."""
        labels = list(self.labels())
        for name in self.kinds:
            kind = KINDS[name]
            for run in range(self.runs):
                layout = kind.layouts[run % len(kind.layouts)]
                where = Environment.of(layout, kind.count, run, self.seed)
                for label, _, of in labels:
                    if of == name:
                        yield where, label, "wheels"

    def jobs(self, planners: Mapping[str, PlannerSettings]) -> list[Job]:
        """Return all jobs, each with what its kind of fields changes."""
        told = {
            label: (
                planners[planner],
                Outfit.model_validate({**self.outfit.model_dump(), **KINDS[kind].changes}),
            )
            for label, planner, kind in self.labels()
        }
        return [
            Job(where, label, told[label][0], drive, self.limits, told[label][1])
            for where, label, drive in self.schedule()
        ]


class World(BaseModel):
    """What a plan records of a world.

    Attributes:
        sha256: Digest of the whole scenario: with another start it is another world.
        seed: Of its first run.
        goal_radius: Radius of its goal (m).
    """

    model_config = ConfigDict(frozen=True)

    sha256: str
    seed: int = Field(ge=0)
    goal_radius: float = Field(gt=0.0)


class WorldsPlan(Plan):
    """Every planner in the same worlds of a folder, on wheels.

    Attributes:
        planners: The settings of each, by its name.
        worlds: The worlds by name.
        repeat: Runs of each, with seeds that count up.
        asked: What was asked for, by option: the folder, start, goal, robot.
        unread: A line for every file of the folder that could not be read.
        contents: The worlds themselves as JSON, by name. They are not written with the plan, so a
            plan that is read back has none.
    """

    planners: dict[str, PlannerDescription] = Field(min_length=1)
    worlds: dict[str, World] = Field(min_length=1)
    repeat: int = Field(1, ge=1)
    asked: dict[str, str | float | None] = Field(default_factory=dict)
    unread: tuple[str, ...] = ()
    contents: dict[str, str] = Field(default_factory=dict, exclude=True, repr=False)

    def labels(self) -> Iterator[Label]:
        """Yield what rows call each planner: its name; the bound last."""
        for planner in (*self.planners, BOUND):
            yield planner, planner, WORLDS

    def schedule(self) -> Iterator[Episode]:
        """Yield all episodes, those of one world one after the other."""
        for name, world in self.worlds.items():
            for run in range(self.repeat):
                where = Environment(name, None, run, world.seed + run)
                for label, *_ in self.labels():
                    yield where, label, "wheels"

    def jobs(self, planners: Mapping[str, PlannerSettings]) -> list[Job]:
        """Return all jobs, each with its world; a worker need not have the file."""
        limits = {
            name: Scenario.model_validate_json(text).limits for name, text in self.contents.items()
        }
        return [
            Job(
                where,
                label,
                planners[label],
                drive,
                limits[where.layout],
                world=self.contents[where.layout],
            )
            for where, label, drive in self.schedule()
        ]
