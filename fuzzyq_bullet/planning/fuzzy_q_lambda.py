"""The planner ``fuzzy-q-lambda``, the paper's own: the improved one with learned weights.

Learning which weights serve is a semi-Markov decision process. A state is what the robot senses,
with the fuzzy rules as its features: each is present to the degree to which its rule fires. So
Q(s, a) is smooth in what is sensed, ∂Q/∂w is the firing strengths, and Eqs. 18 and 19 can be
computed. An action is a choice of weights, and it is an option: it stays in force until its
termination, a whole encounter later (``docs/learning.md``).
"""

from __future__ import annotations

import math
from itertools import product
from typing import NamedTuple

import numpy as np

from fuzzyq_bullet.fuzzy.paper import DISTANCE
from fuzzyq_bullet.learning import Features, Policy, PolicySpec, greedy
from fuzzyq_bullet.planning.base import STEP_UNIT, Observation
from fuzzyq_bullet.planning.decision import Decision, Mode
from fuzzyq_bullet.planning.fuzzy import Situation
from fuzzyq_bullet.planning.improved_fuzzy import ImprovedFuzzyBase
from fuzzyq_bullet.planning.settings import FuzzyQLambdaSettings


class Weights(NamedTuple):
    """What an action sets.

    Attributes:
        step: ω1 of Eq. 17.
        turn: ω2 of Eq. 17.
        breakout_at: c_f in units of S_p: with less than this free towards the goal, break out.
    """

    step: float
    turn: float
    breakout_at: float


STEPS = (5.0, 10.0)
"""Slower near obstacles, or almost always at full speed: the safety filter sees to the rest."""
TURNS = (0.25, 0.5)
BREAKOUTS = (2.5, 4.0)
"""Break out halfway, or almost as soon as an obstacle is seen ahead."""
ACTIONS = tuple(Weights(*one) for one in product(STEPS, TURNS, BREAKOUTS))
ACTION_NAMES = tuple(f"ω1 {a.step:g}, ω2 {a.turn:g}, c_f {a.breakout_at:g}" for a in ACTIONS)

SIDES = ("even", "small", "big")
"""Of |Df|: ZO; NS or PS; NB or PB. What is learned on one side counts on the other too."""
STATE_NAMES = ("clear", *(f"{near} {side}" for near in DISTANCE.labels for side in SIDES))


def features_of(situation: Situation) -> Features:
    """Return φ(s), which sums to 1: the firing strengths (Eq. 2), or only ``clear``.

    Args:
        situation: What is sensed where an option begins.
    """
    if situation.clear:
        return Features.one_hot(0)
    big, small, even, as_small, as_big = np.array(situation.inferred.rules).T
    strengths = np.stack([even, small + as_small, big + as_big], axis=1).ravel()
    total = float(strengths.sum())
    uniform = np.full(strengths.size, 1.0 / strengths.size)
    firing = strengths / total if total > 0.0 else uniform
    return Features.of(np.concatenate([[0.0], firing]))


POLICY_SPEC = PolicySpec("fuzzy-q-lambda", STATE_NAMES, ACTION_NAMES, "linear-q-lambda")
"""What its policies look like."""

SHORTEST = 1.0
"""How much nearer to the goal the robot comes with an option at least (S_p)."""
LONGEST = 5.0
"""After coming so much nearer it has passed everything that its lines could show before (S_p)."""


class OptionTermination:
    """Ends an option where an encounter with obstacles, or a clear stretch between two, ends.

    That is where the line to the goal becomes clear or is no longer clear, or after ``LONGEST``;
    but only where the robot is nearer to the goal than ever before, and in the routine mode. So
    everything that follows from a choice counts for it, a detour included. As there are only so
    many options on the way to the goal, whatever ends with constant weights ends with these too
    (``docs/escape.md``).
    """

    def __init__(self) -> None:
        self._nearest = math.inf
        self._began = math.inf
        self._clear = False

    def ends(self, to_goal: float, mode: Mode, *, clear: bool, unit: float = STEP_UNIT) -> bool:
        """Return whether the option ends here, and the next begins. Call it once a decision.

        Args:
            to_goal: Distance to the goal (m).
            mode: Of the aim: an option ends only where that is the goal.
            clear: Whether nothing is seen on the line to the goal.
            unit: S_p (m).
        """
        nearest, self._nearest = self._nearest, min(self._nearest, to_goal)
        least = unit * (SHORTEST if clear != self._clear else LONGEST)
        if mode != "routine" or to_goal > nearest or to_goal > self._began - least:
            return False
        self._began, self._clear = to_goal, clear
        return True


class FuzzyQLambdaPlanner(ImprovedFuzzyBase):
    """Takes the weights of the greatest learned value, for an encounter at a time.

    Args:
        settings: The planner's settings.
        policy: What it learned: a row of weights for each feature, a column for each action.
    """

    def __init__(self, settings: FuzzyQLambdaSettings, policy: Policy) -> None:
        super().__init__(settings)
        self._table = policy.array()
        self._option = OptionTermination()
        self._chosen = ACTIONS[0]

    def decide(self, observation: Observation, /) -> Decision:
        """Return the decision with the weights that were best where the option began (Step 10)."""
        situation = self.sense(observation)
        seen = situation
        if self._option.ends(seen.to_goal, self.mode, clear=seen.clear, unit=seen.unit):
            self._chosen = self._best(situation)
        return self.act(observation, situation, self._chosen[:2], self._chosen.breakout_at)

    def _best(self, situation: Situation) -> Weights:
        state = features_of(situation)
        # Added row by row, as in learning: matrix products round differently on other processors.
        values = (self._table[state.indices] * state.values[:, None]).sum(axis=0)
        return ACTIONS[greedy(values.tolist())]
