"""What a run was expected to do against what it did."""

from __future__ import annotations

from fuzzyq_bullet.contact import plain
from fuzzyq_bullet.metrics import Result
from fuzzyq_bullet.scenario.models import Expect


def missed(expect: Expect, result: Result) -> list[str]:
    """Return one line for every expectation that the run did not meet; empty when all is well.

    A figure that is missing, or not a number, meets no expectation.
    """
    lines = []
    if result.outcome != expect.outcome:
        lines.append(f"outcome {result.outcome}, expected {expect.outcome}")
    least = result.min_clearance_m
    if expect.min_clearance is not None:
        wanted = f"expected {expect.min_clearance:g} m or more"
        if least is None:
            lines.append(f"no clearance, as there is nothing to keep clear of; {wanted}")
        elif not least >= expect.min_clearance:
            lines.append(f"least clearance {plain(least, 3)} m, {wanted}")
    if expect.max_time is not None and not result.time_s <= expect.max_time:
        lines.append(f"took {result.time_s:.1f} s, expected {expect.max_time:g} s or less")
    return lines
