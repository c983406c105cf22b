"""What planners came to in each kind of fields, as lines of a table. Arithmetic over rows."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean, median
from typing import TypeAlias

import numpy as np

from fuzzyq_bullet.studies.episodes import Place, Row
from fuzzyq_bullet.studies.field.plan import BOUND, Label
from fuzzyq_bullet.studies.statistics import Estimate, Share, ratio_of_means, share
from fuzzyq_bullet.studies.study import Table, cell

Score: TypeAlias = Callable[[Row], float | None]
"""The score of the literature of a run; None where there is none."""
Rows: TypeAlias = Mapping[Place, Row]
"""The rows of one planner in one kind of fields."""
FEWEST_PAIRS = 6
"""With fewer pairs no interval is given: five of five differences to the same side are chance in
6 % of cases, and a bootstrap of so few claims to know more."""


@dataclass(frozen=True)
class Summary:
    """One planner in one kind of fields. All means are over the runs that reached the goal.

    Attributes:
        kind: The kind.
        planner: Name of the planner.
        fields: Number of fields that it has driven through.
        success: Share of the feasible fields in which it reached the goal. If an error left it
            unknown whether a field is feasible, it counts.
        contacts: Runs in all fields that ended in a contact.
        at_fault: Contacts for which the robot was at fault.
        errors: Runs that an error ended.
        over_bound: Its time ÷ that of the bound, in the fields that both solved.
        path: Mean of driven ÷ shortest path.
        turning: Mean of the turning per metre (rad/m).
        jerk: Mean of |jerk| (m/s³).
        decision_ms: Median over all runs of their median time of a decision (ms).
        decision_p95_ms: Median over all runs of what 95 % of their decisions stay below (ms).
        score: Mean score over all runs that have one.
    """

    kind: str
    planner: str
    fields: int
    success: Share | None
    contacts: int
    at_fault: int
    errors: int
    over_bound: Estimate | None
    path: float | None
    turning: float | None
    jerk: float | None
    decision_ms: float | None
    decision_p95_ms: float | None
    score: float | None


def by_kind(rows: Iterable[Row], labels: Iterable[Label]) -> dict[str, dict[str, Rows]]:
    """Return rows by kind, planner and field, of the fields that every planner has driven through.

    Otherwise a planner would look better in an unfinished sweep that began with the easy fields.
    """
    by_label: dict[str, dict[Place, Row]] = {}
    for row in rows:
        by_label.setdefault(row.planner, {})[row.place] = row
    kinds: dict[str, dict[str, Rows]] = {}
    for label, planner, kind in labels:
        kinds.setdefault(kind, {})[planner] = by_label.get(label, {})
    return {
        kind: {
            planner: {place: met[place] for place in sorted(met) if place in shared}
            for planner, met in group.items()
        }
        for kind, group in kinds.items()
        if (shared := set.intersection(*(set(met) for met in group.values())))
    }


def summaries_of(kinds: Mapping[str, Mapping[str, Rows]], score: Score) -> list[Summary]:
    """Return the summary of each planner in each kind, in the order of the table."""
    return [
        _summary(kind, planner, met, group[BOUND], score)
        for kind, group in kinds.items()
        for planner, met in group.items()
    ]


def _summary(kind: str, planner: str, met: Rows, bound: Rows, score: Score) -> Summary:
    rows = list(met.values())
    feasible = [row for row in rows if row.feasible is not False]
    solved = [row for row in rows if row.success]
    hit = [row for row in rows if row.collisions]
    times = paired_figures(met, bound, lambda row: row.time_s)
    return Summary(
        kind=kind,
        planner=planner,
        fields=len(rows),
        success=share(sum(row.success for row in feasible), len(feasible)),
        contacts=len(hit),
        at_fault=sum(row.at_fault is not False for row in hit),
        errors=sum(row.error is not None for row in rows),
        over_bound=None if planner == BOUND else ratio_of_means(*times, np.random.default_rng(0)),
        path=_known(fmean, (row.path_ratio for row in solved)),
        turning=_known(fmean, (turning_of(row) for row in solved)),
        jerk=_known(fmean, (row.mean_jerk for row in solved)),
        decision_ms=_known(median, (row.decision_ms for row in rows)),
        decision_p95_ms=_known(median, (row.decision_p95_ms for row in rows)),
        score=_known(fmean, (score(row) for row in rows)),
    )


def paired_figures(
    ours: Rows, theirs: Rows, figure: Callable[[Row], float | None], *, solved: bool = True
) -> tuple[list[float], list[float]]:
    """Return a figure of both planners in the fields where both have it, and solved them."""
    pairs = [
        (one, two)
        for place, row in ours.items()
        if place in theirs
        and (not solved or (row.success and theirs[place].success))
        and (one := figure(row)) is not None
        and (two := figure(theirs[place])) is not None
    ]
    return [one for one, _ in pairs], [two for _, two in pairs]


def turning_of(row: Row) -> float | None:
    """Return the turning of a run per metre (rad/m); None where nothing was driven."""
    if row.turning_rad is None or not row.path_length_m:
        return None
    return row.turning_rad / row.path_length_m


def estimate_cell(one: Estimate | None, form: str) -> str:
    """Return an estimate as a cell; without its interval if there are too few pairs."""
    return cell(one if one is None or one.pairs >= FEWEST_PAIRS else one.value, form)


def _known(figure: Callable[[list[float]], float], values: Iterable[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return figure(known) if known else None


_COLUMNS: tuple[tuple[str, Callable[[Summary], str]], ...] = (
    ("planner", lambda line: line.planner),
    ("reached", lambda line: cell(line.success and f"{line.success.number} of {line.success.of}")),
    ("95 %", lambda line: cell(line.success and f"{line.success.low:.2f}–{line.success.high:.2f}")),
    ("contacts", lambda line: str(line.contacts)),
    ("at fault", lambda line: str(line.at_fault)),
    ("time ÷ bound", lambda line: estimate_cell(line.over_bound, ".2f")),
    ("path ratio", lambda line: cell(line.path, ".2f")),
    ("rad/m", lambda line: cell(line.turning, ".2f")),
    ("jerk m/s³", lambda line: cell(line.jerk, ".2f")),
    ("decision ms", lambda line: cell(line.decision_ms, ".1f")),
    ("p95 ms", lambda line: cell(line.decision_p95_ms, ".1f")),
    ("score", lambda line: cell(line.score, ".3f")),
)


def summary_table(lines: Sequence[Summary], about: str) -> Table:
    """Return the main table; without the score if no run has one."""
    columns = [one for one in _COLUMNS if one[0] != "score" or any(x.score for x in lines)]
    groups: dict[str, list[Summary]] = {}
    for line in lines:
        groups.setdefault(f"{line.kind}\n({line.fields})", []).append(line)
    rows = [
        [name, *("\n".join(text(line) for line in group) for _, text in columns)]
        for name, group in groups.items()
    ]
    scored = (
        "; score: success · OT / clip(time, 2·OT, 8·OT), at most 0.5, mean over all runs"
        if columns[-1][0] == "score"
        else ""
    )
    caption = (
        f"Planners in the same fields: {about}. {BOUND} is the bound: it knows the field, and "
        "drives the true shortest path under the same safety filter, with nothing moving and "
        "nothing disturbed.\n"
        "reached: of the fields that have a way, with Wilson's interval; contacts: in all fields; "
        "at fault: those for which the robot was. Of the runs that reached the goal: time over "
        f"that of the bound, in the fields that both solved [95 %, of {FEWEST_PAIRS} and more]; "
        "driven over shortest path; smoothness as changes of direction for each metre (rad/m), and "
        "as the mean of |jerk|. decision: processor time, its rays included: median, and what 95 % "
        f"stay below{scored}."
    )
    return Table(caption, ("fields", *(name for name, _ in columns)), rows, left=(0, 1))


def worlds_table(worlds: Mapping[str, Rows], score: Score) -> Table:
    """Return the scores in each world, by planner.

    Args:
        worlds: Rows by planner.
        score: The score of a run.
    """
    names = sorted({place[0] for met in worlds.values() for place in met})
    rows = [
        [
            name,
            *(
                cell(
                    _known(fmean, (score(row) for place, row in met.items() if place[0] == name)),
                    ".3f",
                )
                for met in worlds.values()
            ),
        ]
        for name in names
    ]
    caption = "Score of the literature in each world: mean over its runs; – where there is no way."
    return Table(caption, ("world", *worlds), rows)
