"""Policies: what was learned, as a plain file that says how it was made.

JSON with sorted keys and a line for each state. Numbers are written so that they read back as the
very same, so the same training gives the same bytes.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, ValidationError, model_validator

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import write_text
from fuzzyq_bullet.learning.plain_json import read_object, shown
from fuzzyq_bullet.learning.policy_fields import (
    Actions,
    Name,
    Parameters,
    Rows,
    States,
    Whole,
    Words,
)

if TYPE_CHECKING:
    from fuzzyq_bullet.learning.expected import Expected
    from fuzzyq_bullet.learning.tabular import Floats

FORMAT = 1
MAX_BYTES = 4_000_000
"""Largest policy file: 64 states and 25 actions take 0.03 MB, 10 000 and 8 take 1.6 MB."""


class Policy(BaseModel):
    """A table of values, and how it was made.

    Attributes:
        format: Of the file; other formats are refused.
        planner: Name of the planner that it was trained for.
        learner: What learned it: ``q-learning``, ``q-lambda`` or ``linear-q-lambda``. The rows of
            the last are the weights of features, and its ``states`` name those.
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


def load_policy(path: Path | str, expect: Expected | None = None) -> Policy:
    """Read a policy from a file.

    Args:
        path: The file.
        expect: What the planner that wants to use it needs.

    Raises:
        UserError: If it cannot be read, is wrong, or does not fit; one line that says what is
            right.
    """
    data = read_object(Path(path), what="a policy", most=MAX_BYTES)
    form = data.get("format")
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
