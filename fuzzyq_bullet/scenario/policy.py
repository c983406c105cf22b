"""The policy that a scenario's planner needs: where its file lies, and whether it can be used."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.planning.registry import make_planner
from fuzzyq_bullet.planning.settings import PolicySettings
from fuzzyq_bullet.scenario.models import Scenario
from fuzzyq_bullet.scenario.problems import Problem


def with_policy_in(scenario: Scenario, folder: Path) -> Scenario:
    """Return the scenario with the path of its policy made absolute, if it names one.

    So it means the same file wherever the scenario is written to, or run from, later on.

    Args:
        scenario: A scenario as its file says.
        folder: Folder of that file, in which a relative path begins.
    """
    planner = scenario.planner
    if not isinstance(planner, PolicySettings) or planner.policy is None:
        return scenario
    path = str((folder / planner.policy).absolute())
    return scenario.model_copy(update={"planner": planner.model_copy(update={"policy": path})})


def policy_problem(scenario: Scenario, *, planner_is_given: bool) -> Problem | None:
    """Return what keeps the planner from using its policy, if anything does.

    Args:
        scenario: The scenario, its policy where it lies.
        planner_is_given: Whether the file has a key ``planner`` at all.
    """
    if not isinstance(scenario.planner, PolicySettings):
        return None
    try:
        # The planner itself knows best what fits it. What it would draw from is of no matter.
        make_planner(scenario.planner, np.random.default_rng(0))
    except UserError as error:
        loc = ("planner", "policy") if planner_is_given else ("planner",)
        return Problem(loc, error.problems[0], missing=True)
    return None
