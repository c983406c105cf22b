"""What sweeps say of themselves in ``settings.json``, read back: which rows are theirs."""

from __future__ import annotations

from typing import Annotated, Any, Literal, TypeAlias

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

from fuzzyq_bullet.experiments.escape.plan import TRAPS
from fuzzyq_bullet.experiments.learning_gain.plan import LEARNED
from fuzzyq_bullet.experiments.sweep.rows import Row
from fuzzyq_bullet.scenario import Drive, Limits


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
        and all(isinstance(one, int | float) and 0.0 < one <= 2.0 for one in weights)
    ):
        raise ValueError("the weights of a planner are two numbers, more than 0 and at most 2")
    return told


Whole: TypeAlias = Annotated[int, Field(ge=0, le=2**63 - 1)]
Planner: TypeAlias = Annotated[dict[str, Any], AfterValidator(_planner)]


class _Settings(BaseModel):
    model_config = ConfigDict(frozen=True)

    version: str


class Planners(_Settings):
    """Those of ``fuzzyq bench success``, and of the table of ``fuzzyq bench steps``.

    Attributes:
        planners: The settings of each, by what rows call it; a policy by the hash of its contents.
    """

    sweep: Literal["success", "steps steps"]
    planners: dict[str, Planner] = Field(min_length=1)
    drive: Drive
    counts: list[Whole] = Field(min_length=1)
    runs: Whole
    seed: Whole
    limits: Limits

    @model_validator(mode="after")
    def _fixed_have_weights(self) -> Planners:
        for name, told in self.planners.items():
            if name.startswith("fixed-") and "weights" not in told:
                raise ValueError(f"planners: {name} has no weights")
        return self

    @property
    def table(self) -> str:
        """Name of the CSV."""
        return self.sweep.split()[0] + ".csv"

    @property
    def total(self) -> int:
        """Its episodes."""
        return len(self.planners) * len(self.counts) * self.runs

    def holds(self, row: Row) -> bool:
        """Tell whether a row is one of the sweep's."""
        return (
            row.planner in self.planners
            and row.drive == self.drive
            and row.count in self.counts
            and 0 <= row.run < self.runs
        )


class Search(_Settings):
    """Those of the search for the best fixed weights, in ``bench learning`` and ``bench steps``."""

    sweep: Literal["learning grid", "steps grid"]
    drive: Drive
    episodes: Whole
    candidates: list[str] = Field(min_length=1)

    @property
    def table(self) -> str:
        """Name of the CSV."""
        return "grid.csv"

    @property
    def total(self) -> int:
        """Its episodes."""
        return len(self.candidates) * self.episodes

    def holds(self, row: Row) -> bool:
        """Tell whether a row is one of the sweep's."""
        mine = row.planner in self.candidates and row.drive == self.drive
        return mine and 1 <= row.run <= self.episodes


class Comparison(_Settings):
    """Those of the comparison of ``fuzzyq bench learning``."""

    sweep: Literal["learning comparison"]
    drive: Drive
    seed: Whole
    environments: Whole
    counts: list[Whole] = Field(min_length=1)
    fixed: list[str]

    @property
    def table(self) -> str:
        """Name of the CSV."""
        return "comparison.csv"

    @property
    def total(self) -> int:
        """Its episodes."""
        return (len(self.fixed) + 1) * self.environments

    def holds(self, row: Row) -> bool:
        """Tell whether a row is one of the sweep's."""
        mine = row.planner in (*self.fixed, LEARNED) and row.drive == self.drive
        return mine and 0 <= row.run < self.environments


class Escape(_Settings):
    """Those of ``fuzzyq bench escape``."""

    sweep: Literal["escape"]
    planner: Planner
    drives: list[Drive] = Field(min_length=1)
    runs: Whole
    counts: list[Whole]
    traps: Whole
    rectangles: list[Whole]
    seed: Whole

    @property
    def table(self) -> str:
        """Name of the CSV."""
        return "escape.csv"

    @property
    def total(self) -> int:
        """Its episodes."""
        fields = self.runs * (len(self.counts) + len(self.rectangles))
        return len(self.drives) * (fields + self.traps)

    def holds(self, row: Row) -> bool:
        """Tell whether a row is one of the sweep's."""
        if row.planner != self.planner.get("name") or row.drive not in self.drives:
            return False
        if row.layout in TRAPS:
            return row.count is None and 0 <= row.run < self.traps
        counts = {"scatter": self.counts, "rectangles": self.rectangles}.get(row.layout, [])
        return row.count in counts and 0 <= row.run < self.runs


Settings: TypeAlias = Annotated[
    Planners | Search | Comparison | Escape, Field(discriminator="sweep")
]
"""Of any sweep that a report knows."""
