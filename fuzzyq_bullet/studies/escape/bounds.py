"""What a planner could gain at most: two drivers that know the truth about the world.

They stand beside the planner in the table of ``fuzzyq bench escape``, and nowhere else: only in a
study may what drives know the way. Both have the robot's own dynamics and the same safety filter.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from fuzzyq_bullet.episode import planner_of, run, run_with
from fuzzyq_bullet.geometry import Floats
from fuzzyq_bullet.ground_truth import shortest_path
from fuzzyq_bullet.ground_truth.distance_field import DistanceField
from fuzzyq_bullet.planning import Decision, Observation
from fuzzyq_bullet.planning.base import LONGEST_STRIDE
from fuzzyq_bullet.planning.improved_fuzzy import ImprovedFuzzyBase
from fuzzyq_bullet.planning.safety_filter import safety_filter
from fuzzyq_bullet.recording.trajectory import Trajectory
from fuzzyq_bullet.scenario import Scenario
from fuzzyq_bullet.studies.episodes import Job
from fuzzyq_bullet.studies.sweep import answer, room_of, run_job

SPACING = 0.05
"""Distance between two points of the path (m)."""
LOST = 0.5
"""How far on the robot may find itself with the next decision (m)."""
ASIDE = tuple(math.radians(side * turn) for turn in (0, 1, 2, 4, 8, 16, 30) for side in (1, -1))[1:]
"""Turns aside (rad) to try where no point of the path is in sight: the robot came off it."""
SLACK = (0.03, 0.05)
"""More room (m) on the path than the robot itself needs: it need not stop ..."""
LONGER = 1.02
"""... and takes such a path if it is no longer than this, in shortest paths."""


class ShortestPathDriver:
    """Drives the true shortest path: always towards the farthest point of it that is in sight.

    Args:
        points: The path (m), shape (P, 2).
    """

    def __init__(self, points: Floats) -> None:
        pieces = np.hypot(*np.diff(points, axis=0).T)
        along = np.concatenate([[0.0], np.cumsum(pieces)])
        places = np.linspace(0.0, along[-1], max(2, math.ceil(along[-1] / SPACING) + 1))
        self._points = np.column_stack([np.interp(places, along, points[:, k]) for k in (0, 1)])
        self._at = 0

    def decide(self, observation: Observation, /) -> Decision:
        """Return a decision to drive on at full speed, as far as the safety filter allows it."""
        off = self._points[self._at :] - observation.position
        passed = int(np.hypot(*off[: round(LOST / SPACING)].T).argmin())
        self._at += passed
        ways = off[passed + 1 :][: round(observation.range / SPACING)]
        if not len(ways):
            ways = off[-1:]
        headings = np.arctan2(ways[:, 1], ways[:, 0])
        lengths = np.minimum(np.hypot(*ways.T), observation.range)
        for aside in ASIDE:
            free = np.array(observation.sense((headings + aside).tolist()))
            seen = np.flatnonzero(free >= lengths)
            if seen.size:
                break
        # Where nothing of it is in sight from here, the robot turns on until something is.
        chosen = int(seen[-1]) if seen.size else 0
        step = LONGEST_STRIDE * observation.unit
        if observation.motion is None:
            step = min(step, float(lengths[chosen]))
        return safety_filter(Decision(float(headings[chosen]) + aside, step), observation)


def drive_shortest_path(scenario: Scenario) -> Trajectory:
    """Drive a realised scenario along its shortest path, as far from things as costs nothing."""
    route = shortest_path(scenario, room_of(scenario)) or shortest_path(scenario)
    for room in SLACK:
        wider = shortest_path(scenario, scenario.robot.radius + room)
        if route is not None and wider is not None and wider.length < LONGER * route.length:
            route = wider
    start, goal = scenario.start.position, scenario.goal.position
    points = np.array([start, goal]) if route is None else np.concatenate([route.points, [goal]])
    return run_with(ShortestPathDriver(points), scenario)


def drive_true_exits(scenario: Scenario) -> Trajectory:
    """Drive a realised scenario by its planner, which is told the true way on from every exit."""
    planner = planner_of(scenario)
    if isinstance(planner, ImprovedFuzzyBase):
        planner.know(DistanceField(scenario, room_of(scenario)).at)
    return run_with(planner, scenario)


DRIVERS: Mapping[str, Callable[[Scenario], Trajectory]] = {
    "true-exits": drive_true_exits,
    "true-path": drive_shortest_path,
}
"""The bounds by what rows call them."""


def work(order: dict[str, Any]) -> dict[str, Any]:
    """Do a job of the study in a worker process; that of a bound by what it knows."""
    job = Job.of_order(order)
    return answer(run_job(job, DRIVERS.get(job.planner, run)))
