"""A verdict in lines for people."""

from __future__ import annotations

from fuzzyq_bullet.checks.verdict import Verdict
from fuzzyq_bullet.collision_text import plain
from fuzzyq_bullet.errors import printable

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
