"""A sweep: many episodes over all cores, that may be ended at any moment and goes on later."""

from __future__ import annotations

import base64
import time
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from fuzzyq_bullet.episode import run
from fuzzyq_bullet.errors import MachineError, PlannerError, UserError
from fuzzyq_bullet.files import write_text
from fuzzyq_bullet.ground_truth import feasible
from fuzzyq_bullet.planning.registry import make_planner
from fuzzyq_bullet.planning.settings import PlannerSettings
from fuzzyq_bullet.recording.metrics import result_of
from fuzzyq_bullet.recording.trajectory import Trajectory
from fuzzyq_bullet.scenario import Scenario, realise
from fuzzyq_bullet.sensors import SENSOR_MARGIN
from fuzzyq_bullet.studies.episodes import Job, Row, as_csv
from fuzzyq_bullet.studies.storage import Folder, Journal
from fuzzyq_bullet.studies.study import Work
from fuzzyq_bullet.workers import Answer, Pool, WorkerPool

ROOM = 0.22
"""Radius (m) of the disc for which an environment must have a way to count as feasible: the
narrowest way that the planner's detection lines can see, 0.02 m wider than the robot each side."""
TIMEOUT = 3600.0
"""Wall-clock time (s) after which an episode is cut: it hangs."""
MEMORY_MB = 4096
"""Memory (MB) that one worker may use."""

Progress: TypeAlias = Callable[["State"], None]
"""Called at the start and after every row."""


@dataclass(frozen=True)
class Done:
    """The row of a finished job; the record (``.npz``) of a run that failed with a way."""

    row: Row
    record: bytes | None = None


def room_of(scenario: Scenario) -> float:
    """Return the radius (m) of the disc for which there must be a way: ``ROOM`` for its robot."""
    return scenario.robot.radius + SENSOR_MARGIN


def run_job(job: Job, run: Callable[[Scenario], Trajectory] = run) -> Done:
    """Run one episode. Whatever it raises becomes its row, not the end of the sweep.

    Args:
        job: The episode.
        run: What drives it, if not its planner alone.

    Raises:
        MachineError: If the machine failed it: a row would never be done again.
    """
    way: bool | None = None
    try:
        scenario = realise(job.scenario())
        way = feasible(scenario, room_of(scenario))
        trajectory = run(scenario)
        row = Row.of(job, result_of(trajectory), way)
        return Done(row, trajectory.to_bytes() if way and not row.success else None)
    except MachineError:
        raise
    except PlannerError as error:
        return Done(Row.failed(job, str(error), way))
    except Exception as error:
        return Done(Row.failed(job, f"{type(error).__name__}: {error}", way))


def work(order: dict[str, Any]) -> dict[str, Any]:
    """Do ``run_job`` in a worker process; job and row as JSON, a record in Base64."""
    return answer(run_job(Job.of_order(order)))


def answer(done: Done) -> dict[str, Any]:
    """Return what became of a job as JSON can say it."""
    record = None if done.record is None else base64.b64encode(done.record).decode()
    return {"row": done.row.model_dump(mode="json"), "record": record}


def work_for_row(order: dict[str, Any]) -> dict[str, Any]:
    """Do the same and leave the record behind: whole planners fail by the thousand.

    The row has the seed, and the digest to know the run by: it can be run again.
    """
    return {**work(order), "record": None}


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
    """A finished sweep: all rows sorted by key, the CSV that holds them, and how it went."""

    rows: tuple[Row, ...]
    table: Path
    state: State


def local_pool(jobs: int | None = None, plugins: Sequence[str] = ()) -> WorkerPool:
    """Return worker processes of this machine for episodes; None for one a core."""
    return WorkerPool(jobs, plugins=plugins, timeout=TIMEOUT, memory_mb=MEMORY_MB)


def sweep(
    name: str,
    jobs: Sequence[Job],
    out: Path,
    settings: Mapping[str, Any],
    *,
    pool: Pool,
    work: Work = work,
    progress: Progress | None = None,
    here: bool = False,
) -> Sweep:
    """Run all jobs that have no row in the folder yet, and write ``NAME.csv``.

    It may be ended at any moment, by whatever, and called again: it goes on, and the table is the
    same byte for byte, however many workers there are.

    Args:
        name: What to call the table.
        jobs: All jobs of the sweep, with different keys.
        out: Its folder, created if need be.
        settings: All that the rows depend on, as JSON can say it: what makes this sweep another.
        pool: Who does the work.
        work: Turns a job into its row, in a worker: ``work`` or ``work_for_row``.
        progress: Told how far it is.
        here: Whether the workers are of this machine: what a planner lacks here, it lacks there.

    Raises:
        UserError: If the folder holds a sweep with other settings, another process is at work in
            it, it cannot be written to, a planner that is still to drive cannot be made here, or
            the machine fails a worker.
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
        if here:
            refuse_unready(left)
        began = time.monotonic()
        with closing(_finished(left, work, pool)) as results:
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


def refuse_unready(jobs: Sequence[Job]) -> None:
    """Make sure that every planner can be made, before any of them drives.

    Raises:
        UserError: If one lacks what it needs, such as a package. Whatever else is wrong with one is
            told in its rows.
    """
    for settings in {job.planner: job.settings for job in jobs}.values():
        _make(settings)


def _make(settings: PlannerSettings) -> None:
    try:
        make_planner(settings, np.random.default_rng(0))
    except UserError as error:
        raise error.under(f"planner {settings.name}") from error
    except Exception:  # of a planner of the user's own
        return


def _finished(jobs: Sequence[Job], work: Work, pool: Pool) -> Generator[Done, None, None]:
    """Do jobs; yield each as it is finished.

    One whose worker died is done once more, alone: the machine may have been out of memory. If its
    worker dies again, its row says so.
    """
    died = []
    for i, answer in pool.run(work, [job.as_order() for job in jobs]):
        if answer.died and not answer.late:
            died.append(jobs[i])
        else:
            yield _done(jobs[i], answer)
    for job in died:
        for _, answer in pool.run(work, [job.as_order()]):
            yield _done(job, answer)


def _done(job: Job, answer: Answer) -> Done:
    if answer.late:
        return Done(Row.failed(job, answer.died))
    if answer.died:
        return Done(Row.failed(job, f"its worker process died twice: {answer.died}"))
    if answer.failed:
        return Done(Row.failed(job, "; ".join(answer.failed)))
    record = answer.value["record"]
    row = Row.model_validate(answer.value["row"])
    return Done(row, None if record is None else base64.b64decode(record))
