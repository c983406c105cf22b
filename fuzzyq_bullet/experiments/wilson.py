"""Shares with Wilson's interval: sound also where all runs succeed, or none."""

from __future__ import annotations

import math
from dataclasses import dataclass

Z = 1.959963984540054
"""Quantile of the normal distribution that leaves 2.5 % above."""


@dataclass(frozen=True)
class Share:
    """A share of some runs, with its 95 % interval.

    Attributes:
        number: Runs that did.
        of: Runs in all, at least one.
        value: The share, 0 to 1.
        low: Lower end of the interval, at most ``value``.
        high: Upper end, at least ``value``.
    """

    number: int
    of: int
    value: float
    low: float
    high: float


def share(number: int, of: int) -> Share | None:
    """Return a share with Wilson's score interval; None of no runs at all.

    Raises:
        ValueError: If ``number`` is not from 0 to ``of``.
    """
    if not 0 <= number <= of:
        raise ValueError(f"{number} of {of} is no share")
    if of == 0:
        return None
    value = number / of
    weight = Z * Z / of
    middle = (value + weight / 2.0) / (1.0 + weight)
    half = math.sqrt(weight * (value * (1.0 - value) + weight / 4.0)) / (1.0 + weight)
    # At the ends rounding could set the figure a hair outside of its own interval.
    low = 0.0 if number == 0 else min(middle - half, value)
    high = 1.0 if number == of else max(middle + half, value)
    return Share(number, of, value, low, high)
