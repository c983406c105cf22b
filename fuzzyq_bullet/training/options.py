"""How to learn, as a user asks for it: schedules, discount and reward, on the command line or YAML.

A schedule is a number, ``0.9``, or falls in a straight line over the episodes: ``0.5:0.05``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import read_bytes
from fuzzyq_bullet.learning import Schedule, Setup
from fuzzyq_bullet.reading.yaml_tree import read_tree
from fuzzyq_bullet.training.rewards import RewardSettings
from fuzzyq_bullet.wording import did_you_mean, shorten

MAX_BYTES = 100_000
"""Largest options file."""


@dataclass(frozen=True, slots=True)
class LearningOptions:
    """Learning settings that differ from the planner's own; None keeps its own.

    Attributes:
        rate: η of Eq. 20.
        trace: λ of Eq. 21.
        epsilon: ε, the chance of trying any action.
        discount: γ, or ξ.
        reward: What counts how much.
    """

    rate: Schedule | None = None
    trace: Schedule | None = None
    epsilon: Schedule | None = None
    discount: float | None = None
    reward: RewardSettings | None = None

    @classmethod
    def parse(cls, given: Mapping[str, str], where: str = "--") -> LearningOptions:
        """Read them from texts by name.

        Args:
            given: Such as ``{"trace": "0.9", "reward": "hit=50"}``.
            where: What stands before a name in messages.

        Raises:
            UserError: If one is wrong; names it.
        """
        return cls(**{name: _read(name, text, where) for name, text in given.items()})

    def changed_by(self, other: LearningOptions) -> LearningOptions:
        """Return these, but for what the other has."""
        return replace(self, **other.given())

    def given(self) -> dict[str, Any]:
        """Return those that differ from the planner's own, by name."""
        every: dict[str, Any] = {one.name: getattr(self, one.name) for one in fields(self)}
        return {name: one for name, one in every.items() if one is not None}

    def words(self) -> list[str]:
        """Return the options as words of a command line."""
        return [
            word for name, value in self.given().items() for word in (f"--{name}", _written(value))
        ]

    def setup(self, usual: Setup) -> Setup:
        """Return how to train: as usual, but for the schedules that are given."""
        asked = {"rate": self.rate, "trace_decay": self.trace, "exploration": self.epsilon}
        changed: dict[str, Any] = {name: one for name, one in asked.items() if one is not None}
        return replace(usual, **changed)


def read_options(path: Path) -> tuple[LearningOptions, dict[str, Any], dict[str, str]]:
    """Read an options file.

    Returns:
        The options; ``episodes``, ``drive`` and ``seed`` if it has them; and for each key where it
        stands, as messages begin.

    Raises:
        UserError: If it cannot be read or is wrong; one line with file, line and key.
    """
    known = [*_READERS, *_PLAIN]
    content = read_bytes(path, what="an options file", most=MAX_BYTES)
    text = content.decode("utf-8", "replace")
    if not text.strip():
        raise UserError(f"{path}: is empty; it may have the keys {', '.join(known)}")
    tree = read_tree(text, str(path))
    if not isinstance(tree.data, dict):
        raise UserError(
            f"{path}:{tree.line}: expected a mapping with any of the keys {', '.join(known)}, "
            f"got {shorten(tree.data)}"
        )
    options, plain, places = AS_USUAL, dict[str, Any](), dict[str, str]()
    for key, value in tree.data.items():
        where = f"{path}:{tree.line_of(key)}: {key}"
        if key in _PLAIN:
            if type(value) is not _PLAIN[key]:
                wanted = "text" if _PLAIN[key] is str else "a whole number"
                raise UserError(f"{where}: expected {wanted}, got {shorten(value)}")
            plain[key], places[key] = value, where
        elif key in _READERS:
            try:
                text = _as_text(value)
            except UserError as error:
                raise UserError(f"{where}: {error.problems[0]}") from error
            places[key] = where
            options = options.changed_by(
                LearningOptions.parse({key: text}, f"{path}:{tree.line_of(key)}: ")
            )
        else:
            raise UserError(
                f"{where}: unknown key; {did_you_mean(key, known)}allowed: {', '.join(known)}"
            )
    return options, plain, places


def _as_text(value: Any) -> str:
    """Return a value of YAML as the command line would have it.

    Raises:
        UserError: If it is none that could stand there.
    """
    numbers = value.values() if isinstance(value, dict) else value
    if isinstance(value, dict | list):
        if all(type(one) in (int, float) for one in numbers):
            pairs = [f"{key}={one!r}" for key, one in value.items()] if type(value) is dict else ()
            return ",".join(pairs) or ":".join(map(repr, value))
    elif type(value) in (int, float, str):
        return str(value)
    raise UserError(f"expected a number, text, or numbers in [ ] or {{ }}, got {shorten(value)}")


def _read(name: str, text: str, where: str) -> Any:
    try:
        return _READERS[name](text)
    except UserError as error:
        why = error.problems[0].removeprefix("reward: ")
        raise UserError(f"{where}{name}: {why}") from error


def _schedule(text: str) -> Schedule:
    try:
        numbers = [float(part) for part in text.split(":")]
    except ValueError:
        numbers = []
    if len(numbers) not in (1, 2) or not all(map(math.isfinite, numbers)):
        raise UserError(
            "expected a number from 0 to 1, or two with a colon as in 0.5:0.05, "
            f"got {shorten(text)}"
        )
    return Schedule(numbers[0], numbers[0] - numbers[-1])


def _discount(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 <= value <= 1.0:
        raise UserError(f"must be a number from 0 to 1, got {shorten(text)}")
    return value


def _written(value: Schedule | RewardSettings | float) -> str:
    if not isinstance(value, Schedule):
        return str(value)
    if not value.drop:
        return repr(value.start)
    end = value.start - value.drop
    # As it was written: 0.05 and not 0.04999999999999999, wherever both mean the same drop.
    ends = [round(end, digits) for digits in (6, 12, 15)]
    same = [one for one in ends if value.start - one == value.drop]
    return f"{value.start!r}:{(same or [end])[0]!r}"


AS_USUAL = LearningOptions()
_READERS: Mapping[str, Any] = {
    **dict.fromkeys(("rate", "trace", "epsilon"), _schedule),
    "discount": _discount,
    "reward": RewardSettings.parse,
}
_PLAIN: Mapping[str, type] = {"episodes": int, "drive": str, "seed": int}
