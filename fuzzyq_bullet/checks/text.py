"""A verdict in lines for people, and the command that does it again."""

from __future__ import annotations

import shlex
from collections.abc import Sequence

from fuzzyq_bullet.checks.verdict import Job, Verdict
from fuzzyq_bullet.collision_text import plain
from fuzzyq_bullet.errors import printable
from fuzzyq_bullet.workers.pool import MEMORY_MB, TIMEOUT

AGAIN = "      again: "
"""What the command that replays a run begins with."""
_MARKS = {"passed": "ok", "failed": "FAIL", "broken": "FAIL", "invalid": "ERROR"}


def lines_of(verdict: Verdict, width: int = 0) -> list[str]:
    """Return the line of a verdict and, beneath it, why it failed and how to see it again.

    Args:
        verdict: What came of a scenario.
        width: Width of the column of names.
    """
    result = verdict.result
    line = f"{_MARKS[verdict.status]:<5} {verdict.name:<{width}}"
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
    if verdict.status in ("failed", "broken") and verdict.replay:
        lines.append(AGAIN + verdict.replay)
    return [printable(line) for line in lines]


def explanation(verdict: Verdict) -> str:
    """Return all that is known about a failure, the reason first, for a report of a test."""
    first, *lines = (line.removeprefix("      ") for line in lines_of(verdict))
    lines.insert(len(verdict.why), first)
    return "\n".join(lines)


def summary(verdicts: list[Verdict], problems: int, seconds: float) -> str:
    """Return the last line: how many passed, failed and could not be run."""
    count = {"passed": 0, "failed": 0, "broken": 0, "invalid": 0}
    for verdict in verdicts:
        count[verdict.status] += 1
    failed, wrong = count["failed"] + count["broken"], count["invalid"] + problems
    parts = [f"{count['passed']} passed"]
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
