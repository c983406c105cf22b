"""One episode of a sweep: as it is asked for, and as the row of the CSV that it came to."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from fuzzyq_bullet.planning import PlannerSettings, settings_for
from fuzzyq_bullet.recording.metrics import Result
from fuzzyq_bullet.recording.trajectory import Outcome
from fuzzyq_bullet.scenario import Drive, Limits, Robot, Scenario, cellular_task, random_task
from fuzzyq_bullet.scenario.layouts import Wanderers
from fuzzyq_bullet.sensors import ExactSensor

Place: TypeAlias = tuple[str, int, int]
"""Layout, count (−1 without one) and number of an environment."""
Key: TypeAlias = tuple[str, str, str, int, int]
"""Planner, drive, and the place: unique in a sweep, and its order."""

MOST_RUNS = 1_000_000
"""Environments that one seed of a sweep has room for, before it meets those of the next."""
MOST_SEED = (2**63 - 1) // MOST_RUNS - 1
"""Greatest seed of a sweep."""
_LABEL = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")
_LONGEST = 300
_ADDRESS = re.compile(r"0x[0-9a-fA-F]+")
_LAST_OF_ALL = "error"
"""The last column that every table has. New ones come behind it, and earlier tables lack them."""


@dataclass(frozen=True)
class Environment:
    """A walled 10 × 10 m arena, or a corridor of pillars (``cellular``), all out of one seed.

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

    @property
    def place(self) -> Place:
        """What tells it from the other environments of its sweep."""
        return self.layout, -1 if self.count is None else self.count, self.run

    @classmethod
    def of(cls, layout: str, count: int | None, run: int, sweep_seed: int) -> Environment:
        """Return environment number ``run`` of a sweep.

        The seed is plain arithmetic, so that anybody can build the same by hand. It does not depend
        on the layout or the count: different counts have the same starts and goals, and a scatter
        field begins with the obstacles of the smaller ones.
        """
        return cls(layout, count, run, sweep_seed * MOST_RUNS + run)


class Outfit(BaseModel):
    """What drives through the environments of a sweep instead of their own robot, and what moves.

    Attributes:
        robot: Its model; None for that of the environment.
        max_speed: Its greatest speed (m/s); None for that of the model, or of the environment.
        range: How far it sees (m); None for 5·S_p.
        disturbed: What disturbs it: keys of ``sensor`` and ``robot`` in a scenario file.
        movers: What wanders in its way: keys of ``random.movers``; what stands is the same.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    robot: str | None = None
    max_speed: float | None = None
    range: float | None = None
    disturbed: dict[str, float] = Field(default_factory=dict)
    movers: Wanderers | None = None

    def on(self, task: Scenario) -> Scenario:
        """Return a scenario with this robot in it.

        Raises:
            pydantic.ValidationError: If there is no such robot, or it cannot be so.
        """
        given = {} if self.max_speed is None else {"max_speed": self.max_speed}
        own = {} if self.robot is not None else task.robot.model_dump()
        model = {} if self.robot is None else {"model": self.robot}
        slips = {key: v for key, v in self.disturbed.items() if key in Robot.model_fields}
        noise = {key: v for key, v in self.disturbed.items() if key not in slips}
        robot = Robot.model_validate({**own, **model, **given, **slips})
        sensor = ExactSensor.model_validate({"range": self.range, **noise})
        random = task.random
        if self.movers is not None and random is not None:
            random = random.model_copy(update={"movers": self.movers})
        return task.model_copy(update={"robot": robot, "sensor": sensor, "random": random})


USUAL = Outfit()


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
        outfit: What drives instead of the environment's own robot; a world has its own.
        world: The world itself as JSON, where the environment is not drawn but was read from a
            file: workers need not have that file.
    """

    environment: Environment
    planner: str
    settings: PlannerSettings
    drive: Drive
    limits: Limits
    outfit: Outfit = USUAL
    world: str | None = None

    def __post_init__(self) -> None:
        if not _LABEL.fullmatch(self.planner):
            raise ValueError(f"planner: {self.planner!r} cannot be part of a file's name")

    @property
    def key(self) -> Key:
        """What tells it from the other jobs of its sweep, and sorts them."""
        return self.planner, self.drive, *self.environment.place

    @property
    def name(self) -> str:
        """The same as part of a file's name."""
        planner, drive, layout, count, run = self.key
        return "-".join([planner, drive, layout, *([] if count < 0 else [str(count)]), str(run)])

    def scenario(self) -> Scenario:
        """Return what is to be run, with its obstacles still to be drawn."""
        where = self.environment
        asked = {"planner": self.settings, "drive": self.drive, "limits": self.limits}
        if self.world is not None:
            world = Scenario.model_validate_json(self.world)
            return world.model_copy(update={**asked, "seed": where.seed})
        if where.layout == "cellular":
            task = cellular_task(where.seed)
        else:
            task = random_task(where.seed, layout=where.layout, count=where.count)
        return self.outfit.on(task).model_copy(update=asked)

    def as_order(self) -> dict[str, Any]:
        """Return it as JSON can say it, for a worker process."""
        return {
            "environment": asdict(self.environment),
            "planner": self.planner,
            "settings": self.settings.model_dump(mode="json"),
            "drive": self.drive,
            "limits": self.limits.model_dump(mode="json"),
            "outfit": self.outfit.model_dump(mode="json"),
            "world": self.world,
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
            outfit=Outfit.model_validate(order["outfit"]),
            world=order["world"],
        )


