"""What every reader of a record relies on, beyond the shapes of its arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from fuzzyq_bullet.columns import FAR
from fuzzyq_bullet.scenario.problems import unknown_names

if TYPE_CHECKING:
    from fuzzyq_bullet.scenario.models import Scenario

LONGEST = 7200.0
"""Longest run that is read (s): twice the greatest limit of a scenario."""


class _Contact(Protocol):
    """What is checked of a collision; see ``Collision``."""

    @property
    def time(self) -> float: ...
    @property
    def point(self) -> tuple[float, float]: ...
    @property
    def obstacle(self) -> int: ...
    @property
    def normal_force(self) -> float: ...


def check_order(time: NDArray[np.float64], tick: NDArray[np.int64]) -> None:
    """Check that ticks and decisions follow each other.

    Args:
        time: Times of the ticks (s), shape (T,).
        tick: Index of the tick of each decision, shape (D,).

    Raises:
        ValueError: If a run cannot have left these numbers.
    """
    if not (np.diff(time) > 0).all():
        raise ValueError("ticks.time does not increase")
    if time[-1] - time[0] > LONGEST:
        raise ValueError(f"ticks.time spans more than {LONGEST:g} s")
    last = time.size - 1
    if tick.min() < 0 or tick.max() > last or (np.diff(tick) < 0).any():
        raise ValueError(f"decisions.tick does not run upwards within 0 to {last}")


def mistake_in_record(error: ValidationError) -> str:
    """Say what is wrong with the head of a record."""
    if names := " and ".join(unknown_names(error)):
        return f"made with {names}, not known here; --plugin FILE adds it"
    first = error.errors(include_url=False)[0]
    where = ".".join(str(part) for part in first["loc"])
    return f"damaged record: {where}: {first['msg']}"


def check_collision(collision: _Contact, scenario: Scenario) -> None:
    """Check what every reader of a collision relies on.

    Raises:
        ValueError: If a run cannot have left these numbers.
    """
    numbers = (collision.time, *collision.point, collision.normal_force)
    if not all(abs(number) < FAR for number in numbers):
        raise ValueError("collision holds a number that is not finite, or is absurd")
    if not -1 <= collision.obstacle < len(scenario.obstacles):
        raise ValueError(f"collision.obstacle: there is no obstacle {collision.obstacle}")
