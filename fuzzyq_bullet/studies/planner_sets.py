"""Sets of planners that meet: the paper's five, those a person names, and what identifies them."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.learning import Policy
from fuzzyq_bullet.planning import (
    PlannerSettings,
    fuzzy_q_lambda,
    planner_names,
    q_learning,
    settings_for,
)
from fuzzyq_bullet.planning.policies import policy_of
from fuzzyq_bullet.planning.registry import no_planner
from fuzzyq_bullet.planning.settings import PolicySettings

PAPER = ("fuzzy", "improved-fuzzy", "q-learning", "q-lambda", "fuzzy-q-lambda")
"""The planners of Fig. 13 and Table 5, in the order in which they are shown."""
_EXPECTED = {**q_learning.POLICY_SPECS, "fuzzy-q-lambda": fuzzy_q_lambda.POLICY_SPEC}


def planners_of(names: str | Iterable[str]) -> dict[str, PlannerSettings]:
    """Return planners as they are set by default, each once, by their names.

    Args:
        names: Such as ``fuzzy,q-learning``.

    Raises:
        UserError: If there is no such planner.
    """
    chosen = {}
    for part in names.split(",") if isinstance(names, str) else names:
        name = part.strip()
        if name not in planner_names():
            raise UserError(f"--planners: {no_planner(name)}")
        chosen[name] = settings_for(name).model_validate({"name": name})
    return chosen


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


def hash_of(policy: Policy) -> str:
    """Return what identifies the contents of a policy."""
    return hashlib.sha256(policy.dumps().encode()).hexdigest()[:32]


def _described(settings: PlannerSettings) -> dict[str, Any]:
    told = settings.model_dump(mode="json")
    if isinstance(settings, PolicySettings) and settings.name in _EXPECTED:
        told["policy"] = hash_of(policy_of(settings, _EXPECTED[settings.name]))
    return told