OF_MACHINE = ("decision_ms", "decision_p95_ms")
"""Fields of a row that no two runs share. The journal has them; the table of a sweep, which comes
out the same each time, has not."""


class Row(BaseModel):
    """What an episode came to. The columns of the CSV are the fields, but ``OF_MACHINE``.

    Attributes:
        planner: What the sweep calls the planner.
        drive: ``wheels`` or ``kinematic``.
        count: Number of obstacles asked for; None for layouts without a count.
        run: Number of the environment.
        seed: Seed of the scenario.
        feasible: Whether there is a way for a disc of radius ``room_of`` (``studies.sweep``); None
            where the environment could not be built.
        outcome: As in results, or ``error`` where the episode failed itself.
        steps: As in results; so are the following, all None after an error.
        time_s: Simulated time (s).
        path_length_m: Length of the driven path (m).
        shortest_path_m: Length of the shortest path (m); None where there is none.
        spl: Success weighted by path length; None where there is no way.
        min_clearance_m: Least distance to anything (m); None when there was nothing.
        collisions: 0 or 1.
        digest: Hash of the exact trajectory.
        layout: Name of the layout that drew the obstacles.
        error: What went wrong with the episode itself; None normally.
        turning_rad: Sum of all changes of direction (rad).
        mean_jerk: Mean of |jerk| (m/s³); None in the kinematic drive.
        rules_turn: Share of the decisions near something in which the rules turn the robot; None
            for a planner without rules.
        at_fault: Whether the robot was at fault for its contact; None without one, and in tables
            of versions that did not tell.
        decision_ms: Median processor time of a decision (ms), the rays included that the planner
            asks for; None in studies that do not measure it.
        decision_p95_ms: The time that 95 % of the decisions stay below (ms).
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    planner: str
    drive: Drive
    count: int | None
    run: int
    seed: int
    feasible: bool | None
    outcome: Outcome | Literal["error"]
    steps: int | None = None
    time_s: float | None = None
    path_length_m: float | None = None
    shortest_path_m: float | None = None
    spl: float | None = None
    min_clearance_m: float | None = None
    collisions: int | None = None
    digest: str | None = None
    layout: str
    error: str | None = None
    turning_rad: float | None = None
    mean_jerk: float | None = None
    rules_turn: float | None = None
    at_fault: bool | None = None
    decision_ms: float | None = None
    decision_p95_ms: float | None = None

    @property
    def place(self) -> Place:
        """The environment."""
        return self.layout, -1 if self.count is None else self.count, self.run

    @property
    def key(self) -> Key:
        """The key of its job."""
        return self.planner, self.drive, *self.place

    @property
    def success(self) -> bool:
        """Whether the goal was reached."""
        return self.outcome == "goal"

    @property
    def path_ratio(self) -> float | None:
        """Driven over shortest path; None where one of them is unknown, or there is none."""
        if self.path_length_m is None or not self.shortest_path_m:
            return None
        return self.path_length_m / self.shortest_path_m

    @classmethod
    def of(cls, job: Job, result: Result, feasible: bool) -> Row:
        """Return the row of an episode that ran to its end."""
        measured = result.model_dump(include=set(cls.model_fields) - {"planner", "drive", "seed"})
        return cls(**_asked(job), **measured, feasible=feasible)

    @classmethod
    def failed(cls, job: Job, error: str, feasible: bool | None = None) -> Row:
        """Return the row of an episode that itself went wrong.

        Args:
            job: What was asked for.
            error: What happened; kept as one line that does not change from run to run.
            feasible: Whether there is a way, if that is known.
        """
        line = _ADDRESS.sub("0x…", " ".join(error.split()))[:_LONGEST]
        return cls(**_asked(job), feasible=feasible, outcome="error", error=line)


_COLUMNS = tuple(name for name in Row.model_fields if name not in OF_MACHINE)


def _asked(job: Job) -> dict[str, Any]:
    return {"planner": job.planner, "drive": job.drive, **asdict(job.environment)}


def as_csv(rows: Iterable[Row]) -> str:
    """Return rows as CSV, sorted by their keys: the same rows give the same bytes."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(_COLUMNS)
    for row in sorted(rows, key=lambda one: one.key):
        writer.writerow([_cell(getattr(row, name)) for name in _COLUMNS])
    return text.getvalue()


def from_csv(text: str) -> list[Row]:
    """Return the rows of a CSV as ``as_csv`` writes it, or wrote it with fewer columns.

    Raises:
        ValueError: If it is none; says in which line, and what is wrong there.
    """
    reader = csv.reader(io.StringIO(text, newline=""), strict=True)
    every = list(_COLUMNS)
    least = every.index(_LAST_OF_ALL) + 1
    rows: dict[Key, Row] = {}
    try:
        names = next(reader, [])
        if names != every[: max(least, len(names))]:
            raise ValueError(f"must have the columns {','.join(every)}")
        for cells in reader:
            if len(cells) != len(names):
                raise ValueError(f"{len(cells)} columns instead of {len(names)}")
            given = {name: cell or None for name, cell in zip(names, cells, strict=True)}
            row = Row.model_validate(given)
            if row.key in rows:
                raise ValueError("an episode that another line has already")
            rows[row.key] = row
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = ".".join(map(str, first["loc"]))
        raise ValueError(f"line {reader.line_num}: {where}: {first['msg']}") from error
    except (ValueError, csv.Error) as error:
        raise ValueError(f"line {max(reader.line_num, 1)}: {error}") from error
    return list(rows.values())


def _cell(value: object) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(value) if isinstance(value, float) else str(value)
