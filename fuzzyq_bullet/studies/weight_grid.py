"""The fixed weights that learned ones are held against: all that learning may choose, and more.

A search over fewer values than the learned planner has would let it win for having more of them.
"""

from __future__ import annotations

from itertools import product, starmap

from fuzzyq_bullet.planning import ImprovedFuzzySettings
from fuzzyq_bullet.planning.fuzzy_q_lambda import ACTIONS, STEPS, TURNS, Weights

USUAL_BREAKOUT = ImprovedFuzzySettings().breakout_at
"""c_f in S_p of a planner that is told nothing else."""

MORE_STEPS = (0.5, 1.0, 1.5, 2.0)
MORE_TURNS = (0.25, 0.5, 1.0, 1.5)
MORE_BREAKOUTS = (2.0, 3.0, 5.0)

HALF = Weights(0.5, 0.5, USUAL_BREAKOUT)
"""What the paper holds its learned weights against."""
ONE = Weights(1.0, 1.0, USUAL_BREAKOUT)
"""What the controller says, as it says it."""

PAIRS: tuple[Weights, ...] = tuple(
    dict.fromkeys(
        (
            HALF,
            ONE,
            *(Weights(*pair, USUAL_BREAKOUT) for pair in product(STEPS, TURNS)),
            *(Weights(*pair, USUAL_BREAKOUT) for pair in product(MORE_STEPS, MORE_TURNS)),
        )
    )
)
"""(ω1, ω2) with the usual c_f: those that learning chooses from, and more around them."""
TRIPLES: tuple[Weights, ...] = tuple(
    dict.fromkeys((*PAIRS, *ACTIONS, *starmap(Weights, product(STEPS, TURNS, MORE_BREAKOUTS))))
)
"""(ω1, ω2, c_f): the pairs too, so that the best triple is never worse than the best pair there."""


def label_of(weights: Weights) -> str:
    """Return what rows call a planner with these weights; no two of them share it."""
    label = f"fixed-{weights.step:g}-{weights.turn:g}"
    return label if weights.breakout_at == USUAL_BREAKOUT else f"{label}-{weights.breakout_at:g}"


def words_of(weights: Weights) -> str:
    """Return the weights for a person: ``1/0.5``, and c_f where it is another than usual."""
    pair = f"{weights.step:g}/{weights.turn:g}"
    return pair if weights.breakout_at == USUAL_BREAKOUT else f"{pair}, c_f {weights.breakout_at:g}"


def settings_of(weights: Weights) -> ImprovedFuzzySettings:
    """Return the planner that always has these weights."""
    return ImprovedFuzzySettings(
        weights=(weights.step, weights.turn), breakout_at=weights.breakout_at
    )
