"""What is asked of a worker, and what came of it: plain data that goes through a pipe."""

from __future__ import annotations

from typing import Any, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict

from fuzzyq_bullet.metrics import Result

Status: TypeAlias = Literal["passed", "failed", "broken", "invalid"]
Keep: TypeAlias = Literal["failed", "all", "none"]


class Job(BaseModel):
    """One scenario to be run once.

    Attributes:
        file: The scenario file.
        name: What to call it: the scenario's name, and its seed where there are several.
        planner: Planner to use instead of its own.
        seed: Seed to use instead of its own.
        drive: Drive to use instead of its own.
        record: Where to keep the trajectory; None for nowhere.
        keep: Of which runs it is kept.
        again: The command that does it again; empty for one of ``fuzzyq``.
    """

    model_config = ConfigDict(frozen=True)

    file: str
    name: str
    planner: str | None = None
    seed: int | None = None
    drive: str | None = None
    record: str | None = None
    keep: Keep = "none"
    again: str = ""


class FilmJob(BaseModel):
    """One film to be made from a kept trajectory.

    Attributes:
        record: The trajectory.
        video: The MP4 to write.
    """

    model_config = ConfigDict(frozen=True)

    record: str
    video: str


class Touch(BaseModel):
    """What the robot came nearest to.

    Attributes:
        what: In words, such as ``the cylinder obstacles[3]`` or ``a wall``.
        obstacle: Index into the obstacles, drawn ones behind those in the file; −1 for a wall.
        line: Line of the scenario file that put it there.
        point: Where they touched, or where the robot's centre was (m).
        time_s: When, in simulated time (s).
        distance_m: Distance between the two (m); 0 when they touched.
    """

    what: str
    obstacle: int
    line: int
    point: tuple[float, float]
    time_s: float
    distance_m: float


class Verdict(BaseModel):
    """What came of a job.

    Attributes:
        name: Name of the scenario, with the seed where there are several.
        file: Its file.
        status: ``passed``; ``failed``: it missed what it expects; ``broken``: it crashed, hung or
            ran out of memory; ``invalid``: it cannot be run at all.
        why: What is wrong, a line each; empty when it passed.
        warnings: What is allowed in the scenario and yet hardly meant, a line each.
        line: The line of the file that this is about.
        touch: What it touched, or came too near to.
        replay: The command that drives it again.
        changes: What is otherwise than recorded, a line each.
        expect: What was expected.
        result: The figures of the run; None where there was none.
        record: The trajectory that was kept.
        video: The film that was made.
        no_film: Why there is none, although one was asked for.
        seconds: Wall-clock time (s).
    """

    name: str
    file: str
    status: Status
    why: list[str] = []
    warnings: list[str] = []
    line: int = 1
    touch: Touch | None = None
    replay: str = ""
    changes: list[str] = []
    expect: dict[str, Any] | None = None
    result: Result | None = None
    record: str | None = None
    video: str | None = None
    no_film: str = ""
    seconds: float = 0.0
