"""A training after each episode: its learning curve, and the checkpoint to resume it from.

Eligibility traces end with their episode and random streams begin with it, so there is little to
keep: the table, the learning curve so far, and what the training was begun with.
"""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import written_beside
from fuzzyq_bullet.learning.learners import Floats
from fuzzyq_bullet.reading.untrusted import read_arrays

Plain: TypeAlias = "str | int | float | bool"
Curve: TypeAlias = NDArray[np.void]
"""The learning curve: a row an episode, with ``total``, ``steps`` and ``outcome``."""

ROW = np.dtype([("total", "<f8"), ("steps", "<i4"), ("outcome", "S16")])
FORMAT = 1
LARGEST = 1e9
"""Greatest value of a table. A training that gets beyond it diverges."""
WINDOW = 50
"""Number of episodes in a running mean."""
SUCCESS = b"goal"
"""The outcome of a successful episode."""


@dataclass(frozen=True, eq=False)
class Checkpoint:
    """The state of a training between two episodes.

    Attributes:
        plan: What the training was begun with. It can only be resumed with the same.
        table: What was learned, shape (S, A).
        curve: A row for each finished episode, of the type ``ROW``.
    """

    plan: Mapping[str, Plain]
    table: Floats
    curve: Curve

    def save(self, path: Path | str) -> None:
        """Write it whole or not at all, over the one before.

        Raises:
            UserError: If it cannot be written.
        """
        head = json.dumps({"format": FORMAT, "plan": dict(self.plan)}).encode()
        content = io.BytesIO()
        np.savez(content, head=np.frombuffer(head, np.uint8), table=self.table, curve=self.curve)
        with written_beside(Path(path)) as part:
            part.write_bytes(content.getvalue())

    @classmethod
    def find(cls, path: Path) -> Checkpoint | None:
        """Read one written by ``save``, if there is one.

        Raises:
            UserError: If there is something that cannot be read, is damaged or no checkpoint.
        """
        try:
            if not path.exists():
                return None
        except OSError as error:  # a folder that may not be entered, a name too long
            raise UserError(f"{path}: cannot be read: {error.strerror or error}") from error
        return cls.load(path)

    @classmethod
    def load(cls, path: Path) -> Checkpoint:
        """Read one written by ``save``.

        Raises:
            UserError: If it cannot be read, is damaged or none at all.
        """
        arrays = read_arrays(path)
        try:
            head = json.loads(arrays["head"].tobytes().decode())
            form, plan = head["format"], head["plan"]
            table, curve = arrays["table"], arrays["curve"]
        except (KeyError, TypeError, ValueError, RecursionError) as error:
            raise UserError(f"{path}: not the checkpoint of a training") from error
        if form != FORMAT:
            shown = repr(form)[:20]
            raise UserError(f"{path}: a checkpoint of format {shown}; this version reads {FORMAT}")
        if not isinstance(plan, dict) or table.dtype != np.float64 or curve.dtype != ROW:
            raise UserError(f"{path}: not the checkpoint of a training, or damaged")
        if table.ndim != 2 or curve.ndim != 1 or not is_sound(table) or not _is_told(curve):
            raise UserError(f"{path}: damaged: its table or curve cannot be one of a training")
        return cls(plan, table, curve)

    def check(self, path: Path, plan: Mapping[str, Plain], shape: tuple[int, ...]) -> None:
        """Check that this is the training to be resumed.

        Args:
            path: What to call it in messages.
            plan: What the training is to be resumed with.
            shape: Shape of the learner's table.

        Raises:
            UserError: If it was begun with anything else.
        """
        for key in sorted({*plan, *self.plan}):
            was, now = self.plan.get(key), plan.get(key)
            if was != now:
                raise UserError(
                    f"{path}: belongs to another training: {_shown(key)} was {_shown(was)} and is "
                    f"{_shown(now)} now; resume with what it was begun with, or begin anew"
                )
        if self.table.shape != shape:
            raise UserError(
                f"{path}: belongs to another training: its table is of shape {self.table.shape}, "
                f"that of the learner {shape}"
            )
        if len(self.curve) > int(plan.get("episodes", 0)):
            raise UserError(f"{path}: damaged: it holds more episodes than the training has")


def is_sound(table: NDArray[Any]) -> bool:
    """Return whether all values are finite and none is absurd."""
    return bool((np.abs(table) <= LARGEST).all())


def _is_told(curve: Curve) -> bool:
    """Return whether a training can have left this curve: its sums, steps and outcomes."""
    words = all(one.isascii() and one.decode().isprintable() for one in curve["outcome"])
    return words and is_sound(curve["total"]) and bool((curve["steps"] >= 0).all())


def _shown(value: Any) -> str:
    return "nothing" if value is None else ascii(value).strip("'")[:60]


def reached(curve: Curve) -> NDArray[np.bool_]:
    """Return which episodes reached the goal, shape (N,)."""
    return np.asarray(curve["outcome"] == SUCCESS)


def success(curve: Curve) -> float:
    """Return the share of episodes that reached the goal; NaN if there are no episodes."""
    return float(reached(curve).mean()) if len(curve) else float("nan")


def last_mean(values: NDArray[Any], window: int = WINDOW) -> Floats:
    """Return the running mean over the last ``window`` values, shape (N,).

    At the beginning, where there are fewer, it is the mean of those.
    """
    count = len(values)
    sums = np.concatenate([[0.0], np.cumsum(values, dtype=float)])
    last = np.arange(1, count + 1)
    first = np.maximum(last - window, 0)
    return np.asarray((sums[last] - sums[first]) / (last - first))
