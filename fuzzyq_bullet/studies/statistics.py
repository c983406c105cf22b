"""Shares and paired estimates with 95 % intervals. Pure arithmetic over rows and numbers.

What has a distribution of its own making (times, paths) is resampled: the percentile bootstrap over
environments, so that pairs stay pairs. Shares are another matter: where no run failed, no resample
does either, and the bootstrap would claim to be certain. They get intervals of the binomial
distribution: Wilson's, which is sound also where all runs succeed or none, and the exact one of
Clopper and Pearson where a difference must never look too certain.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.studies.episodes import Row

Floats: TypeAlias = NDArray[np.float64]
ByPlanner: TypeAlias = Mapping[str, Mapping[int, Row]]
"""Rows by planner and number of the environment."""

LEVEL = 0.95
RESAMPLES = 10_000
_AT_ONCE = 500


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

    def __str__(self) -> str:
        return f"{self.value:.2f} [{self.low:.2f}, {self.high:.2f}]"


def share(number: int, of: int) -> Share | None:
    """Return a share with Wilson's score interval; None of no runs at all.

    Raises:
        ValueError: If ``number`` is not from 0 to ``of``.
    """
    if not 0 <= number <= of:
        raise ValueError(f"{number} of {of} is no share")
    if of == 0:
        return None
    low, high = _interval(number, of, LEVEL, "wilson")
    value = number / of
    # Rounding could set the figure a hair outside of its own interval.
    return Share(number, of, value, min(low, value), max(high, value))


def runs_to_be_sure(rate: float) -> int:
    """Return how many runs that all succeed lift the lower end of their interval to a share.

    That end is n / (n + z²) for n of n runs, z the normal distribution's quantile (Wilson, 1927).

    Args:
        rate: The share, 0 to less than 1.
    """
    from scipy.stats import norm  # takes two seconds to load

    z = float(norm.ppf((1.0 + LEVEL) / 2))
    return math.ceil(z * z * rate / (1.0 - rate))


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

    def __format__(self, form: str) -> str:
        return f"{self.value:{form}} [{self.low:{form}}, {self.high:{form}}]"

    def times(self, factor: float) -> Estimate:
        """Return it in another unit, a positive ``factor`` smaller."""
        return Estimate(factor * self.value, factor * self.low, factor * self.high, self.pairs)


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
    gain, loss = (_interval(number, pairs, (1.0 + LEVEL) / 2, "exact") for number in (gained, lost))
    return Estimate((gained - lost) / pairs, gain[0] - loss[1], gain[1] - loss[0], pairs)


def _interval(
    number: int, of: int, level: float, method: Literal["wilson", "exact"]
) -> tuple[float, float]:
    """Return the interval of a share of which ``number`` among ``of`` were seen."""
    from scipy.stats import binomtest  # takes two seconds to load

    found = binomtest(number, of).proportion_ci(level, method=method)
    return float(found.low), float(found.high)


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


def by_planner(rows: Iterable[Row]) -> ByPlanner:
    """Return rows by what they call the planner, then by the number of the environment.

    Raises:
        ValueError: If two rows are of the same planner and number.
    """
    table: dict[str, dict[int, Row]] = {}
    for row in rows:
        mine = table.setdefault(row.planner, {})
        if row.run in mine:
            raise ValueError(f"{row.planner} has two rows for environment {row.run}")
        mine[row.run] = row
    return table


def feasible_runs(table: ByPlanner) -> set[int]:
    """Return the environments that have a way.

    Where an error left that unknown to every planner it counts as one: an error excuses nothing.
    """
    rows = [row for mine in table.values() for row in mine.values()]
    closed = {row.run for row in rows if row.feasible is False}
    return {row.run for row in rows} - closed


def solved_by_all(table: ByPlanner, planners: Collection[str]) -> list[int]:
    """Return the feasible environments in which each of the planners reached the goal, sorted."""
    feasible = feasible_runs(table)
    return sorted(
        run
        for run in feasible
        if all(run in table[name] and table[name][run].success for name in planners)
    )
