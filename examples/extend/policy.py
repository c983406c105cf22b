"""A planner that learns: the states and actions of ``q-lambda``, with a λ that does something.

    fuzzyq train long-memory --plugin examples/extend/policy.py --out my/policy.json
    fuzzyq run my-scenario.yaml --plugin examples/extend/policy.py

In the scenario file: ``planner: {name: long-memory, policy: my/policy.json}``.
"""

from __future__ import annotations

from typing import Literal

from fuzzyq_bullet import Decision, Observation, register_planner
from fuzzyq_bullet.learning import PolicySpec, QLambda, Schedule, Setup, greedy
from fuzzyq_bullet.planning import policy_of
from fuzzyq_bullet.planning.q_learning import ACTION_NAMES, STATE_NAMES, act, sense
from fuzzyq_bullet.planning.settings import PolicySettings
from fuzzyq_bullet.training.problems import DirectProblem
from fuzzyq_bullet.training.registry import Recipe, register_recipe

SPEC = PolicySpec("long-memory", STATE_NAMES, ACTION_NAMES, "q-lambda")
"""What its policies look like: planner, states, actions, learner."""


class LongMemorySettings(PolicySettings):
    """The keys of the scenario file: ``name`` and ``policy``."""

    name: Literal["long-memory"] = "long-memory"


class LongMemoryPlanner:
    """Does in every state what its policy says is worth most."""

    def __init__(self, settings: LongMemorySettings) -> None:
        self._table = policy_of(settings, SPEC).table

    def decide(self, observation: Observation, /) -> Decision:
        """Return the next step."""
        sensed = sense(observation)
        return act(sensed, greedy(self._table[sensed.state]))


register_planner(
    "long-memory", LongMemorySettings, lambda settings, rng: LongMemoryPlanner(settings)
)
register_recipe(
    Recipe(
        planner="long-memory",
        spec=SPEC,
        problem=DirectProblem,  # what is a state, an action, a reward: learning.Problem
        learner=lambda: QLambda(*SPEC.shape),
        setup=lambda episodes, seed: Setup(episodes, seed, trace_decay=Schedule(0.9)),
    )
)
