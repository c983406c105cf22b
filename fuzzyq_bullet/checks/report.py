"""Verdicts as JSON."""

from __future__ import annotations

import json
from collections.abc import Sequence

from fuzzyq_bullet.checks.verdict import Verdict
from fuzzyq_bullet.version import __version__


def as_json(verdicts: Sequence[Verdict], problems: Sequence[str], seconds: float) -> str:
    """Return all that is known of a check.

    Args:
        verdicts: What came of each scenario.
        problems: What is wrong with the input besides.
        seconds: Wall-clock time of it all (s).
    """
    count = dict.fromkeys(("passed", "failed", "broken", "invalid"), 0)
    for verdict in verdicts:
        count[verdict.status] += 1
    told = {
        "version": __version__,
        **count,
        "problems": list(problems),
        "seconds": round(seconds, 3),
        "scenarios": [verdict.model_dump(mode="json") for verdict in verdicts],
    }
    return json.dumps(told, indent=2)
