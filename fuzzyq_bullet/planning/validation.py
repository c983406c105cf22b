"""The one check that every decision passes before it moves anything, whoever made it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from numbers import Real
from typing import Any

import numpy as np

from fuzzyq_bullet.planning.base import MODES, Decision
from fuzzyq_bullet.wording import not_one_of, shorten

FARTHEST = 1e6
"""No angle (rad), length (m) or other number of a decision comes near this."""
LONGEST_STEP = 1000.0
"""Longest step (m): no arena is larger."""

_ROW = {"lines": 3, "lengths": 3, "near": 5, "side": 5, "weights": 2, "target": 2}
"""How many numbers each explaining field holds."""
_TABLE = 5
"""Rows and columns of ``rules``."""
_NUMBERS = ("distance", "difference", "turn", "stride", "breakout_at", "guard")


class DecisionError(ValueError):
    """A planner decided what cannot be carried out, or no decision at all."""


def checked(decision: Any) -> Decision:
    """Return a decision that can be carried out and recorded.

    Args:
        decision: Whatever a planner returned.

    Returns:
        The same decision; what explains it in tuples, which nobody can change afterwards.

    Raises:
        DecisionError: If it is no ``Decision``; if the heading or the step is not finite, the step
            or the reach negative, the reach not a number, the mode unknown; or if what explains it
            is of another shape, or absurd.
    """
    if not isinstance(decision, Decision):
        raise DecisionError(f"returned {_kind(decision)} instead of a Decision")
    _within("heading", decision.heading, -FARTHEST, FARTHEST)
    _within("step", decision.step, 0.0, LONGEST_STEP)
    if decision.reach != math.inf:
        _within("reach", decision.reach, 0.0, FARTHEST, " or infinite")
    if not isinstance(decision.mode, str) or decision.mode not in MODES:
        raise DecisionError(f"decided the mode: {not_one_of('mode', decision.mode, MODES)}")
    if not isinstance(decision.hopeless, bool | np.bool_):
        raise DecisionError(f"decided hopeless {_shown(decision.hopeless)}, not True or False")
    for name in _NUMBERS:
        _explaining(name, getattr(decision, name))
    frozen: dict[str, Any] = {
        name: _row(name, getattr(decision, name), size) for name, size in _ROW.items()
    }
    table = _sequence("rules", decision.rules, _TABLE)
    frozen["rules"] = tuple(_row("rules", row, _TABLE) for row in table)
    return decision._replace(**frozen)


def _within(name: str, value: Any, least: float, most: float, otherwise: str = "") -> None:
    number = _number(value)
    if number is None or not least <= number <= most:  # nor is NaN
        shown = _shown(value)
        raise DecisionError(
            f"decided the {name} {shown}, which must be from {least:g} to {most:g}{otherwise}"
        )


def _explaining(name: str, value: Any) -> float:
    """Return a number that explains; NaN and infinity stand for a blank.

    Raises:
        DecisionError: If it is no number, or absurd.
    """
    number = _number(value)
    if number is not None and (abs(number) <= FARTHEST or not math.isfinite(number)):
        return number
    raise DecisionError(f"explained its decision by the {name} {_shown(value)}, which is no number")


def _number(value: Any) -> float | None:
    """Return a real number; None for what is none, or too large for one."""
    try:
        return float(value) if isinstance(value, Real) else None
    except OverflowError:
        return None


def _row(name: str, values: Any, size: int) -> tuple[float, ...]:
    return tuple([_explaining(name, value) for value in _sequence(name, values, size)])


def _sequence(name: str, values: Any, size: int) -> Sequence[Any]:
    try:
        listed = list(values)
    except TypeError:
        listed = []
    if len(listed) != size:
        raise DecisionError(
            f"explained its decision by the {name} {_shown(values)}, which must be of size {size}"
        )
    return listed


def _kind(value: Any) -> str:
    return "None" if value is None else f"a {type(value).__name__}"


def _shown(value: Any) -> str:
    """Return a value in words; whatever it is, asking for its own must not fail."""
    plain = isinstance(value, int | float | str | list | tuple) and not hasattr(value, "dtype")
    try:
        return shorten(value) if plain else shorten(float(value))
    except Exception:
        return _kind(value)
