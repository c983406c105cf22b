"""Which episodes Table 5 is made of: the paper's five planners, and the rows that honesty needs."""

from __future__ import annotations

from typing import Any

from fuzzyq_bullet.experiments.learning_gain.candidates import ONE, label_of, settings_of
from fuzzyq_bullet.experiments.success.contenders import PAPER
from fuzzyq_bullet.planning import PlannerSettings, settings_for
from fuzzyq_bullet.planning.fuzzy_q_lambda import Weights

COUNT = 50
"""Obstacles of Table 5."""
RUNS = 20
"""Its repetitions."""
PAPER_STEPS = {
    "fuzzy": 2342,
    "improved-fuzzy": 115,
    "q-learning": 128,
    "q-lambda": 146,
    "fuzzy-q-lambda": 82,
}
"""Table 5 as printed: average number of steps."""


def contenders(pair: Weights) -> dict[str, PlannerSettings]:
    """Return all planners of the table by what rows call them.

    The paper's five as they are set by default (fixed weights are 0.5/0.5); then the improved fuzzy
    planner with weights 1/1, which nobody had to learn, and with the best fixed pair. Without these
    two, longer steps alone would look like something learned.

    Args:
        pair: The best fixed pair.
    """
    planners = {name: _usual(name) for name in PAPER}
    return planners | {label_of(weights): settings_of(weights) for weights in (ONE, pair)}


def roles(pair: Weights) -> dict[str, str]:
    """Return what the extra rows are called for a person, by what rows call the planner."""
    if label_of(pair) == label_of(ONE):
        return {label_of(ONE): "fixed 1/1, the best pair"}
    words = f"best pair {pair.step:g}/{pair.turn:g}"
    return {label_of(ONE): "fixed 1/1", label_of(pair): words}


def _usual(name: str) -> PlannerSettings:
    given: dict[str, Any] = {"name": name}
    return settings_for(name).model_validate(given)
