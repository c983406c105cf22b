"""The routine part of every fuzzy planner: three detection lines, the controller, Eq. 17."""

from __future__ import annotations

import math

import numpy as np

from fuzzyq_bullet.fuzzy.paper import paper_controller
from fuzzyq_bullet.planning.base import STEP_UNIT, Decision, Observation
from fuzzyq_bullet.planning.settings import RoutineSettings


class Routine:
    """Routine path planning (Section 3, Steps 4–11) for one episode.

    The middle line points at the goal, the others α to its left and right. The distance along one
    is how far the robot's disc can move before it touches something. If the middle line is free up
    to the goal there is nothing to avoid: d = 5, Df = 0.
    """

    def __init__(self, settings: RoutineSettings) -> None:
        self._settings = settings
        self._controller = paper_controller(rules=settings.rules, samples=settings.samples)

    def decide(self, observation: Observation) -> Decision:
        """Return the step that the fuzzy controller proposes, as yet unguarded."""
        settings = self._settings
        dx = observation.goal[0] - observation.position[0]
        dy = observation.goal[1] - observation.position[1]
        to_goal = math.hypot(dx, dy)
        bearing = math.atan2(dy, dx)
        alpha = settings.line_angle
        lines = (bearing + alpha, bearing, bearing - alpha)
        lengths = observation.sense(lines)
        left, middle, right = lengths.tolist()

        if middle >= min(observation.range, to_goal):
            distance, difference = observation.range / STEP_UNIT, 0.0
        else:
            nearest = middle if settings.distance == "middle" else min(left, middle, right)
            distance, difference = nearest / STEP_UNIT, (left - right) / STEP_UNIT  # Eqs. 13, 14
        inferred = self._controller.infer(distance, difference)

        w1, w2 = settings.weights
        return Decision(
            heading=bearing + w2 * inferred.turn * settings.turn_unit,  # Eqs. 15–17
            step=min(w1 * inferred.stride * STEP_UNIT, to_goal),
            lines=np.array(lines),
            lengths=lengths,
            distance=distance,
            difference=difference,
            near=inferred.near,
            side=inferred.side,
            rules=inferred.rules,
            turn=inferred.turn,
            stride=inferred.stride,
            weights=settings.weights,
        )
