"""Who crosses the same field again: a robot that learns it, and one that keeps its map.

Each crosses it many times and answers with its fastest run. One that touches anything in any of
them answers with that run instead: a contact is not forgiven.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

from fuzzyq_bullet.episode import run, run_in, world_of
from fuzzyq_bullet.ground_truth import feasible
from fuzzyq_bullet.physics.engine import Engine
from fuzzyq_bullet.physics.sensor_world import SensorWorld
from fuzzyq_bullet.planning.fuzzy_q_lambda import FuzzyQLambdaPlanner
from fuzzyq_bullet.planning.settings import FuzzyQLambdaSettings
from fuzzyq_bullet.recording.trajectory import Trajectory
from fuzzyq_bullet.scenario import Scenario
from fuzzyq_bullet.studies.episodes import Job
from fuzzyq_bullet.studies.escape.bounds import DRIVERS
from fuzzyq_bullet.studies.familiar.kept_map import KeptMap
from fuzzyq_bullet.studies.sweep import ROOM, answer, run_job
from fuzzyq_bullet.training.field import FieldMemory, FieldTask, field_setup

LEARNED, KEPT = "learned", "kept-map"
_LABEL = re.compile(rf"({LEARNED}|{KEPT})-(\d+)")


def label_of(what: str, runs: int) -> str:
    """Return what rows call a robot that has crossed the field so often."""
    return f"{what}-{runs}"


def learn_and_drive(scenario: Scenario, runs: int) -> Trajectory:
    """Learn a realised field (``training.field``), and return the fastest run."""
    memory, setup, task = FieldMemory(), field_setup(runs, 0), FieldTask(scenario)

    def cross(world: SensorWorld, number: int) -> Trajectory:
        trajectory, choices = memory.drive(task, world)
        memory.after(trajectory, choices, setup, number)
        return trajectory

    return _fastest(scenario, runs, cross)


def keep_map_and_drive(scenario: Scenario, runs: int) -> Trajectory:
    """Cross a realised field with one map for all runs, and return the fastest."""
    kept = KeptMap()

    def cross(world: SensorWorld, number: int) -> Trajectory:
        planner = FuzzyQLambdaPlanner(FuzzyQLambdaSettings())
        kept.begin_again()
        planner.keep_map(kept.graph)
        trajectory = run_in(world, scenario, planner)
        if trajectory.outcome == "goal":
            kept.graph.arrive(scenario.goal.position)
        return trajectory

    return _fastest(scenario, runs, cross)


def work(order: dict[str, Any]) -> dict[str, Any]:
    """Do a job of the study in a worker process, by what its row is called."""
    job = Job.of_order(order)
    return answer(run_job(job, _driver_of(job.planner)))


def _driver_of(label: str) -> Callable[[Scenario], Trajectory]:
    found = _LABEL.fullmatch(label)
    if found is None:
        return DRIVERS.get(label, run)
    drive = learn_and_drive if found[1] == LEARNED else keep_map_and_drive
    return lambda scenario: drive(scenario, int(found[2]))


def _fastest(
    scenario: Scenario, runs: int, cross: Callable[[SensorWorld, int], Trajectory]
) -> Trajectory:
    """Return the fastest of several runs, or the first that touched anything.

    Where there is no way a single run is enough.
    """
    best: Trajectory | None = None
    with Engine() as engine:
        for number in range(1, (runs if feasible(scenario, ROOM) else 1) + 1):
            trajectory = cross(world_of(scenario, engine), number)
            if trajectory.outcome == "collision":
                return trajectory
            if best is None or _is_better(trajectory, best):
                best = trajectory
    assert best is not None
    return best


def _is_better(one: Trajectory, other: Trajectory) -> bool:
    there, before = (each.outcome == "goal" for each in (one, other))
    if there != before:
        return there
    return bool(one.ticks.time[-1] < other.ticks.time[-1])
