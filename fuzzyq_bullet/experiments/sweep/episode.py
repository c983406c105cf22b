"""What a worker does: one job becomes one row, whatever happens to it."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

from fuzzyq_bullet.episode import run
from fuzzyq_bullet.errors import PlannerError
from fuzzyq_bullet.experiments.sweep.jobs import Job
from fuzzyq_bullet.experiments.sweep.rows import Row
from fuzzyq_bullet.ground_truth import feasible
from fuzzyq_bullet.metrics import result_of
from fuzzyq_bullet.scenario import realise
from fuzzyq_bullet.trajectory import Trajectory

ROOM = 0.22
"""Radius (m) of the disc for which an environment must have a way to count as feasible: the
narrowest way that the planner's detection lines can see, 0.02 m wider than the robot each side."""


@dataclass(frozen=True)
class Done:
    """A finished job.

    Attributes:
        row: What it came to.
        record: The contents of a record (``.npz``) of a run that failed although there was a way;
            bytes, for a worker may sit on another machine.
    """

    row: Row
    record: bytes | None = None


def run_job(job: Job) -> Done:
    """Run one episode. Whatever it raises becomes its row, not the end of the sweep."""
    way: bool | None = None
    try:
        scenario = realise(job.scenario())
        way = feasible(scenario, ROOM)
        trajectory = run(scenario)
        row = Row.of(job, result_of(trajectory), way)
        return Done(row, _record(trajectory) if way and not row.success else None)
    except PlannerError as error:
        return Done(Row.failed(job, str(error), way))
    except Exception as error:
        return Done(Row.failed(job, f"{type(error).__name__}: {error}", way))


def _record(trajectory: Trajectory) -> bytes:
    with tempfile.TemporaryDirectory(prefix="fuzzyq-") as folder:
        path = Path(folder) / "record.npz"
        trajectory.save(path)
        return path.read_bytes()
