"""The command line as people call it, and a run that takes no time."""

from __future__ import annotations

import contextlib
import subprocess
from collections.abc import Callable, Iterator, Sequence
from typing import Any, TypeAlias

import pytest

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.workers import Answer, WorkerPool
from tests.helpers.forking import FUZZYQ

__all__ = ["FUZZYQ", "SHORT", "Call", "Here", "no_workers"]

Call: TypeAlias = Callable[..., "subprocess.CompletedProcess[str]"]

SHORT = """\
name: short
arena: {size: [3.0, 2.0]}
start: {position: [0.6, 0.6]}
goal: {position: [1.4, 0.7]}
obstacles:
  - {shape: cylinder, position: [2.3, 1.4], radius: 0.2}
  - {shape: box, position: [1.2, 1.5], size: [0.3, 0.2], yaw: 0.4}
"""


class Here:
    """A pool that does all work in this process, one order after the other."""

    def run(
        self, function: Callable[[Any], Any], arguments: Sequence[Any], **_: object
    ) -> Iterator[tuple[int, Answer]]:
        for i, argument in enumerate(arguments):
            try:
                answer = Answer(function(argument))
            except UserError as error:
                answer = Answer(failed=error.problems)
            yield i, answer


@contextlib.contextmanager
def no_workers() -> Iterator[None]:
    """Let commands do in this process what workers are for."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(WorkerPool, "run", Here.run)
        yield
