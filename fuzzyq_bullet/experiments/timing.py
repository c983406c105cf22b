"""Comparing the cost of two pieces of work so that a noisy machine cannot fake the answer."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Sequence
from statistics import median


def interleaved(
    works: Sequence[Callable[[], object]],
    rounds: int,
    clock: Callable[[], float] = time.process_time,
) -> list[list[float]]:
    """Time several pieces of work in turn, again and again.

    Args:
        works: What to time; each is called once a round.
        rounds: How often.
        clock: Processor time of this process by default; ``time.perf_counter`` where other
            processes do part of the work.

    Returns:
        For each piece of work, its times (s), one a round.
    """
    times: list[list[float]] = [[] for _ in works]
    for _ in range(rounds):
        for work, taken in zip(works, times, strict=True):
            gc.collect()
            start = clock()
            work()
            taken.append(clock() - start)
    return times


def median_ratio(over: Sequence[float], under: Sequence[float]) -> float:
    """Return the median of the ratios taken pair by pair within each round."""
    return median(a / b for a, b in zip(over, under, strict=True))
