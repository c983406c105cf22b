"""Paired estimates with 95 % intervals. Pure arithmetic over numbers of the same environments.

What has a distribution of its own making (times, paths) is resampled: the percentile bootstrap over
environments, so that pairs stay pairs. Shares are another matter: where no run failed, no resample
does either, and the bootstrap would claim to be certain. They get an exact interval instead.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]

LEVEL = 0.95
RESAMPLES = 10_000
_AT_ONCE = 500


@dataclass(frozen=True)
class Estimate:
    """A figure and how far it may be off.

    Attributes:
        value: The figure.
        low: Lower end of the interval, at most ``value``.
        high: Upper end, at least ``value``.
        pairs: Environments that it is made of.
    """

    value: float
    low: float
    high: float
    pairs: int


def ratio_of_means(
    ours: Sequence[float], theirs: Sequence[float], rng: np.random.Generator
) -> Estimate | None:
    """Return mean(ours) / mean(theirs); None without pairs, or where theirs is 0.

    With the two exchanged and the generator in the same state, everything is the reciprocal.

    Args:
        ours: One number for each environment, at least 0.
        theirs: The same environments in the same order.
        rng: Draws the resamples.
    """
    if not ours or not all(theirs):
        return None
    return _resampled(ours, theirs, rng, lambda one, two: one.mean(-1) / two.mean(-1))


def median_of_ratios(
    ours: Sequence[float], theirs: Sequence[float], rng: np.random.Generator
) -> Estimate | None:
    """Return the median of ours / theirs; arguments as for ``ratio_of_means``."""
    if not ours or not all(theirs):
        return None
    return _resampled(ours, theirs, rng, lambda one, two: np.median(one / two, axis=-1))


def mean_of_differences(
    ours: Sequence[float], theirs: Sequence[float], rng: np.random.Generator
) -> Estimate | None:
    """Return the mean of ours − theirs, in their unit; arguments as for ``ratio_of_means``."""
    if not ours:
        return None
    return _resampled(ours, theirs, rng, lambda one, two: (one - two).mean(-1))


def difference_of_shares(ours: Sequence[bool], theirs: Sequence[bool]) -> Estimate | None:
    """Return how much larger the share of true ones is in ours; None without pairs.

    The difference is the share of environments in which only ours is true, less that in which only
    theirs is. Each of the two gets a Clopper-Pearson interval of 97.5 %, so both hold together in
    at least 95 % of cases, and so does the difference of their ends. It is wider than it need be,
    and never narrower.

    Args:
        ours: One for each environment.
        theirs: The same environments in the same order.
    """
    pairs = len(ours)
    if not pairs:
        return None
    gained = sum(one and not two for one, two in zip(ours, theirs, strict=True))
    lost = sum(two and not one for one, two in zip(ours, theirs, strict=True))
    gain, loss = (_clopper_pearson(number, pairs, (1.0 + LEVEL) / 2) for number in (gained, lost))
    return Estimate((gained - lost) / pairs, gain[0] - loss[1], gain[1] - loss[0], pairs)


def _clopper_pearson(number: int, pairs: int, level: float) -> tuple[float, float]:
    """Return the exact interval of a share of which ``number`` among ``pairs`` were seen."""
    from scipy.special import betaincinv  # scipy.stats would take two seconds to load

    rare = (1.0 - level) / 2
    low = betaincinv(number, pairs - number + 1, rare) if number else 0.0
    high = betaincinv(number + 1, pairs - number, 1.0 - rare) if number < pairs else 1.0
    return float(low), float(high)


def _resampled(
    ours: Sequence[float],
    theirs: Sequence[float],
    rng: np.random.Generator,
    figure: Callable[[Floats, Floats], Floats],
) -> Estimate:
    one, two = np.asarray(ours, dtype=np.float64), np.asarray(theirs, dtype=np.float64)
    if one.shape != two.shape:
        raise ValueError(f"pairs of {one.size} and {two.size} numbers")
    value = float(figure(one, two))
    parts = []
    for _ in range(RESAMPLES // _AT_ONCE):  # all at once would take gigabytes for many pairs
        drawn = rng.integers(one.size, size=(_AT_ONCE, one.size))
        parts.append(figure(one[drawn], two[drawn]))
    seen = np.sort(np.concatenate(parts))
    cut = int((1.0 - LEVEL) / 2 * (RESAMPLES - 1))
    # As many are cut off above as below. Where all resamples agree, rounding alone may set the
    # figure apart from them.
    low, high = float(seen[cut]), float(seen[-1 - cut])
    return Estimate(value, min(low, value), max(high, value), one.size)
