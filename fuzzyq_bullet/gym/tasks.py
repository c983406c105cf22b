"""What an episode of an environment is about: one scenario, or a random task for each."""

from __future__ import annotations

import os
from typing import TypeAlias

import numpy as np

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.ground_truth import feasible
from fuzzyq_bullet.scenario import (
    Scenario,
    check,
    load_scenario,
    random_task,
    realise,
    with_options,
)
from fuzzyq_bullet.scenario.fields import refuse_via
from fuzzyq_bullet.training.tasks import FIRST_SEED, ROOM

Count: TypeAlias = "int | tuple[int, int]"
Source: TypeAlias = "Scenario | str | os.PathLike[str] | None"

DEFAULT_COUNT = 50
MOST_OBSTACLES = 150
"""With so many, three random tasks in four still have a way; with 200 one in fifteen."""
TRIES = 100
"""Tasks that are drawn in search of one with a way."""


class TaskSource:
    """Gives each episode its scenario.

    Args:
        scenario: Always this one, or the file or bundled scenario of that name; what it asks to be
            ``random`` is drawn anew for each episode. None for random tasks.
        count: Scattered obstacles of a random task; a pair is a range, both ends included.
        drive: What moves the robot, whatever the scenario says.

    Raises:
        UserError: If one of them is not allowed, or the scenario cannot be run.
    """

    def __init__(self, *, scenario: Source, count: Count, drive: str) -> None:
        self._low, self._high = _range(count)
        self._drive = drive
        self._fixed = None
        if scenario is None:
            with_options(random_task(0), drive=drive)  # says what is wrong with the drive
            return
        if count != DEFAULT_COUNT:
            raise UserError("count: is for random tasks; a scenario has its own obstacles")
        if not isinstance(scenario, (Scenario, str, os.PathLike)):
            kind = type(scenario).__name__
            raise UserError(f"scenario: must be a Scenario, a path or a name, got {kind}")
        given = (
            scenario if isinstance(scenario, Scenario) else load_scenario(scenario, policies=False)
        )
        check(given)
        refuse_via(given, "the reward of an environment knows the way to the goal alone")
        self._fixed = with_options(given, drive=drive)

    def draw(self, rng: np.random.Generator) -> Scenario:
        """Return a scenario with every obstacle in its place.

        Where anything is drawn, there is a way for the robot with the margin of its detection
        lines, and the scenario's seed is one that no sweep uses.

        Raises:
            UserError: If none of ``TRIES`` drawn worlds has a way.
        """
        if self._fixed is not None and self._fixed.random is None:
            return realise(self._fixed)
        for _ in range(TRIES):
            scenario = realise(self._asked(rng))
            if feasible(scenario, ROOM):
                return scenario
        raise UserError(f"{scenario.name}: none of {TRIES} worlds drawn has a way to the goal")

    def _asked(self, rng: np.random.Generator) -> Scenario:
        count = int(rng.integers(self._low, self._high, endpoint=True))
        seed = int(rng.integers(FIRST_SEED, 2**63 - 1))
        if self._fixed is not None:
            return with_options(self._fixed, seed=seed)
        return with_options(random_task(seed, count=count), drive=self._drive)


def _range(count: Count) -> tuple[int, int]:
    """Return the least and the greatest number of obstacles.

    Raises:
        UserError: If it is no number or range of numbers within what is allowed.
    """
    pair = count if isinstance(count, tuple) else (count, count)
    whole = len(pair) == 2 and all(type(number) is int for number in pair)
    if not (whole and 0 <= pair[0] <= pair[1] <= MOST_OBSTACLES):
        raise UserError(
            f"count: must be a number from 0 to {MOST_OBSTACLES}, or a pair of two such with the "
            f"smaller first, got {count!r}"
        )
    return pair
