"""The routine part of every fuzzy planner: three detection lines, the controller, Eq. 17."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from fuzzyq_bullet.fuzzy.controller import Inference
from fuzzyq_bullet.fuzzy.paper import paper_controller
from fuzzyq_bullet.planning.base import STEP_UNIT, Decision, Observation
from fuzzyq_bullet.planning.settings import RoutineSettings


class Situation(NamedTuple):
    """What the detection lines and the controller say, before any weight is put on it.

    Attributes:
        bearing: World heading of the goal, and of the middle line (rad).
        to_goal: Distance to the centre of the goal (m).
        lines: World headings of the left, middle and right lines (rad), shape (3,).
        lengths: Their free lengths (m), shape (3,).
        distance: d, in units of S_p.
        difference: Df, in units of S_p (Eq. 14).
        clear: Whether nothing is seen to stand in the way to the goal.
        inferred: What the controller makes of d and Df.
        unit: S_p (m).
    """

    bearing: float
    to_goal: float
    lines: tuple[float, float, float]
    lengths: Sequence[float]
    distance: float
    difference: float
    clear: bool
    inferred: Inference
    unit: float = STEP_UNIT


class Routine:
    """Routine path planning (Section 3, Steps 4–11) for one episode.

    The middle line points at the goal, the others α to its left and right. The distance along one
    is how far the robot's disc can move before it touches something. If the middle line is free up
    to the goal there is nothing to avoid: d = 5, Df = 0.
    """

    def __init__(self, settings: RoutineSettings) -> None:
        self._settings = settings
        self._controller = paper_controller(rules=settings.rules, samples=settings.samples)
        self._unhindered: tuple[float, Inference] | None = None

    def sense(self, observation: Observation) -> Situation:
        """Cast the three lines and ask the controller (Steps 4–9)."""
        settings, unit = self._settings, observation.unit
        dx = observation.goal[0] - observation.position[0]
        dy = observation.goal[1] - observation.position[1]
        to_goal = math.hypot(dx, dy)
        bearing = math.atan2(dy, dx)
        alpha = settings.line_angle
        lines = (bearing + alpha, bearing, bearing - alpha)
        left, middle, right = lengths = observation.sense(lines)

        clear = middle >= min(observation.range, to_goal)
        if clear:
            distance, difference = observation.range / unit, 0.0
            inferred = self._with_nothing_to_avoid(distance)
        else:
            nearest = middle if settings.distance == "middle" else min(left, middle, right)
            distance, difference = nearest / unit, (left - right) / unit  # Eqs. 13, 14
            inferred = self._controller.infer(distance, difference)
        told = (bearing, to_goal, lines, lengths, distance, difference, clear, inferred)
        return Situation(*told, unit)

    def step(
        self,
        situation: Situation,
        weights: tuple[float, float],
        breakout_at: float = math.nan,
    ) -> Decision:
        """Return the step that the controller proposes, weighted (Eqs. 15–17), unguarded.

        Args:
            situation: What is sensed.
            weights: (ω1, ω2).
            breakout_at: c_f, for the ways out and the record.
        """
        w1, w2 = weights
        inferred = situation.inferred
        return Decision(
            heading=situation.bearing + w2 * inferred.turn * self._settings.turn_unit,
            step=min(w1 * inferred.stride * situation.unit, situation.to_goal),
            lines=situation.lines,
            lengths=situation.lengths,
            distance=situation.distance,
            difference=situation.difference,
            near=inferred.near,
            side=inferred.side,
            rules=inferred.rules,
            turn=inferred.turn,
            stride=inferred.stride,
            weights=weights,
            breakout_at=breakout_at,
        )

    def _with_nothing_to_avoid(self, distance: float) -> Inference:
        """Return what the controller says to this distance and Df = 0; asked once an episode."""
        if self._unhindered is None or self._unhindered[0] != distance:
            self._unhindered = (distance, self._controller.infer(distance, 0.0))
        return self._unhindered[1]
