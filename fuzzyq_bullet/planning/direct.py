"""The planners ``q-learning`` and ``q-lambda``: a heading from a table, and nothing else.

They are the direct baselines of the paper's comparison, which only names them. What is built here:
a state says how far each of three detection lines is free, an action is one of five headings off
the line to the goal, and every step is as long (``docs/learning.md``).
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from itertools import product
from typing import NamedTuple

from fuzzyq_bullet.learning import Expected, Policy, greedy
from fuzzyq_bullet.planning.base import STEP_UNIT, Observation
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.planning.settings import PolicySettings

LINE_ANGLE = math.radians(45.0)
"""Angle of the left and right lines from the middle one (rad), as in the fuzzy planners."""
BORDERS = (1.0 * STEP_UNIT, 2.0 * STEP_UNIT, 4.0 * STEP_UNIT)
"""Free lengths (m) at which the next level begins; the first is a step, so that below it a step
along the line hits something."""
LEVELS = ("blocked", "near", "middling", "free")
LINES = ("left", "ahead", "right")
STATE_NAMES = tuple(
    ", ".join(f"{line} {level}" for line, level in zip(LINES, levels, strict=True))
    for levels in product(LEVELS, repeat=len(LINES))
)

STEP = STEP_UNIT
"""Length of every step (m), but for the last one to the goal."""


class Heading(NamedTuple):
    """What an action is.

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

EXPECTED = {
    name: Expected(name, STATE_NAMES, ACTION_NAMES, name) for name in ("q-learning", "q-lambda")
}
"""What the policies of the two planners must look like."""


class Sight(NamedTuple):
    """What the detection lines say.

    Attributes:
        bearing: World heading of the goal, and of the middle line (rad).
        to_goal: Distance to the centre of the goal (m).
        lines: World headings of the left, middle and right lines (rad), shape (3,).
        lengths: Their free lengths (m), shape (3,).
        state: Number of the state that this is.
    """

    bearing: float
    to_goal: float
    lines: tuple[float, float, float]
    lengths: Sequence[float]
    state: int


def state_of(lengths: Sequence[float]) -> int:
    """Return the number of a state.

    Args:
        lengths: Free lengths of the left, middle and right lines (m), shape (3,).
    """
    state = 0
    for length in lengths:
        state = len(LEVELS) * state + bisect_right(BORDERS, length)
    return state


def sense(observation: Observation) -> Sight:
    """Cast the three lines. What stands behind the goal is not in the way."""
    dx = observation.goal[0] - observation.position[0]
    dy = observation.goal[1] - observation.position[1]
    to_goal = math.hypot(dx, dy)
    bearing = math.atan2(dy, dx)
    lines = (bearing + LINE_ANGLE, bearing, bearing - LINE_ANGLE)
    left, middle, right = lengths = observation.sense(lines)
    counted = (left, math.inf if middle >= to_goal else middle, right)
    return Sight(bearing, to_goal, lines, lengths, state_of(counted))


def act(sight: Sight, action: int) -> Decision:
    """Return the step of an action; nothing guards it."""
    return Decision(
        heading=sight.bearing + ACTIONS[action].turn,
        step=min(STEP, sight.to_goal),
        lines=sight.lines,
        lengths=sight.lengths,
    )


class DirectPlanner:
    """Takes, in every state, the heading that was worth most when it learned.

    Args:
        settings: Those of ``q-learning`` or of ``q-lambda``.
        policy: What that planner learned.

    Raises:
        UserError: If the policy is that of something else.
    """

    def __init__(self, settings: PolicySettings, policy: Policy) -> None:
        EXPECTED[settings.name].check(policy, f"the policy given to {settings.name}")
        self._best = [greedy(row) for row in policy.table]

    def decide(self, observation: Observation, /) -> Decision:
        """Return a step along the heading that is worth most here."""
        sight = sense(observation)
        return act(sight, self._best[sight.state])
