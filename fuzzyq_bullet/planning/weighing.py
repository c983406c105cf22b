"""What is weighed in which situation: the states and actions of ``fuzzy-q-lambda``.

The actions are the weights themselves, and the fuzzy rules are what a situation is made of: each
rule is a feature, present to the degree to which it fires. So Q(s, a) is smooth in what is sensed,
∂Q/∂w is the firing strengths, and Eqs. 18 and 19 can be computed (``docs/learning.md``).
"""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

import numpy as np

from fuzzyq_bullet.fuzzy.paper import DISTANCE
from fuzzyq_bullet.learning import Expected, Features
from fuzzyq_bullet.planning.routine import Situation


class Weights(NamedTuple):
    """What an action is.

    Attributes:
        step: ω1 of Eq. 17.
        turn: ω2 of Eq. 17.
        breakout_at: c_f in units of S_p: with less than this free towards the goal, break out.
    """

    step: float
    turn: float
    breakout_at: float


STEPS = (1.0, 2.0)
TURNS = (0.5, 1.0)
BREAKOUTS = (1.0, 4.0)
"""Not before it must, or almost as soon as anything is seen to stand in the way."""
ACTIONS = tuple(Weights(*one) for one in product(STEPS, TURNS, BREAKOUTS))
ACTION_NAMES = tuple(f"ω1 {a.step:g}, ω2 {a.turn:g}, c_f {a.breakout_at:g}" for a in ACTIONS)

SIDES = ("even", "small", "big")
"""Of |Df|: ZO, NS or PS, NB or PB. What is learned about one side serves for the other."""
STATE_NAMES = ("clear", *(f"{near} {side}" for near in DISTANCE.labels for side in SIDES))


def features_of(situation: Situation) -> Features:
    """Return φ(s), which sums to 1: the firing strengths (Eq. 2), or ``clear`` and nothing else.

    Args:
        situation: What is sensed where an encounter begins.
    """
    if situation.clear:
        return Features.one_hot(0)
    big, small, even, as_small, as_big = np.array(situation.inferred.rules).T
    strengths = np.stack([even, small + as_small, big + as_big], axis=1).ravel()
    total = float(strengths.sum())
    uniform = np.full(strengths.size, 1.0 / strengths.size)
    firing = strengths / total if total > 0.0 else uniform
    return Features.of(np.concatenate([[0.0], firing]))


EXPECTED = Expected("fuzzy-q-lambda", STATE_NAMES, ACTION_NAMES, "linear-q-lambda")
"""What its policies must look like."""
