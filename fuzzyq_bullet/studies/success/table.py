"""From rows to what they say: shares of success; how long, how far and how near runs came.

Shares are over all environments and over those that have a way; the rest is about runs that reached
the goal.
Pure arithmetic; nothing is run or printed.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fuzzyq_bullet.studies.episodes import Place, Row
from fuzzyq_bullet.studies.options import in_order
from fuzzyq_bullet.studies.statistics import Share, share


@dataclass(frozen=True)
class Cell:
    """What one planner came to at one number of obstacles, or at all of them.

    Attributes:
        all: Share of all environments in which it reached the goal.
        feasible: Share of those that have a way; None where none has.
        outcomes: How often it ended in each of the ways that rows know.
    """

    all: Share
    feasible: Share | None
    outcomes: dict[str, int]


@dataclass(frozen=True)
class Line:
    """All planners at one number of obstacles.

    Attributes:
        count: How many; None for the line of all counts together.
        environments: How many different ones.
        feasible: Those among them that have a way for a disc of radius 0.22 m.
        cells: By planner.
    """

    count: int | None
    environments: int
    feasible: int
    cells: dict[str, Cell]


@dataclass(frozen=True)
class Claim:
    """An order that the paper reports, and whether it is seen here, over all counts together."""

    what: str
    reproduced: bool


@dataclass(frozen=True)
class Summary:
    """What the rows say.

    Attributes:
        planners: In the order in which they are shown.
        lines: One for each number of obstacles.
        total: All of them together.
        claims: The paper's orders, as far as their planners ran.
    """

    planners: tuple[str, ...]
    lines: tuple[Line, ...]
    total: Line
    claims: tuple[Claim, ...]


def summary_of(rows: Iterable[Row]) -> Summary:
    """Return what rows of one drive say.

    Args:
        rows: At least one, in any order; every planner has one for every environment.

    Raises:
        ValueError: If a planner has none for an environment that another has one for.
    """
    table = {name: {row.place: row for row in mine} for name, mine in by_planner(rows).items()}
    planners = tuple(table)
    places = set(table[planners[0]])
    if any(set(mine) != places for mine in table.values()):
        raise ValueError("not every planner has a row for every environment")
    # Where an error left it unknown to every planner it counts as a way: an error excuses nothing.
    closed = {
        place for mine in table.values() for place, row in mine.items() if row.feasible is False
    }
    counts = sorted({count for _, count, _ in places})
    lines = tuple(
        _line(count, table, [place for place in places if place[1] == count], closed)
        for count in counts
    )
    total = _line(None, table, places, closed)
    return Summary(planners, lines, total, _claims(total))


def _line(
    count: int | None,
    table: Mapping[str, Mapping[Place, Row]],
    places: Collection[Place],
    closed: set[Place],
) -> Line:
    cells = {}
    for name, mine in table.items():
        everywhere = share(sum(mine[place].success for place in places), len(places))
        assert everywhere is not None
        open_ = [place for place in places if place not in closed]
        cells[name] = Cell(
            all=everywhere,
            feasible=share(sum(mine[place].success for place in open_), len(open_)),
            outcomes=dict(sorted(Counter(mine[place].outcome for place in places).items())),
        )
    return Line(count, len(places), sum(place not in closed for place in places), cells)


def _claims(total: Line) -> tuple[Claim, ...]:
    rates = {name: cell.all.value for name, cell in total.cells.items()}
    if len(rates) < 2:
        return ()
    claims = []
    if "fuzzy" in rates:
        worst = all(rates["fuzzy"] < rate for name, rate in rates.items() if name != "fuzzy")
        claims.append(Claim("fuzzy has the lowest success rate", worst))
    ours = "fuzzy-q-lambda"
    if ours in rates:
        best = all(rates[ours] > rate for name, rate in rates.items() if name != ours)
        claims.append(Claim(f"{ours} has the highest success rate", best))
    return tuple(claims)


@dataclass(frozen=True)
class Quartiles:
    """Where the middle half of some figures lies: lower quartile, median, upper quartile."""

    low: float
    middle: float
    high: float

    def __format__(self, form: str) -> str:
        return f"{self.middle:{form}} [{self.low:{form}} – {self.high:{form}}]"


@dataclass(frozen=True)
class Measures:
    """What some runs that reached the goal came to; all are None without any.

    Attributes:
        runs: How many.
        path: Driven over shortest path.
        time: Simulated time to the goal (s).
        clearance: Least distance to anything in a run (m).
        least: The least of these (m).
    """

    runs: int
    path: Quartiles | None
    time: Quartiles | None
    clearance: Quartiles | None
    least: float | None


MEASURES: dict[str, Callable[[Measures], Quartiles | None]] = {
    "driven ÷ shortest path": lambda one: one.path,
    "time to the goal (s)": lambda one: one.time,
    "least distance to anything (m)": lambda one: one.clearance,
}
"""What is drawn, by what it is called."""


def measures_of(rows: Iterable[Row], places: Collection[Place] | None = None) -> Measures:
    """Return the figures of those runs that reached the goal.

    Args:
        rows: Rows of one planner.
        places: The environments to look at; None for all.
    """
    reached = [row for row in rows if row.success and (places is None or row.place in places)]
    near = [row.min_clearance_m for row in reached if row.min_clearance_m is not None]
    return Measures(
        runs=len(reached),
        path=_quartiles([row.path_ratio for row in reached if row.path_ratio is not None]),
        time=_quartiles([row.time_s for row in reached if row.time_s is not None]),
        clearance=_quartiles(near),
        least=min(near, default=None),
    )


def by_planner(rows: Iterable[Row]) -> dict[str, list[Row]]:
    """Return rows by planner, in the order in which planners are shown."""
    table: dict[str, list[Row]] = {}
    for row in rows:
        table.setdefault(row.planner, []).append(row)
    return {name: table[name] for name in in_order(list(table))}


def solved_by_all(rows: Iterable[Row]) -> set[Place]:
    """Return the environments in which every planner reached the goal."""
    table = [{row.place for row in mine if row.success} for mine in by_planner(rows).values()]
    return set.intersection(*table) if table else set()


def _quartiles(values: Sequence[float]) -> Quartiles | None:
    if not values:
        return None
    low, middle, high = np.quantile(np.asarray(values), (0.25, 0.5, 0.75)).tolist()
    return Quartiles(low, middle, high)
