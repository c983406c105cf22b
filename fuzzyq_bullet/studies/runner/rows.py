"""One row of a sweep: what an episode came to, as a line of its CSV."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from fuzzyq_bullet.metrics import Result
from fuzzyq_bullet.scenario import Drive
from fuzzyq_bullet.studies.runner.jobs import Job, Key
from fuzzyq_bullet.trajectory import Outcome

_LONGEST = 300
_ADDRESS = re.compile(r"0x[0-9a-fA-F]+")


class Row(BaseModel):
    """What an episode came to. The columns of the CSV are the fields, in this order.

    Attributes:
        planner: What the sweep calls the planner.
        drive: ``wheels`` or ``kinematic``.
        count: Number of obstacles asked for; None for layouts without a count.
        run: Number of the environment.
        seed: Seed of the scenario.
        feasible: Whether there is a way for a disc of radius ``ROOM`` (``runner.sweep``); None
            where the environment could not be built.
        outcome: As in results, or ``error`` where the episode failed itself.
        steps: As in results; so are the following, all None after an error.
        time_s: Simulated time (s).
        path_length_m: Length of the driven path (m).
        shortest_path_m: Length of the shortest path (m); None where there is none.
        spl: Success weighted by path length; None where there is no way.
        min_clearance_m: Least distance to anything (m); None when there was nothing.
        collisions: 0 or 1.
        digest: Hash of the exact trajectory.
        layout: Name of the layout that drew the obstacles.
        error: What went wrong with the episode itself; None normally.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    planner: str
    drive: Drive
    count: int | None
    run: int
    seed: int
    feasible: bool | None
    outcome: Outcome | Literal["error"]
    steps: int | None = None
    time_s: float | None = None
    path_length_m: float | None = None
    shortest_path_m: float | None = None
    spl: float | None = None
    min_clearance_m: float | None = None
    collisions: int | None = None
    digest: str | None = None
    layout: str
    error: str | None = None

    @property
    def key(self) -> Key:
        """The key of its job."""
        count = -1 if self.count is None else self.count
        return self.planner, self.drive, self.layout, count, self.run

    @property
    def success(self) -> bool:
        """Whether the goal was reached."""
        return self.outcome == "goal"

    @classmethod
    def of(cls, job: Job, result: Result, feasible: bool) -> Row:
        """Return the row of an episode that ran to its end."""
        measured = result.model_dump(include=set(cls.model_fields) - {"planner", "drive", "seed"})
        return cls(**_asked(job), **measured, feasible=feasible)

    @classmethod
    def failed(cls, job: Job, error: str, feasible: bool | None = None) -> Row:
        """Return the row of an episode that itself went wrong.

        Args:
            job: What was asked for.
            error: What happened; kept as one line that does not change from run to run.
            feasible: Whether there is a way, if that is known.
        """
        line = _ADDRESS.sub("0x…", " ".join(error.split()))[:_LONGEST]
        return cls(**_asked(job), feasible=feasible, outcome="error", error=line)


def _asked(job: Job) -> dict[str, Any]:
    where = job.environment
    return {
        "planner": job.planner,
        "drive": job.drive,
        "count": where.count,
        "run": where.run,
        "seed": where.seed,
        "layout": where.layout,
    }


def as_csv(rows: Iterable[Row]) -> str:
    """Return rows as CSV, sorted by their keys: the same rows give the same bytes."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(Row.model_fields)
    for row in sorted(rows, key=lambda one: one.key):
        writer.writerow([_cell(value) for _, value in row])
    return text.getvalue()


def from_csv(text: str) -> list[Row]:
    """Return the rows of a CSV as ``as_csv`` writes it.

    Raises:
        ValueError: If it is none; says in which line, and what is wrong there.
    """
    reader = csv.reader(io.StringIO(text, newline=""), strict=True)
    names = list(Row.model_fields)
    rows: dict[Key, Row] = {}
    try:
        if next(reader, None) != names:
            raise ValueError(f"must have the columns {','.join(names)}")
        for cells in reader:
            if len(cells) != len(names):
                raise ValueError(f"{len(cells)} columns instead of {len(names)}")
            given = {name: cell or None for name, cell in zip(names, cells, strict=True)}
            row = Row.model_validate(given)
            if row.key in rows:
                raise ValueError("an episode that another line has already")
            rows[row.key] = row
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = ".".join(map(str, first["loc"]))
        raise ValueError(f"line {reader.line_num}: {where}: {first['msg']}") from error
    except (ValueError, csv.Error) as error:
        raise ValueError(f"line {max(reader.line_num, 1)}: {error}") from error
    return list(rows.values())


def _cell(value: object) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(value) if isinstance(value, float) else str(value)
