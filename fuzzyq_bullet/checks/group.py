"""One verdict on a scenario that ran with several seeds: how many passed, and the worst run.

A run that crashed, hung or ran out of memory counts as one that did not pass, and no pass rate
allows it: it says nothing about the robot.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from typing import Literal, TypeAlias

from pydantic import BaseModel

from fuzzyq_bullet.checks.verdict import AGAIN, MARKS, Status, Verdict
from fuzzyq_bullet.errors import printable
from fuzzyq_bullet.studies.statistics import Share, runs_to_be_sure, share
from fuzzyq_bullet.wording import plain

Nature: TypeAlias = Literal["steady", "flaky", "broken"]

_OUTCOMES = ("collision", "stuck", "timeout")
"""From the worst on; whatever else a run ends with is better."""


class Group(BaseModel):
    """The verdict on all runs of one scenario.

    Attributes:
        name: Name of the scenario.
        file: Its file.
        status: ``passed`` if the share of runs that passed is at least ``pass_rate``; ``failed`` if
            it is less; ``broken`` if a run crashed, hung or ran out of memory; ``invalid`` if one
            cannot be run at all.
        nature: ``steady``: all runs pass; ``flaky``: some do; ``broken``: none does.
        passed: Runs that passed.
        runs: Runs in all.
        pass_rate: Least share of runs that has to pass; None where no run told it.
        share: Share of runs that passed.
        low: Lower end of Wilson's 95 % interval of the share.
        high: Upper end.
        mean_time_s: Mean simulated time of the runs that passed (s); None if none did.
        worst: Name of the worst run: see ``badness``.
        worst_why: Why it did not pass, a line each.
        replay: The command that drives the worst run again.
        line: The line of the file that the worst run is about.
        why: Why the group did not pass, a line each.
        notes: What the figures do not tell, a line each; no note changes the verdict.
        changes: What is otherwise than recorded, a line each.
        digest: Hash of the digests of all runs, in the order of their seeds.
    """

    name: str
    file: str
    status: Status
    nature: Nature
    passed: int
    runs: int
    pass_rate: float | None
    share: float
    low: float
    high: float
    mean_time_s: float | None
    worst: str
    worst_why: list[str]
    replay: str
    line: int
    why: list[str] = []
    notes: list[str] = []
    changes: list[str] = []
    digest: str = ""


def badness(verdict: Verdict) -> tuple[float, ...]:
    """Return how bad a run was: the worst is the greatest, and of equals the first.

    A run that did not come to an end is worse than one that failed, and that is worse than one that
    passed. Then by outcome: collision, stuck, timeout, any other. Then the one with less clearance,
    then the one that took longer.
    """
    order: tuple[Status, ...] = ("passed", "allowed", "failed", "broken", "invalid")
    rank = order.index("failed" if verdict.status == "allowed" else verdict.status)
    result = verdict.result
    if result is None:
        return rank, 0.0, 0.0, 0.0
    outcome = result.outcome
    ended = len(_OUTCOMES) - _OUTCOMES.index(outcome) if outcome in _OUTCOMES else 0
    near = result.min_clearance_m
    return rank, ended, -math.inf if near is None else -near, result.time_s


def worst_of(verdicts: Sequence[Verdict]) -> Verdict:
    """Return the worst run (see ``badness``)."""
    return max(verdicts, key=badness)


def group_of(name: str, verdicts: Sequence[Verdict]) -> Group:
    """Judge all runs of a scenario together.

    Args:
        name: Name of the scenario.
        verdicts: Its runs, at least one, in the order of their seeds.
    """
    passed = sum(verdict.status == "passed" for verdict in verdicts)
    found = share(passed, len(verdicts))
    assert found is not None, "a group has runs"
    rates = [verdict.expect["pass_rate"] for verdict in verdicts if verdict.expect]
    rate = rates[0] if rates else None
    found_in = [verdict.status for verdict in verdicts]
    status: Status = "passed"
    why = []
    if "invalid" in found_in:
        status = "invalid"
        why.append(f"{_runs(found_in.count('invalid'))} of {len(verdicts)} cannot be run at all")
    elif "broken" in found_in:
        status = "broken"
        why.append(
            f"{_runs(found_in.count('broken'))} of {len(verdicts)} crashed, hung or ran out of "
            "memory, which no pass_rate allows"
        )
    elif rate is not None and passed / len(verdicts) < rate:
        status = "failed"
        why.append(f"pass_rate {plain(passed / len(verdicts), 3)}, expected {rate:g} or more")
    worst = worst_of(verdicts)
    times = [v.result.time_s for v in verdicts if v.result is not None and v.status == "passed"]
    digests = [verdict.result.digest if verdict.result else "" for verdict in verdicts]
    return Group(
        name=name,
        file=verdicts[0].file,
        status=status,
        nature="steady" if passed == len(verdicts) else "flaky" if passed else "broken",
        passed=passed,
        runs=len(verdicts),
        pass_rate=rate,
        share=found.value,
        low=found.low,
        high=found.high,
        mean_time_s=round(sum(times) / len(times), 6) if times else None,
        worst=worst.name,
        worst_why=worst.why,
        replay=worst.replay,
        line=worst.line,
        why=why,
        notes=_notes(found, rate, digests),
        digest=hashlib.sha256("".join(digests).encode()).hexdigest()[:32],
    )


def allow(group: Group, verdicts: Sequence[Verdict]) -> None:
    """Mark the runs that failed as allowed, if their group passed all the same."""
    if group.status == "passed":
        for verdict in verdicts:
            if verdict.status == "failed":
                verdict.status = "allowed"


def _notes(found: Share, rate: float | None, digests: Sequence[str]) -> list[str]:
    if len(digests) > 1 and all(digests) and len(set(digests)) == 1:
        return [
            f"all {len(digests)} runs are the same: the seed changes nothing here, so repeating "
            "tells nothing"
        ]
    if rate is None or rate >= 1.0:  # no number of runs can prove that all pass
        return []
    if found.value >= rate > found.low:
        enough = f"{runs_to_be_sure(rate)} runs that all pass would do"
        return [
            f"too few runs to be sure of {rate:g}: the interval begins at {found.low:.2f}; "
            + (enough if found.number == found.of else "more runs would tell")
        ]
    if found.value < rate <= found.high:
        return [
            f"too few runs to rule out {rate:g}: the interval ends at {found.high:.2f}; "
            "more runs would tell"
        ]
    return []


def group_lines(group: Group, width: int = 0) -> list[str]:
    """Return the line of a group's verdict and, beneath it, why, notes, and the worst run.

    Args:
        group: The verdict on all.
        width: Width of the column of names.
    """
    line = f"{MARKS[group.status]:<5} {group.name:<{width}}  {in_words(group)}"
    lines = [line, *(f"      {reason}" for reason in group.why)]
    lines += [f"      note: {note}" for note in group.notes]
    lines += [f"      changed: {change}" for change in group.changes]
    if group.nature != "steady" or group.status != "passed":
        why = "; ".join(group.worst_why)
        lines.append(f"      worst: {group.worst}{': ' if why else ''}{why}")
        lines += [AGAIN + group.replay] if group.replay else []
    return [printable(line) for line in lines]


def in_words(group: Group) -> str:
    """Say how many runs pass: ``flaky: 17 of 20 pass, 95 % interval 0.64 to 0.95``."""
    nature = "" if group.nature == "steady" else f"{group.nature}: "
    return (
        f"{nature}{group.passed} of {group.runs} pass, "
        f"95 % interval {group.low:.2f} to {group.high:.2f}"
    )


def _runs(number: int) -> str:
    return f"{number} run{'s' if number != 1 else ''}"
