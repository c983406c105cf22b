"""Rows of planners that learn each environment before they drive it: tables of places."""

from __future__ import annotations

from typing import Any

from fuzzyq_bullet.episode import run, run_with
from fuzzyq_bullet.recording.trajectory import Trajectory
from fuzzyq_bullet.scenario import Scenario
from fuzzyq_bullet.studies.episodes import Job
from fuzzyq_bullet.studies.options import POSITIONAL
from fuzzyq_bullet.studies.sweep import answer, run_job
from fuzzyq_bullet.training.position import learn_position


def learn_and_drive(scenario: Scenario) -> Trajectory:
    """Learn a realised scenario's field as its planner learns, and drive there."""
    return run_with(learn_position(scenario.planner.name, scenario), scenario)


def work_for_row(order: dict[str, Any]) -> dict[str, Any]:
    """Do a job in a worker process for its row alone (``studies.sweep.work_for_row``)."""
    job = Job.of_order(order)
    done = run_job(job, learn_and_drive if job.planner in POSITIONAL else run)
    return {**answer(done), "record": None}
