"""What is asked of a worker and what came of it: plain data, lines for people, and a command."""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Sequence
from typing import Any, Literal, TypeAlias, get_args

from pydantic import BaseModel, ConfigDict

from fuzzyq_bullet.errors import printable
from fuzzyq_bullet.recording.metrics import Result
from fuzzyq_bullet.wording import plain
from fuzzyq_bullet.workers.pool import MEMORY_MB, TIMEOUT

Status: TypeAlias = Literal["passed", "allowed", "failed", "broken", "invalid"]
Keep: TypeAlias = Literal["failed", "all", "none"]

AGAIN = "      again: "
"""What the command that replays a run begins with."""
MARKS = {"passed": "ok", "allowed": "miss", "failed": "FAIL", "broken": "FAIL", "invalid": "ERROR"}
"""What the line of a verdict begins with."""


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


class Touch(BaseModel):
    """What the robot came nearest to.

    Attributes:
        what: In words, such as ``the cylinder obstacles[3]`` or ``a wall``.
        obstacle: Index into the obstacles, drawn ones behind those in the file; −1 for a wall.
        line: Line of the scenario file that put it there.
        point: Where they touched, or where the robot's centre was (m).
        time_s: When, in simulated time (s).
        distance_m: Distance between the two (m); 0 when they touched, negative where the disc
            around the robot overlaps it without a contact.
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
        status: ``passed``; ``failed``: it missed what it expects; ``allowed``: it did so too, and
            the pass rate of its group allows it; ``broken``: it crashed, hung or ran out of
            memory; ``invalid``: it cannot be run at all.
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


def lines_of(verdict: Verdict, width: int = 0, *, member: bool = False) -> list[str]:
    """Return the line of a verdict and, beneath it, why it failed and how to see it again.

    Args:
        verdict: What came of a scenario.
        width: Width of the column of names.
        member: Whether it is one run of several, whose group is judged when all are there: a miss
            is not a failure yet, and the group tells how to see the worst again.
    """
    result = verdict.result
    mark = MARKS["allowed" if member and verdict.status == "failed" else verdict.status]
    line = f"{mark:<5} {verdict.name:<{width}}"
    if result is None:
        line += f"  {verdict.file}"
    else:
        clearance = result.min_clearance_m
        near = "nothing near" if clearance is None else f"clearance {plain(clearance, 3)} m"
        line += f"  {result.outcome:<9} {result.time_s:6.1f} s  {near}"
        if verdict.status == "passed" and result.outcome != "goal":
            line += "  as expected"
    lines = [line.rstrip(), *(f"      {reason}" for reason in verdict.why)]
    lines += [f"      warning: {warning}" for warning in verdict.warnings]
    lines += [f"      changed: {change}" for change in verdict.changes]
    lines += [f"      no film: {verdict.no_film}"] if verdict.no_film else []
    if verdict.status in ("allowed", "failed", "broken") and not member and verdict.replay:
        lines.append(AGAIN + verdict.replay)
    return [printable(line) for line in lines]


def explanation(verdict: Verdict) -> str:
    """Return all that is known about a failure, the reason first, for a report of a test."""
    first, *lines = (line.removeprefix("      ") for line in lines_of(verdict))
    lines.insert(len(verdict.why), first)
    return "\n".join(lines)


def counts_of(verdicts: Iterable[Verdict]) -> dict[str, int]:
    """Return how many verdicts there are of each status."""
    found = [verdict.status for verdict in verdicts]
    return {status: found.count(status) for status in get_args(Status)}


def summary(verdicts: list[Verdict], problems: int, seconds: float) -> str:
    """Return the last line: how many passed, failed and could not be run."""
    count = counts_of(verdicts)
    failed, wrong = count["failed"] + count["broken"], count["invalid"] + problems
    parts = [f"{count['passed']} passed"]
    parts += [f"{count['allowed']} missed and allowed"] if count["allowed"] else []
    parts += [f"{failed} failed"] if failed else []
    parts += [f"{wrong} mistake{'s' if wrong > 1 else ''} in the input"] if wrong else []
    changed = sum(bool(verdict.changes) for verdict in verdicts)
    parts += [f"{changed} changed"] if changed else []
    return f"{', '.join(parts)} in {seconds:.1f} s"


def replay_command(job: Job, plugins: Sequence[str] = ()) -> str:
    """Return a line for the shell, which also leaves a film.

    Args:
        job: What was driven.
        plugins: Modules it needs.
    """
    return shlex.join(["fuzzyq", "run", *_arguments(job, plugins)])


def check_command(
    job: Job,
    plugins: Sequence[str] = (),
    *,
    timeout: float = TIMEOUT,
    memory_mb: int = MEMORY_MB,
) -> str:
    """Return a line for the shell that does it again within bounds, for what crashes or hangs.

    Args:
        job: What was driven.
        plugins: Modules it needs.
        timeout: Wall-clock time (s) that it had.
        memory_mb: Memory (MB) that it had.
    """
    arguments = ["fuzzyq", "check", *_arguments(job, plugins)]
    if timeout != TIMEOUT:
        arguments += ["--timeout", f"{timeout:g}"]
    if memory_mb != MEMORY_MB:
        arguments += ["--memory", str(memory_mb)]
    return shlex.join(arguments)


def _arguments(job: Job, plugins: Sequence[str]) -> list[str]:
    arguments = [f"./{job.file}" if job.file.startswith("-") else job.file]
    for plugin in plugins:
        arguments += ["--plugin", plugin]
    for option in ("planner", "seed", "drive"):
        value = getattr(job, option)
        if value is not None:
            arguments += [f"--{option}", str(value)]
    return arguments
