"""From the rows of the study to what they say. Pure arithmetic; nothing is run or printed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean

import numpy as np

from fuzzyq_bullet.studies.episodes import Place, Row
from fuzzyq_bullet.studies.escape.table import by_family, family_name
from fuzzyq_bullet.studies.statistics import Estimate, ratio_of_means
from fuzzyq_bullet.studies.study import Table, Target, cell

FIRST = "first-run"
"""What rows call the planner in a field that it has never seen."""
ALL = "all"
"""What the table calls all environments together."""
MOST_OF_FIRST = 0.75
MOST_OF_EXITS = 1.15
MOST_OF_OWN = 1.05


@dataclass(frozen=True)
class Line:
    """How one of those that are compared drove in the environments of a family.

    Attributes:
        family: What the table calls it, with its count.
        who: What rows call it.
        feasible: Environments that have a way.
        found: In how many of them it reached the goal.
        lost: In how many it did not, although the first run did.
        collisions: In how many of all it touched anything, in any of its runs.
        time: Mean time to the goal (s); None without any.
        of_first: Its mean time over that of the first run, where both reached the goal.
        of_exits: The same over that of the planner which is told the true way on from all exits.
        worst: Greatest of its times over the first run's of the same environment.
    """

    family: str
    who: str
    feasible: int
    found: int
    lost: int
    collisions: int
    time: float | None
    of_first: Estimate | None
    of_exits: Estimate | None
    worst: float | None


def lines_of(rows: Iterable[Row], planners: Sequence[str]) -> list[Line]:
    """Return how each drove, by family, and in all environments together."""
    rows = list(rows)
    families = {family_name(*key): group for key, group in by_family(rows).items()}
    if len(families) > 1:
        families[ALL] = rows
    return [
        _line(family, who, {name: _of(group, name) for name in planners})
        for family, group in families.items()
        for who in planners
    ]


def targets_of(line: Line) -> list[Target]:
    """Return what is asked of a robot that has learned."""
    return [
        Target("mean time over the first run's", _value(line.of_first), MOST_OF_FIRST, "at most"),
        Target("mean time over true exits'", _value(line.of_exits), MOST_OF_EXITS, "at most"),
        Target("worst time over its own first run's", line.worst, MOST_OF_OWN, "at most"),
        Target("environments with a contact", line.collisions, 0, "exactly"),
        Target("environments that only the first run crossed", line.lost, 0, "exactly"),
    ]


def shown(lines: Sequence[Line], about: str) -> Table:
    """Return the table."""
    families = list(dict.fromkeys(line.family for line in lines))
    cells = []
    for family in families:
        some = [line for line in lines if line.family == family]
        columns = (
            [line.who for line in some],
            [f"{line.found} of {line.feasible}" for line in some],
            [str(line.collisions) for line in some],
            [cell(line.time, ".1f") for line in some],
            [cell(line.of_first, ".2f") for line in some],
            [cell(line.of_exits, ".2f") for line in some],
            [cell(line.worst, ".2f") for line in some],
        )
        cells.append([family, *("\n".join(column) for column in columns)])
    caption = (
        f"Crossing the same field again. {about} learned-N: the fastest of N runs of a robot that "
        "learns; kept-map-N: of one that keeps its map instead; true-exits: told how far it is to "
        "the goal from every exit; true-path: the true shortest path. time: mean (s); / first, "
        "/ exits: mean time over that of first-run and of true-exits, in the fields that both "
        "crossed [95 %]; worst: greatest time over that of the first run in the same field."
    )
    headings = ("obstacles", "who", "found", "hits", "time", "/ first", "/ exits", "worst")
    return Table(caption, headings, cells, (0, 1))


def _of(rows: Sequence[Row], name: str) -> dict[Place, Row]:
    return {row.place: row for row in rows if row.planner == name}


def _line(family: str, who: str, sets: Mapping[str, Mapping[Place, Row]]) -> Line:
    ours = sets[who]
    own = [row for row in ours.values() if row.feasible]
    times = [row.time_s for row in own if row.success and row.time_s is not None]
    pairs = _times(ours, sets[FIRST])
    return Line(
        family=family,
        who=who,
        feasible=len(own),
        found=sum(row.success for row in own),
        lost=sum(
            sets[FIRST][place].success and not row.success
            for place, row in ours.items()
            if place in sets[FIRST]
        ),
        collisions=sum(row.collisions or 0 for row in ours.values()),
        time=fmean(times) if times else None,
        of_first=None if who == FIRST else _ratio(pairs),
        of_exits=_ratio(_times(ours, sets["true-exits"])) if who != "true-exits" else None,
        worst=max((one / two for one, two in pairs), default=None) if who != FIRST else None,
    )


def _times(ours: Mapping[Place, Row], theirs: Mapping[Place, Row]) -> list[tuple[float, float]]:
    """Return both times (s) in each environment with a way that both crossed."""
    both = [(ours[place], theirs[place]) for place in sorted(ours) if place in theirs]
    return [
        (one.time_s, two.time_s)
        for one, two in both
        if one.feasible and one.success and two.success and one.time_s and two.time_s
    ]


def _ratio(pairs: Sequence[tuple[float, float]]) -> Estimate | None:
    return ratio_of_means(
        [one for one, _ in pairs], [two for _, two in pairs], np.random.default_rng(0)
    )


def _value(estimate: Estimate | None) -> float | None:
    return None if estimate is None else estimate.value
