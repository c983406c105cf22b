"""What a sweep consists of: environments, planners, drives, and when an episode is given up."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Annotated, Any, TypeAlias

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

from fuzzyq_bullet.planning import PlannerSettings
from fuzzyq_bullet.scenario import Drive, Limits
from fuzzyq_bullet.studies.episodes import Environment, Job, Key, Row
from fuzzyq_bullet.version import __version__

M_S = 3000
"""Decisions after which a run is given up: M_s of Step 12. The paper gives no number; it must be
more than the 2342 steps that it reports as a mean."""
LIMITS = Limits(time=3600.0, steps=M_S)
"""M_s alone ends a run of the point robot, which decides once for each step."""
LIMITS_ON_WHEELS = Limits(time=3600.0, steps=6 * M_S)
"""On wheels one such step is about six decisions: 0.3 s."""
PATIENT = Limits(time=600.0, steps=100_000)
"""Long enough to go round everything twice, so that what is slow is no failure."""

Episode: TypeAlias = tuple[Environment, str, Drive]
"""Where, what rows call the planner, and what moves the robot."""
Number: TypeAlias = Annotated[int, Field(ge=0, le=1_000_000)]
Seed: TypeAlias = Annotated[int, Field(ge=0, le=2**63 - 1)]


def limits_with(drive: Drive) -> Limits:
    """Return when a run is given up after M_s, with a drive."""
    return LIMITS_ON_WHEELS if drive == "wheels" else LIMITS


def _planner(told: dict[str, Any]) -> dict[str, Any]:
    """Return the settings of a planner, whose name and weights are what they must be.

    Raises:
        ValueError: If they are not.
    """
    if not isinstance(told.get("name"), str):
        raise ValueError("a planner has a name")
    weights = told.get("weights", [1.0, 1.0])
    if not (
        isinstance(weights, list)
        and len(weights) == 2
        and all(isinstance(one, int | float) and 0.0 < one <= 20.0 for one in weights)
    ):
        raise ValueError("the weights of a planner are two numbers, more than 0 and at most 20")
    return told


PlannerDescription: TypeAlias = Annotated[dict[str, Any], AfterValidator(_planner)]
"""The settings of a planner as JSON can say them; a policy by the hash of its contents."""


class Plan(BaseModel):
    """What one sweep consists of: all that its rows depend on, as its ``settings.json`` says it.

    Attributes:
        sweep: Which study's it is, and which stage of it where there are several.
        version: Of the package that made it.
        limits: When an episode is given up.
    """

    model_config = ConfigDict(frozen=True)

    sweep: str
    version: str = __version__

    def schedule(self) -> Iterator[Episode]:
        """Yield all episodes; those of one environment are neighbours, which share its oracle."""
        raise NotImplementedError

    def jobs(self, planners: Mapping[str, PlannerSettings]) -> list[Job]:
        """Return all jobs, with the settings of each planner by what rows call it."""
        limits: Limits = getattr(self, "limits", PATIENT)
        return [
            Job(where, name, planners[name], drive, limits)
            for where, name, drive in self.schedule()
        ]

    @cached_property
    def keys(self) -> frozenset[Key]:
        """What tells its episodes apart."""
        return frozenset((name, drive, *where.place) for where, name, drive in self.schedule())

    @property
    def total(self) -> int:
        """Its episodes."""
        return len(self.keys)

    def holds(self, row: Row) -> bool:
        """Tell whether a row is one of the sweep's."""
        return row.key in self.keys

    def described(self) -> dict[str, Any]:
        """Return what it says of itself, as JSON can say it, without whose it is."""
        return self.model_dump(mode="json", exclude={"sweep", "version"})


class FieldsPlan(Plan):
    """Every planner in the same random environments, so many for each number of obstacles.

    Attributes:
        planners: The settings of each, by what rows call it (``options.described``).
        drive: What moves the robot.
        counts: Numbers of scattered obstacles, of radius 0.2 m.
        runs: Environments for every count.
        seed: Of the sweep.
        limits: When an episode is given up.
    """

    planners: dict[str, PlannerDescription] = Field(min_length=1)
    drive: Drive = "kinematic"
    counts: tuple[Number, ...] = Field(min_length=1)
    runs: Number
    seed: Seed = 0
    limits: Limits = LIMITS

    @model_validator(mode="after")
    def _fixed_have_weights(self) -> FieldsPlan:
        for name, told in self.planners.items():
            if name.startswith("fixed-") and "weights" not in told:
                raise ValueError(f"planners: {name} has no weights")
        return self

    def schedule(self) -> Iterator[Episode]:
        """Yield all episodes, those of one environment one after the other."""
        for count in self.counts:
            for run in range(self.runs):
                where = Environment.of("scatter", count, run, self.seed)
                for name in self.planners:
                    yield where, name, self.drive
