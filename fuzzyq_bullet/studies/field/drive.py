"""How a worker drives an episode of ``bench field``: its decisions are timed."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial, wraps
from typing import Any

import numpy as np

from fuzzyq_bullet.episode import planner_of, run_with
from fuzzyq_bullet.planning import Observation, Planner
from fuzzyq_bullet.planning.process.planner import ProcessSettings
from fuzzyq_bullet.recording.trajectory import Trajectory
from fuzzyq_bullet.scenario import Scenario
from fuzzyq_bullet.sensors import ExactSensor
from fuzzyq_bullet.studies.episodes import Job
from fuzzyq_bullet.studies.escape.bounds import drive_shortest_path
from fuzzyq_bullet.studies.field.plan import BOUND
from fuzzyq_bullet.studies.sweep import Done, answer, run_job


class Timed:
    """A planner whose decisions are timed, the rays that it asks for included.

    Args:
        planner: The planner.
        seconds: The time of each decision (s) is appended to it.
        clock: The clock (s). Processor time leaves out other processes, but also a planner that is
            a program of its own.
    """

    def __init__(
        self,
        planner: Planner,
        seconds: list[float],
        clock: Callable[[], float] = time.process_time,
    ) -> None:
        @wraps(planner.decide)  # an error names the planner's own line
        def decide(observation: Observation, /) -> Any:
            began = clock()
            decided = planner.decide(observation)
            seconds.append(clock() - began)
            return decided

        self.decide = decide
        close = getattr(planner, "close", None)
        if callable(close):
            self.close = close


def drive_timed(scenario: Scenario, seconds: list[float]) -> Trajectory:
    """Drive a realised scenario by its planner, and note the time of each decision (s)."""
    apart = isinstance(scenario.planner, ProcessSettings)
    clock = time.perf_counter if apart else time.process_time
    return run_with(Timed(planner_of(scenario), seconds, clock), scenario)


def drive_bound(scenario: Scenario) -> Trajectory:
    """Drive the shortest path of a realised scenario, without moving obstacles.

    Sensor, position and wheels are undisturbed.
    """
    robot = scenario.robot.model_copy(update={"slip": 0.0, "latency": 0.0})
    sensor = ExactSensor(range=scenario.sensor_range)
    alone = {"obstacles": scenario.standing, "robot": robot, "sensor": sensor}
    return drive_shortest_path(scenario.model_copy(update=alone))


def work(order: dict[str, Any]) -> dict[str, Any]:
    """Do a job of the study in a worker process, and return its row."""
    job = Job.of_order(order)
    if job.planner.split(".")[0] == BOUND:
        return answer(Done(run_job(job, drive_bound).row))
    seconds: list[float] = []
    row = run_job(job, partial(drive_timed, seconds=seconds)).row
    if seconds and row.error is None:
        middle, most = np.percentile(np.array(seconds) * 1e3, [50, 95]).round(4).tolist()
        row = row.model_copy(update={"decision_ms": middle, "decision_p95_ms": most})
    return answer(Done(row))
