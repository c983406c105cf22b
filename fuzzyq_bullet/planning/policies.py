"""Which policy a planner uses: the one its settings name, or the one that is shipped."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.learning import Policy, PolicySpec, load_policy
from fuzzyq_bullet.planning.settings import PolicySettings
from fuzzyq_bullet.platforms import asset

SHIPPED = ("q-learning", "q-lambda", "fuzzy-q-lambda")
"""Planners for which a policy is shipped."""


def shipped(planner: str) -> Path:
    """Return the path of the policy that is shipped for a planner."""
    return asset("policies") / f"{planner}.json"


def policy_of(settings: PolicySettings, expected: PolicySpec | None = None) -> Policy:
    """Return the policy for a planner; the same one again as long as its file stays the same.

    Args:
        settings: The planner's settings.
        expected: What its policy must be like, if that is known yet.

    Raises:
        UserError: If the file is missing, damaged, or the policy of something else.
    """
    path = shipped(settings.name) if settings.policy is None else Path(settings.policy)
    try:
        state = path.stat()
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or error
        remedy = f"make one with fuzzyq train {settings.name}"
        if settings.policy is None and settings.name in SHIPPED:
            remedy = "install fuzzyq_bullet again, or make policies in its checkout"
        elif settings.policy is None:
            remedy += ", and name it as planner.policy; none is shipped for this planner"
        raise UserError(
            f"{path}: the policy of {settings.name} cannot be read: {why}; {remedy}"
        ) from error
    policy = _loaded(path, state.st_mtime_ns, state.st_size)
    if expected is not None:
        expected.check(policy, str(path))
    return policy


@lru_cache(maxsize=16)
def _loaded(path: Path, changed: int, size: int) -> Policy:
    return load_policy(path)
