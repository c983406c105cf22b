"""One episode of a sweep, as asked for: an environment out of a seed, a planner, a drive."""

from __future__ import annotations

import re
from dataclasses import asdict, dataclass
from typing import Any, TypeAlias

from fuzzyq_bullet.planning import PlannerSettings, settings_for
from fuzzyq_bullet.scenario import Drive, Limits, Scenario, random_task

Key: TypeAlias = tuple[str, str, str, int, int]
"""Planner, drive, layout, count (−1 without one), run: unique in a sweep, and its order."""

MOST_RUNS = 1_000_000
"""Environments that one seed of a sweep has room for, before it meets those of the next."""
MOST_SEED = (2**63 - 1) // MOST_RUNS - 1
"""Greatest seed of a sweep."""
_LABEL = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")


@dataclass(frozen=True)
class Environment:
    """A walled 10 × 10 m arena with a start, a goal and obstacles, all out of one seed.

    Attributes:
        layout: Name of the layout that draws the obstacles.
        count: How many; None for layouts that have no count.
        run: Its number in the sweep, from 0.
        seed: Seed of the scenario.
    """

    layout: str
    count: int | None
    run: int
    seed: int

    @classmethod
    def of(cls, layout: str, count: int | None, run: int, sweep_seed: int) -> Environment:
        """Return environment number ``run`` of a sweep.

        The seed is plain arithmetic, so that anybody can build the same by hand. It does not depend
        on the layout or the count: different counts have the same starts and goals, and a scatter
        field begins with the obstacles of the smaller ones.
        """
        return cls(layout, count, run, sweep_seed * MOST_RUNS + run)


@dataclass(frozen=True)
class Job:
    """One episode.

    Attributes:
        environment: Where it takes place; the same for every planner and drive.
        planner: What rows call the planner: its name, or a name for these settings of it. Letters,
            digits, dot, dash, underscore.
        settings: The planner's settings.
        drive: ``wheels`` or ``kinematic``.
        limits: When it is given up.
    """

    environment: Environment
    planner: str
    settings: PlannerSettings
    drive: Drive
    limits: Limits

    def __post_init__(self) -> None:
        if not _LABEL.fullmatch(self.planner):
            raise ValueError(f"planner: {self.planner!r} cannot be part of a file's name")

    @property
    def key(self) -> Key:
        """What tells it from the other jobs of its sweep, and sorts them."""
        where = self.environment
        count = -1 if where.count is None else where.count
        return self.planner, self.drive, where.layout, count, where.run

    @property
    def name(self) -> str:
        """The same as part of a file's name."""
        planner, drive, layout, count, run = self.key
        return "-".join([planner, drive, layout, *([] if count < 0 else [str(count)]), str(run)])

    def scenario(self) -> Scenario:
        """Return what is to be run, with its obstacles still to be drawn."""
        where = self.environment
        task = random_task(where.seed, layout=where.layout, count=where.count)
        return task.model_copy(
            update={"planner": self.settings, "drive": self.drive, "limits": self.limits}
        )

    def as_order(self) -> dict[str, Any]:
        """Return it as JSON can say it, for a worker process."""
        return {
            "environment": asdict(self.environment),
            "planner": self.planner,
            "settings": self.settings.model_dump(mode="json"),
            "drive": self.drive,
            "limits": self.limits.model_dump(mode="json"),
        }

    @classmethod
    def of_order(cls, order: dict[str, Any]) -> Job:
        """Return the job that ``as_order`` has described."""
        return cls(
            environment=Environment(**order["environment"]),
            planner=order["planner"],
            settings=settings_for(order["settings"]["name"]).model_validate(order["settings"]),
            drive=order["drive"],
            limits=Limits.model_validate(order["limits"]),
        )
