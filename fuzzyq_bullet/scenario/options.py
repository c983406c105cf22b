"""Scenarios that no file says: one with what a caller asks for, and tasks made of a seed alone."""

from __future__ import annotations

from typing import Any, get_args

import numpy as np
from pydantic import ValidationError

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.planning.registry import no_planner, planner_names, settings_for
from fuzzyq_bullet.planning.settings import PlannerSettings
from fuzzyq_bullet.reading.problems import key_path
from fuzzyq_bullet.scenario.models import Drive, Scenario
from fuzzyq_bullet.scenario.places import Arena, Goal, Start
from fuzzyq_bullet.wording import not_one_of, shorten

MAX_SEED = 2**63 - 1
SIDE = 10.0
"""Of the arena (m)."""
_INSET = 1.0
"""How far from both walls a corner's place is (m)."""
_JITTER = 0.3
"""How far a place is moved along each axis, at most (m)."""


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
        planner: Name of a planner. It takes over what the scenario sets for its own planner, such
            as the weights, as far as it has parameters of the same names; the rest are defaults.
        seed: 0 to 2⁶³ − 1.
        drive: ``wheels`` or ``kinematic``.

    Raises:
        UserError: If one of them is not allowed, or the planner does not accept what the scenario
            sets.
    """
    check_options(planner=planner, seed=seed, drive=drive)
    update: dict[str, Any] = {}
    if planner is not None and planner != scenario.planner.name:
        update["planner"] = _settings_of(planner, scenario.planner)
    if seed is not None:
        update["seed"] = seed
    if drive is not None:
        update["drive"] = drive
    return scenario.model_copy(update=update) if update else scenario


def _settings_of(planner: str, before: PlannerSettings) -> PlannerSettings:
    """Return the settings of a planner with what was set for another; it drives alike thus."""
    model = settings_for(planner)
    known = model.model_fields.keys() - {"name", "policy"}  # what another learned never fits
    kept = before.model_dump(include=known, exclude_unset=True)
    try:
        return model.model_validate({**kept, "name": planner})
    except ValidationError as error:
        problems = []
        for item in error.errors(include_url=False):
            what = f"planner: {shorten(planner)} does not accept the scenario's"
            place = key_path(("planner", *item["loc"]))
            problems.append(f"{what} {place}: {' '.join(item['msg'].split())}")
        raise UserError(*problems) from error


def check_options(
    *, planner: str | None = None, seed: int | None = None, drive: str | None = None
) -> None:
    """Make sure that options are allowed, whatever the scenario.

    Raises:
        UserError: If one is not; names the option.
    """
    if planner is not None and planner not in planner_names():
        raise UserError(f"planner: {no_planner(planner)}")
    if seed is not None and not 0 <= seed <= MAX_SEED:
        raise UserError(f"seed: must be from 0 to {MAX_SEED}, got {seed}")
    if drive is not None and drive not in get_args(Drive):
        raise UserError(f"drive: {not_one_of('drive', drive, get_args(Drive))}")


def cellular_task(seed: int) -> Scenario:
    """Return a corridor of clumped pillars, 5 m wide, with 10 m from the start to the goal.

    Its sides are open, the goal has a radius of 1 m, and the robot may drive at 1 m/s. The seed
    also chooses how densely it is filled, 0.15 to 0.30, and how often smoothed, 2 to 4 times. This
    is how the literature draws the worlds in which it scores navigation.

    Args:
        seed: 0 to 2⁶³ − 1.
    """
    return Scenario.model_validate(
        {
            "name": f"cellular-{seed}",
            "seed": seed,
            "arena": Arena(size=(12.0, 5.0), walls=False),
            "start": Start(position=(1.0, 2.5)),
            "goal": Goal(position=(11.0, 2.5), radius=1.0),
            "robot": {"max_speed": 1.0},
            "random": {
                "layout": "cellular",
                "fill": (0.15, 0.2, 0.25, 0.3)[seed % 4],
                "smoothing": (2, 3, 4)[seed // 4 % 3],
            },
        }
    )


def random_task(seed: int, *, count: int | None = 50, layout: str = "scatter") -> Scenario:
    """Return a scenario with start and goal near two different corners of the arena.

    Its obstacles are still to be drawn (``realise``), with the same seed. Which corners, and where
    about them, has a stream of the seed to itself: layouts and counts can be compared on the same
    starts and goals.

    Args:
        seed: 0 to 2⁶³ − 1.
        count: How many obstacles, for layouts that have a count; None for those without.
        layout: Name of a layout.

    Raises:
        pydantic.ValidationError: If the layout does not exist, or has no count.
    """
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(2,)))
    corners = rng.permutation(4)[:2]
    far = np.column_stack([corners % 2, corners // 2]).astype(bool)
    places = np.where(far, SIDE - _INSET, _INSET) + rng.uniform(-_JITTER, _JITTER, (2, 2))
    start, goal = ((float(x), float(y)) for x, y in places.round(4))
    return Scenario.model_validate(
        {
            "name": f"{layout}-{seed}",
            "seed": seed,
            "arena": Arena(size=(SIDE, SIDE)),
            "start": Start(position=start),
            "goal": Goal(position=goal),
            "random": {"layout": layout} if count is None else {"layout": layout, "count": count},
        }
    )
