"""What a run was expected to do against what it did."""

from __future__ import annotations

from fuzzyq_bullet.metrics import Result
from fuzzyq_bullet.scenario.models import Expect


def missed(expect: Expect, result: Result) -> list[str]:
    """Return one line for every expectation that the run did not meet; empty when all is well."""
    lines = []
    if result.outcome != expect.outcome:
        lines.append(f"outcome {result.outcome}, expected {expect.outcome}")
    least = result.min_clearance_m
    if expect.min_clearance is not None and least is not None and least < expect.min_clearance:
        lines.append(f"least clearance {least:.3f} m, expected {expect.min_clearance:g} m or more")
    if expect.max_time is not None and result.time_s > expect.max_time:
        lines.append(f"took {result.time_s:.1f} s, expected {expect.max_time:g} s or less")
    return lines
