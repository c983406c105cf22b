"""From rows to shares: success over all environments and over those that have a way.

Pure arithmetic; nothing is run or printed.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from fuzzyq_bullet.studies.planner_sets import in_order
from fuzzyq_bullet.studies.runner.rows import Row
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
    """An order that the paper reports.

    Attributes:
        what: It, in words.
        reproduced: Whether it is seen here too, over all counts together.
    """

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
    table: dict[str, dict[tuple[int, int], Row]] = {}
    for row in rows:
        table.setdefault(row.planner, {})[row.count or 0, row.run] = row
    planners = in_order(list(table))
    places = set(table[planners[0]])
    if any(set(mine) != places for mine in table.values()):
        raise ValueError("not every planner has a row for every environment")
    # Where an error left it unknown to every planner it counts as a way: an error excuses nothing.
    closed = {
        place for mine in table.values() for place, row in mine.items() if row.feasible is False
    }
    counts = sorted({count for count, _ in places})
    lines = tuple(
        _line(count, table, planners, [one for one in sorted(places) if one[0] == count], closed)
        for count in counts
    )
    total = _line(None, table, planners, sorted(places), closed)
    return Summary(planners, lines, total, _claims(total))


def _line(
    count: int | None,
    table: dict[str, dict[tuple[int, int], Row]],
    planners: Sequence[str],
    places: Sequence[tuple[int, int]],
    closed: set[tuple[int, int]],
) -> Line:
    cells = {}
    for name in planners:
        mine = table[name]
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
