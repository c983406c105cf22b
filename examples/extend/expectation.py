"""An expectation: how much the robot may turn.

With ``expect: {max_turning: 20.0}`` in a scenario file:

fuzzyq check my-scenario.yaml --plugin examples/extend/expectation.py
"""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from fuzzyq_bullet import Result
from fuzzyq_bullet.scenario import register_expectation


@register_expectation(
    "max_turning",
    sense="at most",
    said="turned {} rad",
    unit="rad",
    limit=Annotated[float, Field(gt=0.0, allow_inf_nan=False)],
)
def turning(result: Result) -> float:
    """Greatest sum of all changes of direction (rad)."""
    return result.turning_rad
