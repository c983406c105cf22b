"""A whole sweep: what is left of its jobs is done, every row kept at once, sorted at the end."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from fuzzyq_bullet.experiments.sweep.episode import run_job
from fuzzyq_bullet.experiments.sweep.folder import Folder
from fuzzyq_bullet.experiments.sweep.jobs import Job
from fuzzyq_bullet.experiments.sweep.journal import Journal
from fuzzyq_bullet.experiments.sweep.rows import Row, as_csv
from fuzzyq_bullet.experiments.sweep.workers import Pool, Work, finished
from fuzzyq_bullet.files import write_text

Progress: TypeAlias = Callable[["State"], None]
"""Called at the start and after every row."""


@dataclass
class State:
    """How far a sweep is.

    Attributes:
        total: Its jobs.
        done: Those that have a row, at whatever time.
        ran: Those of them that ran since the sweep was started, for this time.
        seconds: For how long it has been running (s), for this time.
        feasible: Rows of environments that have a way.
        successes: Those of them that reached the goal.
    """

    total: int
    done: int = 0
    ran: int = 0
    seconds: float = 0.0
    feasible: int = 0
    successes: int = 0

    @property
    def rate(self) -> float:
        """Episodes per second, by the clock on the wall; 0 before the first."""
        return self.ran / self.seconds if self.seconds > 0.0 else 0.0

    def count(self, row: Row) -> None:
        """Count a row."""
        self.done += 1
        if row.feasible:
            self.feasible += 1
            self.successes += row.success


@dataclass(frozen=True)
class Sweep:
    """A finished sweep.

    Attributes:
        rows: All rows, sorted by key.
        table: The CSV that holds them.
        state: How it went.
    """

    rows: tuple[Row, ...]
    table: Path
    state: State


def sweep(
    name: str,
    jobs: Sequence[Job],
    out: Path,
    settings: Mapping[str, Any],
    *,
    pool: Pool | None = None,
    work: Work = run_job,
    progress: Progress | None = None,
) -> Sweep:
    """Run all jobs that have no row in the folder yet, and write ``NAME.csv``.

    It may be ended at any moment, by whatever, and called again: it goes on, and the table is the
    same byte for byte, however many workers there are.

    Args:
        name: What to call the table.
        jobs: All jobs of the sweep, with different keys.
        out: Its folder, created if need be.
        settings: All that the rows depend on, as JSON can say it: what makes this sweep another.
        pool: Who does the work; by default one process for every core.
        work: Turns a job into its row, in a worker.
        progress: Told how far it is.

    Raises:
        UserError: If the folder holds a sweep with other settings, another process is at work in
            it, or it cannot be written to.
        ValueError: If two jobs have the same key.
    """
    by_key = {job.key: job for job in jobs}
    if len(by_key) < len(jobs):
        raise ValueError("two jobs of the sweep have the same key")
    folder = Folder(out)
    folder.claim(settings)
    tell = progress or (lambda state: None)
    with Journal(folder.journal) as journal:
        folder.tidy()
        rows = {row.key: row for row in journal.rows if row.key in by_key}
        state = State(len(jobs))
        for row in rows.values():
            state.count(row)
        tell(state)
        left = [job for key, job in by_key.items() if key not in rows]
        began = time.monotonic()
        with closing(finished(left, work, pool or Pool())) as results:
            for done in results:
                row = done.row
                if done.record is not None:  # first: a row in the journal is never done again
                    folder.keep(by_key[row.key].name, done.record)
                journal.append(row)
                rows[row.key] = row
                state.count(row)
                state.ran += 1
                state.seconds = time.monotonic() - began
                tell(state)
        table = out / f"{name}.csv"
        write_text(table, as_csv(rows.values()))
    return Sweep(tuple(rows[key] for key in sorted(rows)), table, state)
