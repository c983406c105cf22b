"""The planners ``q-learning`` and ``q-lambda``: the heading is read from a table.

They are the direct baselines of the paper's comparison, which only names them. Here a state tells
how far each of three detection lines is free, an action is one of five headings relative to the
line to the goal, and all steps have the same length (``docs/learning.md``).
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from itertools import product
from typing import NamedTuple

from fuzzyq_bullet.learning import Policy, PolicySpec, greedy
from fuzzyq_bullet.planning.base import STEP_UNIT, Observation
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.planning.settings import PolicySettings

LINE_ANGLE = math.radians(45.0)
"""Angle of the left and right lines from the middle one (rad), as in the fuzzy planners."""
BORDERS = (1.0, 2.0, 4.0)
"""Free lengths (S_p) at which the next level begins. The first is one step: where less is free, a
step along the line hits something."""
LEVELS = ("blocked", "near", "middling", "free")
LINES = ("left", "ahead", "right")
STATE_NAMES = tuple(
    ", ".join(f"{line} {level}" for line, level in zip(LINES, levels, strict=True))
    for levels in product(LEVELS, repeat=len(LINES))
)


class Heading(NamedTuple):
    """What an action does.

    Attributes:
        name: What it is called in policies.
        turn: Angle off the line to the goal (rad), positive to the left.
    """

    name: str
    turn: float


ACTIONS = (
    Heading("left 90°", math.radians(90.0)),
    Heading("left 45°", math.radians(45.0)),
    Heading("straight", 0.0),
    Heading("right 45°", math.radians(-45.0)),
    Heading("right 90°", math.radians(-90.0)),
)
ACTION_NAMES = tuple(action.name for action in ACTIONS)

POLICY_SPECS = {
    name: PolicySpec(name, STATE_NAMES, ACTION_NAMES, name) for name in ("q-learning", "q-lambda")
}
"""What the policies of the two planners look like."""


class Sensed(NamedTuple):
    """What the detection lines tell.

    Attributes:
        bearing: World heading of the goal, and of the middle line (rad).
        to_goal: Distance to the centre of the goal (m).
        lines: World headings of the left, middle and right lines (rad), shape (3,).
        lengths: Their free lengths (m), shape (3,).
        state: Number of the state.
        unit: S_p, the length of every step but the last one, to the goal (m).
    """

    bearing: float
    to_goal: float
    lines: tuple[float, float, float]
    lengths: Sequence[float]
    state: int
    unit: float = STEP_UNIT


def state_of(lengths: Sequence[float], unit: float = STEP_UNIT) -> int:
    """Return the number of a state.

    Args:
        lengths: Free lengths of the left, middle and right lines (m), shape (3,).
        unit: S_p (m).
    """
    borders = [border * unit for border in BORDERS]
    state = 0
    for length in lengths:
        state = len(LEVELS) * state + bisect_right(borders, length)
    return state


def sense(observation: Observation) -> Sensed:
    """Cast the three lines. What stands behind the goal is not in the way."""
    dx = observation.goal[0] - observation.position[0]
    dy = observation.goal[1] - observation.position[1]
    to_goal = math.hypot(dx, dy)
    bearing = math.atan2(dy, dx)
    lines = (bearing + LINE_ANGLE, bearing, bearing - LINE_ANGLE)
    left, middle, right = lengths = observation.sense(lines)
    counted = (left, math.inf if middle >= to_goal else middle, right)
    unit = observation.unit
    return Sensed(bearing, to_goal, lines, lengths, state_of(counted, unit), unit)


def act(sensed: Sensed, action: int) -> Decision:
    """Return the step of an action. No safety filter follows."""
    return Decision(
        heading=sensed.bearing + ACTIONS[action].turn,
        step=min(sensed.unit, sensed.to_goal),
        lines=sensed.lines,
        lengths=sensed.lengths,
    )


class DirectPlanner:
    """Takes the heading of the greatest learned value in every state.

    Args:
        settings: Those of ``q-learning`` or of ``q-lambda``.
        policy: What that planner learned.

    Raises:
        UserError: If the policy is that of something else.
    """

    def __init__(self, settings: PolicySettings, policy: Policy) -> None:
        POLICY_SPECS[settings.name].check(policy, f"the policy given to {settings.name}")
        self._best = [greedy(row) for row in policy.table]

    def decide(self, observation: Observation, /) -> Decision:
        """Return a step along the best heading."""
        sensed = sense(observation)
        return act(sensed, self._best[sensed.state])
