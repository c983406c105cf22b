"""What tells one field from another, and a policy that was learned in one from those of others."""

from __future__ import annotations

import hashlib
import json

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.planning.fuzzy_q_lambda import field_policy
from fuzzyq_bullet.scenario.models import Scenario


def field_digest(scenario: Scenario) -> str:
    """Return a hash of a realised scenario's field: arena, obstacles, goal and robot."""
    told = scenario.model_dump(mode="json", include={"arena", "obstacles", "goal", "robot"})
    return hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()[:32]


def refuse_via(scenario: Scenario, why: str) -> None:
    """Make sure that a scenario leads straight to its goal, where nothing else is understood.

    Raises:
        UserError: If it has via points.
    """
    if scenario.via:
        raise UserError(f"{scenario.name}: via: {why}; leave out the via points")


def refuse_other_field(scenario: Scenario) -> None:
    """Make sure that what the planner of a realised scenario has learned was learned there.

    Raises:
        UserError: If it was learned in another field, or cannot be used.
    """
    policy = field_policy(scenario.planner)
    if policy is not None:
        refuse_via(scenario, "a policy of a field tells the time to its goal alone")
    if policy is not None and policy.scenario != field_digest(scenario):
        raise UserError(
            f"{getattr(scenario.planner, 'policy', None)}: was learned in another field: arena, "
            "obstacles, goal or robot differ; learn this one with fuzzyq train fuzzy-q-lambda "
            f"--scenario FILE --seed {scenario.seed}"
        )
