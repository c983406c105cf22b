"""How often each planner reaches the goal, by obstacles (Fig. 13): ``fuzzyq bench success``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from typing import Any, ClassVar

from pydantic import Field

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.planning import PlannerSettings
from fuzzyq_bullet.studies.episodes import Row
from fuzzyq_bullet.studies.options import (
    GUARDED,
    PAPER,
    RULES_HELP,
    counts_of,
    described,
    one_drive_of,
    planners_of,
    rules_told,
)
from fuzzyq_bullet.studies.plan import FieldsPlan, limits_with
from fuzzyq_bullet.studies.registry import register_study
from fuzzyq_bullet.studies.study import (
    Findings,
    Picture,
    Results,
    Study,
    Table,
    Work,
    cell,
    numbers,
)
from fuzzyq_bullet.studies.success.table import (
    Line,
    Summary,
    by_planner,
    measures_of,
    solved_by_all,
    summary_of,
)

COUNTS = tuple(range(5, 130, 5))
"""Numbers of obstacles of Fig. 13."""
RUNS = 50
"""Tests at each of them, in the paper."""
HOW_FAILURES_COUNT = (
    "Success is the goal reached without touching anything; a collision, standing still, M_s "
    "decisions without the goal, and an error of the run itself are failures all the same."
)
HEADLINE = (25, 75, 125)
"""Numbers of obstacles of the first table of a page, where they were run."""
SIDE_BY_SIDE = 5
"""Most planners in one table."""
MOST_COLUMNS = 4


@register_study
class Success(Study):
    """Run the planners in the same random fields; print how often each reaches the goal.

    May be ended at any moment: the same command goes on where it was. Writes success.csv, a row for
    every episode, success.json and success.png. Fixed weights are the paper's 0.5/0.5.
    """

    name: ClassVar[str] = "success"
    title: ClassVar[str] = "Success by obstacles (Fig. 13)"
    width: ClassVar[int] = 110
    pictured: ClassVar[bool] = True
    filmed: ClassVar[bool] = True

    planners: str = Field(
        ",".join((*PAPER, *GUARDED)),
        description="Planners to compare, with commas between; q-learning-position and "
        "q-lambda-position learn every environment first, in ten seconds and more.",
    )
    counts: str = Field(
        numbers(COUNTS), description="Numbers of scattered obstacles; by default 5, 10, … 125."
    )
    runs: int = Field(RUNS, ge=1, le=100_000, description="Environments for every count.")
    drive: str = Field(
        "kinematic", description="wheels (physics), or kinematic (the paper's point robot)."
    )

    rules: str | None = Field(None, description=RULES_HELP)

    def planner_set(self) -> Mapping[str, PlannerSettings]:
        """Return those that are compared."""
        return planners_of(self.planners, self.rules)

    @classmethod
    def recalled(cls, plans: Mapping[str, Any]) -> Study | None:
        """Return the study whose plan this is."""
        study = super().recalled(plans)
        told = (rules_told(one) for one in plans[cls.name].planners.values())
        rules = next((one for one in told if one is not None), None)
        return None if study is None else study.model_copy(update={"rules": rules})

    def plan(self) -> FieldsPlan:
        """Return what is run."""
        counts = counts_of(self.counts, "--counts")
        if not counts:
            raise UserError("--counts: none leaves nothing to run")
        return FieldsPlan(
            sweep=self.name,
            planners=described(self.planner_set()),
            drive=one_drive_of(self.drive),
            counts=counts,
            runs=self.runs,
            seed=self.seed,
            limits=limits_with(one_drive_of(self.drive)),
        )

    def work(self) -> Work:
        """Return what does a job; some planners learn the environment first."""
        from fuzzyq_bullet.studies.positional import work_for_row

        return work_for_row

    def findings(self, results: Results) -> Findings:
        """Return success with its intervals, and what the runs that arrived have in common."""
        from fuzzyq_bullet.studies.success.picture import measures_picture, success_picture

        swept = results[self.name]
        plan: FieldsPlan = swept.plan
        rows = swept.rows
        summary = summary_of(rows)
        about = f"{plan.drive}; seed {plan.seed}; walled 10 × 10 m"
        title = f"Success by planner: {about}, {plan.runs} environments each"
        data = {"settings": dict(swept.settings), "failures": HOW_FAILURES_COUNT, **asdict(summary)}
        return Findings(
            tables=_tables(summary, about, plan.limits.steps),
            data=data,
            remarks=(*_ends(summary.total), *_claims(summary)),
            pictures=(
                Picture(
                    lambda: success_picture(summary, title),
                    f"Success of each planner by the number of obstacles, {plan.drive}. "
                    + "; ".join(_in_words(summary, name) for name in summary.planners),
                    "Fig. 13 with Wilson's 95 % intervals: above over all environments, below over "
                    "those that have a way. The tables hold the same figures.",
                ),
                Picture(
                    lambda: measures_picture(rows, f"Runs that reached the goal: {about}"),
                    "Driven over shortest path, time to the goal and least distance to anything of "
                    "each planner by the number of obstacles; the table has them over all.",
                    "Median and middle half over the runs that reached the goal. A planner that "
                    "only reaches the easy ones looks quick here.",
                ),
            ),
            headline=_headline(summary, plan.drive),
            details=_measures(rows),
        )


def _tables(summary: Summary, about: str, steps: int) -> tuple[Table, ...]:
    """Return success over all environments, and over those that have a way.

    A table has at most ``SIDE_BY_SIDE`` planners; more would not fit into a terminal.
    """
    captions = (
        f"Success over all environments, with Wilson's 95 % intervals. {about}. "
        f"{HOW_FAILURES_COUNT} M_s is {steps}.",
        "The same over the environments that have a way for a disc of radius 0.22 m (the robot's "
        "is 0.20).",
    )
    made = []
    for caption, whole in zip(captions, (True, False), strict=True):
        for first in range(0, len(summary.planners), SIDE_BY_SIDE):
            names = summary.planners[first : first + SIDE_BY_SIDE]
            rows = []
            for line in (*summary.lines, summary.total):
                runs = line.environments if whole else line.feasible
                shares = [line.cells[name] for name in names]
                told = [cell(one.all if whole else one.feasible) for one in shares]
                count = "all" if line.count is None else str(line.count)
                rows.append([count, str(runs), *told])
            columns = ("obstacles", "runs", *names)
            said = caption if first == 0 else "The same of the other planners."
            made.append(Table(said, columns, rows, left=(), total=True))
    return tuple(made)


def _headline(summary: Summary, drive: str) -> Table:
    """Return the table that says it in one look."""
    lines = {line.count: line for line in summary.lines}
    chosen = [lines[count] for count in _chosen(sorted(c for c in lines if c is not None))]
    rows = []
    for name in summary.planners:
        total = summary.total.cells[name]
        shares = [line.cells[name].all for line in chosen]
        rows.append([name, *map(cell, (*shares, total.all, total.feasible))])
    return Table(
        f"Share of environments in which the goal was reached, {drive}, by the number of "
        "obstacles, with Wilson's 95 % intervals. Last column: only where a disc of radius 0.22 m "
        "has a way.",
        ("planner", *(str(line.count) for line in chosen), "all", "all with a way"),
        rows,
    )


def _chosen(counts: Sequence[int]) -> list[int]:
    wanted = [count for count in HEADLINE if count in counts]
    if len(wanted) > 1 or len(counts) <= 1:
        return wanted or list(counts)
    places = {round(k * (len(counts) - 1) / (MOST_COLUMNS - 1)) for k in range(MOST_COLUMNS)}
    return [counts[place] for place in sorted(places)]


def _measures(rows: Sequence[Row]) -> tuple[Table, ...]:
    """Return how far, how long and how near: over all that arrived, and where all did."""
    columns = ("planner", "runs", "driven ÷ shortest", "time (s)", "clearance (m)", "least (m)")
    shared = solved_by_all(rows)

    def table(caption: str, common: bool) -> Table:
        lines = []
        for name, mine in by_planner(rows).items():
            one = measures_of(mine, shared if common else None)
            lines.append(
                [
                    name,
                    str(one.runs),
                    cell(one.path, ".2f"),
                    cell(one.time, ".1f"),
                    cell(one.clearance, ".3f"),
                    cell(one.least, ".3f"),
                ]
            )
        return Table(caption, columns, lines)

    whole = table(
        "Runs that reached the goal: median, and the middle half. Clearance is the least distance "
        "to anything in a run, least the least of any run.",
        False,
    )
    if len(by_planner(rows)) < 2 or not shared:
        return (whole,)
    caption = f"The same over the {len(shared)} environments that every planner solved."
    return whole, table(caption, True)


def _ends(total: Line) -> Iterable[str]:
    """Say how the episodes ended that did not end well."""
    for name, one in total.cells.items():
        failures = [f"{n} {kind}" for kind, n in one.outcomes.items() if kind != "goal"]
        yield f"{name}: {', '.join(failures) or 'no failures'} of {one.all.of}"


def _claims(summary: Summary) -> Iterable[str]:
    for claim in summary.claims:
        seen = "seen" if claim.reproduced else "NOT seen"
        yield f'The paper\'s order "{claim.what}": {seen} here.'


def _in_words(summary: Summary, name: str) -> str:
    ends = (summary.lines[0], summary.lines[-1])[: len(summary.lines)]
    told = [f"{line.cells[name].all.value:.2f} at {line.count}" for line in ends]
    return f"{name} {', '.join(told)}"
