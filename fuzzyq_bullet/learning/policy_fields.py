"""What the fields of a policy may hold: checked by hand where a hostile file would be costly."""

from __future__ import annotations

from typing import Annotated, Any, TypeAlias

from pydantic import BeforeValidator, Field, StringConstraints

from fuzzyq_bullet.learning.checkpoint import LARGEST
from fuzzyq_bullet.learning.plain_json import shown

MAX_STATES = 50_000
MAX_ACTIONS = 1_000
MAX_PARAMETERS = 200
MAX_NAME = 100
MAX_WORDS = 2_000


def _text(value: Any) -> Any:
    # A path on a command line may hold bytes that are no text; they must not spoil the file.
    return value.encode("utf-8", "backslashreplace").decode() if isinstance(value, str) else value


# By hand: pydantic would make an error of each of a million wrong items.
def _names(value: Any, most: int) -> tuple[str, ...]:
    if not isinstance(value, list | tuple) or not 1 <= len(value) <= most:
        raise ValueError(f"must be a list of 1 to {most} names, got {shown(value)}")
    seen: set[str] = set()
    for name in value:
        if not isinstance(name, str) or not 1 <= len(name) <= MAX_NAME:
            raise ValueError(f"a name is text of 1 to {MAX_NAME} letters, got {shown(name)}")
        if name in seen:
            raise ValueError(f"every name must be another, {shown(name)} is given twice")
        seen.add(name)
    return tuple(_text(name) for name in value)


def _state_names(value: Any) -> tuple[str, ...]:
    return _names(value, MAX_STATES)


def _action_names(value: Any) -> tuple[str, ...]:
    return _names(value, MAX_ACTIONS)


def _rows(value: Any) -> tuple[tuple[float, ...], ...]:
    if not isinstance(value, list | tuple) or not 1 <= len(value) <= MAX_STATES:
        raise ValueError(f"must be a list of 1 to {MAX_STATES} rows, got {shown(value)}")
    for i, row in enumerate(value):
        if not isinstance(row, list | tuple):
            raise ValueError(f"row {i} must be a list of numbers, got {shown(row)}")
        for number in row:
            # Not isinstance: true is an int. Negated, so that NaN is refused.
            if type(number) not in (float, int) or not abs(number) <= LARGEST:
                raise ValueError(
                    f"row {i} must hold numbers within ±{LARGEST:g}, got {shown(number)}"
                )
    return tuple(tuple(float(number) for number in row) for row in value)


def _parameters(value: Any) -> dict[str, Any]:
    if not isinstance(value, dict) or len(value) > MAX_PARAMETERS:
        raise ValueError(f"must be an object of at most {MAX_PARAMETERS} keys, got {shown(value)}")
    for key, item in value.items():
        if not isinstance(key, str) or not 1 <= len(key) <= MAX_NAME:
            raise ValueError(f"a key is text of 1 to {MAX_NAME} letters, got {shown(key)}")
        if isinstance(item, str):
            fits = len(item) <= MAX_WORDS
        else:
            fits = item is None or (type(item) in (bool, int, float) and abs(item) <= 2**63)
        if not fits:
            raise ValueError(
                f"{shown(key)} must be a number, true, false, null or text of at most {MAX_WORDS} "
                f"letters, got {shown(item)}"
            )
    return {_text(key): _text(item) for key, item in value.items()}


Name: TypeAlias = Annotated[
    str, StringConstraints(min_length=1, max_length=MAX_NAME), BeforeValidator(_text)
]
Words: TypeAlias = Annotated[str, StringConstraints(max_length=MAX_WORDS), BeforeValidator(_text)]
Whole: TypeAlias = Annotated[int, Field(ge=0, lt=2**63)]
Parameters: TypeAlias = Annotated[
    dict[str, str | bool | int | float | None], BeforeValidator(_parameters)
]
States: TypeAlias = Annotated[tuple[str, ...], BeforeValidator(_state_names)]
Actions: TypeAlias = Annotated[tuple[str, ...], BeforeValidator(_action_names)]
Rows: TypeAlias = Annotated[tuple[tuple[float, ...], ...], BeforeValidator(_rows)]
