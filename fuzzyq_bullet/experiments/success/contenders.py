"""The planners that meet: the paper's five, and what identifies those that have learned."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from typing import Any

from fuzzyq_bullet.planning import PlannerSettings, fuzzy_q_lambda, q_learning
from fuzzyq_bullet.planning.policies import policy_of
from fuzzyq_bullet.planning.settings import PolicySettings

PAPER = ("fuzzy", "improved-fuzzy", "q-learning", "q-lambda", "fuzzy-q-lambda")
"""The planners of Fig. 13 and Table 5, in the order in which they are shown."""
_EXPECTED = {**q_learning.POLICY_SPECS, "fuzzy-q-lambda": fuzzy_q_lambda.POLICY_SPEC}


def described(planners: Mapping[str, PlannerSettings]) -> dict[str, Any]:
    """Return what the rows of planners depend on, as JSON can say it.

    A policy goes in by its contents and not by its path: after another training the same path
    means another planner.

    Args:
        planners: By what rows call them.

    Raises:
        UserError: If a policy is missing or damaged.
    """
    return {label: _described(settings) for label, settings in planners.items()}


def in_order(names: Sequence[str]) -> tuple[str, ...]:
    """Return names, each once: the paper's first and in its order, then the rest."""
    known = [name for name in PAPER if name in names]
    return tuple(dict.fromkeys((*known, *names)))


def _described(settings: PlannerSettings) -> dict[str, Any]:
    told = settings.model_dump(mode="json")
    if isinstance(settings, PolicySettings) and settings.name in _EXPECTED:
        policy = policy_of(settings, _EXPECTED[settings.name])
        told["policy"] = hashlib.sha256(policy.dumps().encode()).hexdigest()[:32]
    return told
