"""What the project promises about its own speed, measured: ``fuzzyq bench speed``.

What is measured, how a noisy machine is kept from faking the answer, and how it is told.
"""

from __future__ import annotations

import gc
import json
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from statistics import median
from typing import Literal

from rich.table import Table

MEASUREMENTS = {
    "episodes": "fuzzyq_bullet.studies.speed.loop:episodes",
    "a large map": "fuzzyq_bullet.studies.speed.polygons:polygons",
    "the film": "fuzzyq_bullet.studies.speed.film:film",
    "a whole run": "fuzzyq_bullet.studies.speed.film:whole_run",
    "the controller": "fuzzyq_bullet.studies.speed.inference:controller",
}
"""Groups of figures, and the function that measures each, given the number of rounds and the
decisions a second: a list of ``Row``."""


@dataclass(frozen=True)
class Row:
    """One measured figure.

    Attributes:
        what: What was compared.
        figure: The figure; None where it could not be measured.
        aim: What it should be.
        sense: Whether the aim is a least or a most.
        detail: The absolute figures behind it.
    """

    what: str
    figure: float | None
    aim: float
    sense: Literal["at least", "at most"]
    detail: str

    @property
    def met(self) -> bool:
        """Whether the aim is met; what was not measured misses nothing."""
        if self.figure is None:
            return True
        return self.figure >= self.aim if self.sense == "at least" else self.figure <= self.aim


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


def as_table(rows: Sequence[Row]) -> Table:
    """Return the rows as a table for a terminal."""
    table = Table("compared", "measured", "aim", "", "in absolute terms, here and now", box=None)
    table.columns[1].justify = "right"
    for row in rows:
        figure = "not measured" if row.figure is None else f"{row.figure:.2f}"
        verdict = "" if row.figure is None else ("met" if row.met else "MISSED")
        table.add_row(row.what, figure, f"{row.sense} {row.aim:g}", verdict, row.detail)
    return table


def as_json(rows: Sequence[Row]) -> str:
    """Return the rows as JSON."""
    return json.dumps([{**asdict(row), "met": row.met} for row in rows], indent=2)
