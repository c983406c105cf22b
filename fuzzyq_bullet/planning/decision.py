"""A decision: its fields, declared once, and the one check that it passes before it moves anything.

The record, its file, its CSV and its documentation take the fields from here (``columns``).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from numbers import Real
from typing import Annotated, Any, Literal, NamedTuple, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.columns import Column, Columns, array_of, columns_of, documented
from fuzzyq_bullet.wording import not_one_of, shorten

Numbers: TypeAlias = Sequence[float] | NDArray[np.float64]
Table: TypeAlias = Sequence[Sequence[float]] | NDArray[np.float64]
NUMBER = float | Real
"""What counts as a number. An abstract class takes ten times as long to ask: floats first."""
Mode: TypeAlias = Literal["routine", "breakout", "following"]
MODES: tuple[Mode, ...] = get_args(Mode)

FARTHEST = 1e6
"""No angle (rad), length (m) or other number of a decision comes near this."""
LONGEST_STEP = 1000.0
"""Longest step (m): no arena is larger."""

_NAN = float("nan")
_LINES = ("left", "middle", "right")
_NEAR = ("VN", "N", "M", "F", "VF")
_SIDE = ("NB", "NS", "ZO", "PS", "PB")


def _told(unit: str, meaning: str, *axes: tuple[str, ...]) -> Column:
    """Declare a field that explains a decision, and may be left blank."""
    return Column(unit, meaning, axes, blank=True)


class Decision(NamedTuple):
    """Where to go next, and everything a picture needs to show why.

    Only ``heading``, ``step``, ``reach`` and ``backward`` move the robot. The rest explains the
    decision; a planner without fuzzy sets leaves it at its blank (NaN) default. The episode ends as
    ``stuck`` with a decision that is ``hopeless``: the planner knows that it cannot go on. With
    ``backward`` the wheels turn the robot's back to the heading and back up along it; the point
    robot, which faces any way at once, just goes there.
    """

    heading: Annotated[
        float,
        Column("rad", "World heading of the next step.", bounds=(-FARTHEST, FARTHEST)),
    ]
    step: Annotated[
        float,
        Column("m", "Length of the next step (Eq. 17: ω1·N_s·S_p).", bounds=(0, LONGEST_STEP)),
    ]
    reach: Annotated[
        float,
        Column(
            "m",
            "Distance known to be free along the way; the wheels brake so that the robot could "
            "stop within it. Infinite where nothing was checked.",
            bounds=(0.0, FARTHEST),
            blank=True,
            endless=True,
        ),
    ] = math.inf
    mode: Annotated[Mode, Column("", "The part of the planner that decided.", words=MODES)] = (
        "routine"
    )
    lines: Annotated[
        Numbers, _told("rad", "World headings of the three detection lines.", _LINES)
    ] = (_NAN,) * 3
    lengths: Annotated[Numbers, _told("m", "Their sensed free lengths.", _LINES)] = (_NAN,) * 3
    distance: Annotated[float, _told("S_p", "d, the first input of the fuzzy controller.")] = _NAN
    difference: Annotated[float, _told("S_p", "Df = left − right (Eq. 14), its second input.")] = (
        _NAN
    )
    near: Annotated[Numbers, _told("", "Memberships of d (Table 2).", _NEAR)] = (_NAN,) * 5
    side: Annotated[Numbers, _told("", "Memberships of Df (Table 2).", _SIDE)] = (_NAN,) * 5
    rules: Annotated[
        Table,
        _told("", "Firing strengths of the rules (Eq. 2): rows of d, columns of Df.", _NEAR, _SIDE),
    ] = ((_NAN,) * 5,) * 5
    turn: Annotated[
        float, _told("A_p", "N_a, the turn scale in [−2, 2], positive to the left.")
    ] = _NAN
    stride: Annotated[float, _told("S_p", "N_s, the step scale in [0, 2].")] = _NAN
    weights: Annotated[
        tuple[float, float],
        _told("", "(ω1, ω2) of Eq. 17: of the step and of the turn.", ("step", "turn")),
    ] = (_NAN, _NAN)
    breakout_at: Annotated[
        float, _told("S_p", "c_f: with less than this free towards the goal it breaks out.")
    ] = _NAN
    guard: Annotated[float, _told("m", "Free length sensed along the final heading.")] = _NAN
    target: Annotated[
        tuple[float, float], _told("m", "The temporary goal (Fig. 6), world frame.", ("x", "y"))
    ] = (_NAN, _NAN)
    aim: Annotated[
        tuple[float, float],
        _told(
            "m", "What the middle line points at: the goal, or a point of a way out.", ("x", "y")
        ),
    ] = (_NAN, _NAN)
    exact: Annotated[
        float,
        _told("", "1 where it aims at a gap exactly, without the rules; 0 where they turn it."),
    ] = _NAN
    hopeless: bool = False
    backward: bool = False


FIELDS = columns_of(Decision)
"""All that is recorded of a decision, by name."""
RARE_FIELDS: Columns = {
    "backward": Column(
        "", "1 where the robot backs up along the heading, 0 where it drives forward.", blank=True
    )
}
"""What is recorded besides, if it happens in a run: the record of any other run has no such column.
"""
Decision.__doc__ = documented(Decision.__doc__, {**FIELDS, **RARE_FIELDS})


def rare_arrays(decisions: Sequence[Decision]) -> dict[str, NDArray[np.float64]]:
    """Return the columns of ``RARE_FIELDS``, a row for each; none of what never happens."""
    return {
        name: array_of(column, values)
        for name, column in RARE_FIELDS.items()
        if any(values := [getattr(decision, name) for decision in decisions])
    }


class DecisionError(ValueError):
    """A planner decided what cannot be carried out, or no decision at all."""


def checked(decision: Any, fields: Columns = FIELDS) -> Decision:
    """Return a decision that can be carried out and recorded.

    What explains it may be left at its default, blank, whatever shape it should have.

    Args:
        decision: Whatever a planner returned.
        fields: What is recorded of it.

    Returns:
        The same decision; what explains it in tuples, which nobody can change afterwards.

    Raises:
        DecisionError: If it is no ``Decision``; if the heading or the step is not finite, the step
            or the reach negative, the reach not a number, the mode unknown; or if what explains it
            is of another shape, or absurd.
    """
    if not isinstance(decision, Decision):
        raise DecisionError(f"returned {_kind(decision)} instead of a Decision")
    told: dict[str, Any] = {}
    for (name, column), value in zip(fields.items(), decision, strict=False):
        if column.bounds is not None:
            if not (column.endless and value == math.inf):
                _within(name, value, column)
        elif column.words:
            if not isinstance(value, str) or value not in column.words:
                raise DecisionError(f"decided the {name}: {not_one_of(name, value, column.words)}")
        else:
            blank = value is Decision._field_defaults.get(name)
            told[name] = _blank(column.shape) if blank else _explaining(name, value, column.shape)
    for name in ("hopeless", "backward"):
        if not isinstance(flag := getattr(decision, name), bool | np.bool_):
            raise DecisionError(f"decided {name} {_shown(flag)}, not True or False")
    return decision._replace(**told)


def _blank(shape: tuple[int, ...]) -> Any:
    """Return NaN, or tuples of it in this shape."""
    return (_blank(shape[1:]),) * shape[0] if shape else _NAN


def _within(name: str, value: Any, column: Column) -> None:
    assert column.bounds is not None
    number, (least, most) = _number(value), column.bounds
    if number is None or not least <= number <= most:  # nor is NaN
        otherwise = " or infinite" if column.endless else ""
        allowed = f"from {least:g} to {most:g}{otherwise}"
        raise DecisionError(f"decided the {name} {_shown(value)}, which must be {allowed}")


def _explaining(name: str, value: Any, shape: tuple[int, ...]) -> Any:
    """Return what explains a decision in plain numbers, NaN and infinity for what is blank.

    Raises:
        DecisionError: If it is of another shape, or one is no number, or absurd.
    """
    if shape:
        size, *further = shape
        try:
            listed = list(value)
        except TypeError:
            listed = []
        if len(listed) != size:
            what = f"{name} {_shown(value)}, which must be of size {size}"
            raise DecisionError(f"explained its decision by the {what}")
        return tuple([_explaining(name, one, tuple(further)) for one in listed])
    number = _number(value)
    if number is not None and (abs(number) <= FARTHEST or not math.isfinite(number)):
        return number
    raise DecisionError(f"explained its decision by the {name} {_shown(value)}, which is no number")


def _number(value: Any) -> float | None:
    """Return a real number; None for what is none, or too large for one."""
    try:
        return float(value) if isinstance(value, NUMBER) else None
    except OverflowError:
        return None


def _kind(value: Any) -> str:
    return "None" if value is None else f"a {type(value).__name__}"


def _shown(value: Any) -> str:
    """Return a value in words; whatever it is, asking for its own must not fail."""
    plain = isinstance(value, int | float | str | list | tuple) and not hasattr(value, "dtype")
    try:
        return shorten(value) if plain else shorten(float(value))
    except Exception:
        return _kind(value)
