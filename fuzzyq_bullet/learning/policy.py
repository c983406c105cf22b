"""Policies: what was learned, as a plain file that says how it was made; and what may be in one.

JSON with sorted keys and a line for each state. Numbers are written so that they read back as the
very same, so the same training gives the same bytes.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias

import numpy as np
from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    StringConstraints,
    ValidationError,
    model_validator,
)

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import write_text
from fuzzyq_bullet.learning.checkpoint import LARGEST
from fuzzyq_bullet.learning.learners import Floats
from fuzzyq_bullet.reading.kinds import POLICY, refuse_other_kind
from fuzzyq_bullet.reading.untrusted import read_object, shown

FORMAT = 1
MAX_BYTES = 4_000_000
"""Greatest size of a policy file. 64 states and 25 actions take 0.03 MB."""
MAX_STATES = 50_000
MAX_ACTIONS = 1_000
MAX_PARAMETERS = 200
MAX_NAME = 100
MAX_WORDS = 2_000


def _text(value: Any) -> Any:
    # A path on a command line may hold bytes that are no text; they must not spoil the file.
    return value.encode("utf-8", "backslashreplace").decode() if isinstance(value, str) else value


# Checked by hand, for hostile files: pydantic would make an error of each of a million wrong items.
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


class Policy(BaseModel):
    """A table of values, and how it was made.

    Attributes:
        format: Of the file; other formats are refused.
        planner: Name of the planner that it was trained for.
        learner: What learned it: ``q-learning``, ``q-lambda``, or ``fuzzy-q-lambda``, whose rows
            are rules and not states.
        command: What to type to make it again.
        seed: Seed of the training.
        version: Version of fuzzyq_bullet.
        drive: Drive that it was trained in.
        scenario: Digest of what it was trained on.
        episodes: How many it was trained for.
        parameters: Everything else that the training was given, by name.
        states: What each row means, S names.
        actions: What each column means, A names.
        table: Q, S rows of A values.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    format: Literal[1] = 1
    planner: Name
    learner: Name
    command: Words
    seed: Whole
    version: Name
    drive: Name
    scenario: Words
    episodes: Whole
    parameters: Parameters
    states: States
    actions: Actions
    table: Rows

    @model_validator(mode="after")
    def _fits(self) -> Policy:
        if len(self.table) != len(self.states):
            raise ValueError(f"table: {len(self.table)} rows for {len(self.states)} states")
        for i, row in enumerate(self.table):
            if len(row) != len(self.actions):
                raise ValueError(
                    f"table: row {i} has {len(row)} values for {len(self.actions)} actions"
                )
        return self

    def array(self) -> Floats:
        """Return the table as an array, shape (S, A)."""
        return np.array(self.table)

    def dumps(self) -> str:
        """Return the text of its file: the same policy always gives the same."""
        data = self.model_dump()
        lines = []
        for key in sorted(data):
            text = _json(data[key])
            if key == "table":
                text = "[\n  " + ",\n  ".join(_json(row) for row in self.table) + "\n ]"
            lines.append(f" {_json(key)}: {text}")
        return "{\n" + ",\n".join(lines) + "\n}\n"

    def save(self, path: Path | str) -> None:
        """Write it whole or not at all.

        Raises:
            UserError: If it cannot be written, or is too large for a policy file.
        """
        text = self.dumps()
        if len(text.encode()) > MAX_BYTES:
            raise UserError(f"{path}: too large; a policy has at most {MAX_BYTES} bytes")
        write_text(Path(path), text)


def hash_of(policy: Policy) -> str:
    """Return what identifies the contents of a policy."""
    return hashlib.sha256(policy.dumps().encode()).hexdigest()[:32]


@dataclass(frozen=True, slots=True)
class PolicySpec:
    """What a planner requires of a policy.

    Attributes:
        planner: The planner's name.
        learner: How the table is to be read; None if any will do.
        states: What each row must mean.
        actions: What each column must mean.
    """

    planner: str
    states: Sequence[str]
    actions: Sequence[str]
    learner: str | None = None

    @property
    def shape(self) -> tuple[int, int]:
        """Number of states and of actions."""
        return len(self.states), len(self.actions)

    def check(self, policy: Policy, where: str) -> None:
        """Check that a policy fits.

        Args:
            policy: The policy.
            where: What to call it in the message, usually its path.

        Raises:
            UserError: If it does not; the message is one line.
        """
        if policy.planner != self.planner:
            raise UserError(
                f"{where}: is a policy of the planner {shown(policy.planner)}; "
                f"one of {self.planner!r} is needed"
            )
        if self.learner is not None and policy.learner != self.learner:
            raise UserError(
                f"{where}: was learned by {shown(policy.learner)}; {self.planner} needs one that "
                f"was learned by {self.learner!r}"
            )
        for what, given, needed in (
            ("states", policy.states, self.states),
            ("actions", policy.actions, self.actions),
        ):
            if len(given) != len(needed):
                raise UserError(
                    f"{where}: has {len(given)} {what}; {self.planner} has {len(needed)}"
                )
            for i, (one, other) in enumerate(zip(given, needed, strict=True)):
                if one != other:
                    raise UserError(
                        f"{where}: {what}: number {i} is {shown(one)}; "
                        f"that of {self.planner} is {shown(other)}"
                    )


def load_policy(path: Path | str, expect: PolicySpec | None = None) -> Policy:
    """Read a policy from a file.

    Args:
        path: The file.
        expect: What the planner that wants to use it needs.

    Raises:
        UserError: If it cannot be read, is wrong, or does not fit; one line that says what is
            right.
    """
    data = read_object(Path(path), what="a policy", most=MAX_BYTES)
    refuse_other_kind(str(path), data, POLICY)
    if "format" not in data:
        raise UserError(f"{path}: is not a policy: it has no format; fuzzyq train writes policies")
    form = data["format"]
    if form != FORMAT or isinstance(form, bool):
        raise UserError(
            f"{path}: format: is {shown(form)}; this version reads policies of format {FORMAT}"
        )
    unknown = sorted(data.keys() - Policy.model_fields.keys())
    if unknown:
        raise UserError(
            f"{path}: {shown(unknown[0])}: unknown key; a policy has "
            f"{', '.join(sorted(Policy.model_fields))}"
        )
    try:
        policy = Policy.model_validate(data)
    except ValidationError as error:
        first = error.errors(include_url=False, include_context=False)[0]
        place = ".".join(ascii(part).strip("'")[:60] for part in first["loc"])
        message = first["msg"].removeprefix("Value error, ")
        raise UserError(f"{path}: {place}: {message}" if place else f"{path}: {message}") from error
    if expect is not None:
        expect.check(policy, str(path))
    return policy


def _json(value: Any) -> str:
    return json.dumps(value, sort_keys=True, ensure_ascii=False, allow_nan=False)
