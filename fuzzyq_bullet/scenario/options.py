"""Changing a scenario from outside: the planner, the seed and the drive that a caller asks for."""

from __future__ import annotations

import difflib
from typing import Any, get_args

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.planning.registry import planner_names, settings_for
from fuzzyq_bullet.scenario.models import Drive, Scenario


def with_options(
    scenario: Scenario,
    *,
    planner: str | None = None,
    seed: int | None = None,
    drive: str | None = None,
) -> Scenario:
    """Return the scenario with what is given put in place of its own.

    Args:
        scenario: The scenario as it was loaded.
        planner: Name of a planner; its parameters stay those of the scenario if it names the same
            planner, and are the defaults otherwise.
        seed: At least 0.
        drive: ``wheels`` or ``kinematic``.

    Raises:
        UserError: If one of them is not allowed.
    """
    update: dict[str, Any] = {}
    if planner is not None and planner != scenario.planner.name:
        update["planner"] = settings_for(_one_of("planner", planner, planner_names()))(name=planner)
    if seed is not None:
        if not 0 <= seed < 2**63:
            raise UserError(f"seed: must be between 0 and 2^63 - 1, got {seed}")
        update["seed"] = seed
    if drive is not None:
        update["drive"] = _one_of("drive", drive, get_args(Drive))
    return scenario.model_copy(update=update) if update else scenario


def _one_of(what: str, value: str, allowed: tuple[str, ...]) -> str:
    if value in allowed:
        return value
    close = difflib.get_close_matches(value, allowed, n=1)
    hint = f"; did you mean {close[0]!r}?" if close else ""
    raise UserError(f"{what}: unknown {what} {value!r}{hint} (allowed: {', '.join(allowed)})")
