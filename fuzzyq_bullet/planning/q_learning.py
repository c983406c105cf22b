"""The planners ``q-learning`` and ``q-lambda``: the heading is read from a table.

They are the direct baselines of the paper's comparison, which only names them. Here a state tells
how far each of three detection lines is free, an action is one of five headings relative to the
line to the goal, and all steps have the same length (``docs/explanation/learning.md``). With
``guard`` and ``breakout`` the safety filter and the ways out of the improved planners come beside
the table, which is then asked on the way to temporary goals too.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from itertools import product
from typing import NamedTuple

from fuzzyq_bullet.learning import Policy, PolicySpec, greedy
from fuzzyq_bullet.planning.aim import Aim, towards_goal
from fuzzyq_bullet.planning.base import STEP_UNIT, Observation
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.planning.escape.escape import Escape
from fuzzyq_bullet.planning.settings import DirectSettings
from fuzzyq_bullet.planning.traffic.guard import Guard

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
        aim: What the middle line points at: the goal, or a temporary goal.
        lines: World headings of the left, middle and right lines (rad), shape (3,).
        lengths: Their free lengths (m), shape (3,).
        state: Number of the state.
        unit: S_p, the length of every step but the last one, to the goal (m).
    """

    aim: Aim
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


def sense(observation: Observation, aim: Aim | None = None) -> Sensed:
    """Cast the three lines. What stands behind the aim is not in the way.

    Args:
        observation: What is observed.
        aim: What the middle line points at; by default the goal.
    """
    aim = aim or towards_goal(observation)
    lines = (aim.bearing + LINE_ANGLE, aim.bearing, aim.bearing - LINE_ANGLE)
    left, middle, right = lengths = observation.sense(lines)
    counted = (left, math.inf if middle >= aim.distance else middle, right)
    unit = observation.unit
    return Sensed(aim, lines, lengths, state_of(counted, unit), unit)


def act(sensed: Sensed, action: int) -> Decision:
    """Return the step of an action, as it is without a safety filter."""
    return Decision(
        heading=sensed.aim.bearing + ACTIONS[action].turn,
        step=min(sensed.unit, sensed.aim.distance),
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

    def __init__(self, settings: DirectSettings, policy: Policy) -> None:
        POLICY_SPECS[settings.name].check(policy, f"the policy given to {settings.name}")
        self._best = [greedy(row) for row in policy.table]
        self._escape = Escape() if settings.breakout else None
        self._settings = settings
        self._guard = Guard() if settings.guard else None

    def decide(self, observation: Observation, /) -> Decision:
        """Return a step along the best heading."""
        if self._escape is None:
            sensed = sense(observation)
            decision = act(sensed, self._best[sensed.state])
        else:
            aim = self._escape.aim(observation, self._settings.breakout_at)
            sensed = sense(observation, aim)
            decision = _towards(aim, act(sensed, self._best[sensed.state]))
        return self._guard.limit_decision(decision, observation) if self._guard else decision


def _towards(aim: Aim, decision: Decision) -> Decision:
    """Return a decision on the way to an aim; a gap that must be met exactly is aimed at."""
    return decision._replace(
        heading=aim.bearing if aim.exact else decision.heading,
        step=0.0 if aim.hopeless else decision.step,
        **aim.told(),
    )
