"""The planner ``fuzzy``, and the routine part that it shares with the other fuzzy planners.

Three detection lines are cast, the fuzzy controller judges d and Df, and Eq. 17 makes its outputs a
step (Steps 4 to 11).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from fuzzyq_bullet.fuzzy.inference import Inference
from fuzzyq_bullet.planning.aim import Aim, towards_goal
from fuzzyq_bullet.planning.base import LONGEST_STRIDE, STEP_UNIT, Observation
from fuzzyq_bullet.planning.controllers import controller_of
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.planning.settings import FuzzySettings, RoutineSettings

NO_RULES = Inference((0.0,) * 5, (0.0,) * 5, ((0.0,) * 5,) * 5, turn=0.0, stride=LONGEST_STRIDE)
"""What is inferred without a controller: straight on, with the longest step."""


class Situation(NamedTuple):
    """What the detection lines and the controller tell, before it is weighted.

    Attributes:
        aim: What the middle line points at.
        to_goal: Distance to the centre of the goal (m).
        lines: World headings of the left, middle and right lines (rad), shape (3,).
        lengths: Their free lengths (m), shape (3,).
        distance: d, in units of S_p.
        difference: Df, in units of S_p (Eq. 14).
        clear: Whether the middle line is free up to the goal, and the goal is the aim.
        inferred: What the controller infers from d and Df.
        unit: S_p (m).
        jumps: Whether a step is one jump of the point robot, which must not pass the aim.
    """

    aim: Aim
    to_goal: float
    lines: tuple[float, float, float]
    lengths: Sequence[float]
    distance: float
    difference: float
    clear: bool
    inferred: Inference
    unit: float = STEP_UNIT
    jumps: bool = False


class Routine:
    """Routine path planning for one episode (Section 3, Steps 4 to 11).

    The middle detection line points at the aim, the others an angle α to its left and right. The
    aim is the goal, or on a way out a temporary goal. The length of a line is how far the robot's
    disc can move along it before it touches something. If the middle line is free up to the goal,
    there is nothing to avoid: d = 5, Df = 0.
    """

    def __init__(self, settings: RoutineSettings) -> None:
        self._settings = settings
        self._controller = controller_of(settings)

    def sense(self, observation: Observation, aim: Aim | None = None) -> Situation:
        """Cast the three lines (Steps 4 to 6) and ask the controller (Step 9; Eqs. 13, 14).

        Args:
            observation: What is observed.
            aim: What the middle line points at; by default the goal.
        """
        settings, unit = self._settings, observation.unit
        aim = aim or towards_goal(observation)
        alpha = settings.line_angle
        lines = (aim.bearing + alpha, aim.bearing, aim.bearing - alpha)
        left, middle, right = lengths = observation.sense(lines)

        seen = aim.distance if settings.clear == "aim" else min(observation.range, aim.distance)
        # What lies beyond a temporary goal is unknown: there is always something to judge.
        clear = middle >= seen and aim.mode == "routine"
        if clear:
            distance, difference = observation.range / unit, 0.0
        else:
            nearest = middle if settings.distance == "middle" else min(left, middle, right)
            distance, difference = nearest / unit, (left - right) / unit  # Eqs. 13, 14
        return Situation(
            aim=aim,
            to_goal=math.dist(observation.position, observation.goal),
            lines=lines,
            lengths=lengths,
            distance=distance,
            difference=difference,
            clear=clear,
            inferred=(
                self._controller.infer(distance, difference) if self._controller else NO_RULES
            ),
            unit=unit,
            jumps=observation.motion is None,
        )

    def step(
        self,
        situation: Situation,
        weights: tuple[float, float],
        breakout_at: float = math.nan,
    ) -> Decision:
        """Return the step that the controller proposes, weighted (Step 11; Eqs. 15 to 17).

        Args:
            situation: What was sensed.
            weights: (ω1, ω2).
            breakout_at: c_f in units of S_p, for the record.
        """
        w1, w2 = weights
        aim, inferred = situation.aim, situation.inferred
        turn = 0.0 if aim.exact else w2 * inferred.turn * self._settings.turn_unit
        step = 0.0 if aim.hopeless else w1 * inferred.stride * situation.unit
        return Decision(
            heading=aim.bearing + turn,
            step=min(step, aim.distance) if situation.jumps else step,
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
            **aim.told(),
        )


class FuzzyPlanner:
    """The traditional baseline: every step that the controller proposes.

    It has no safety filter and no breakout.
    """

    def __init__(self, settings: FuzzySettings) -> None:
        self._routine = Routine(settings)
        self._weights = settings.weights

    def decide(self, observation: Observation, /) -> Decision:
        """Return the controller's step."""
        return self._routine.step(self._routine.sense(observation), self._weights)
