"""What is wrong with a scenario, in words: pydantic's errors, with what is allowed."""

from __future__ import annotations

import math
import re
import typing
from dataclasses import replace
from typing import Any

from pydantic import BaseModel, ValidationError

from fuzzyq_bullet.planning.registry import DEFAULT_PLANNER, no_planner, planner_names, settings_for
from fuzzyq_bullet.quantities import ANGLE_KEYS
from fuzzyq_bullet.reading.problems import (
    MAX_SHOWN,
    Loc,
    Problem,
    is_of_its_items,
    is_short_list,
    keys_at,
    problem_of,
    refusal,
)
from fuzzyq_bullet.robots import no_robot
from fuzzyq_bullet.scenario.expectations import expect_model
from fuzzyq_bullet.scenario.layouts import LAYOUTS
from fuzzyq_bullet.scenario.models import Scenario
from fuzzyq_bullet.sensors import SENSORS
from fuzzyq_bullet.shapes import MOTIONS, SHAPES
from fuzzyq_bullet.wording import shorten

MAX_WORDED = 1000
"""Most mistakes put into words, so that a file of nothing else does not keep anyone waiting."""


def problems_of(error: ValidationError, data: Any) -> list[Problem]:
    """Return what is wrong with a scenario, each mistake once, the first ``MAX_WORDED`` in words.

    Args:
        error: What ``Scenario.model_validate(data)`` raised.
        data: The plain data it was given.
    """
    found: dict[Loc, Problem] = {}
    for item in error.errors(include_url=False)[:MAX_WORDED]:
        if is_of_its_items(dict(item)):
            continue  # each of them that is wrong is told
        problem = _problem(dict(item), data)
        if problem.loc not in found or is_short_list(dict(item)):
            found[problem.loc] = problem
    for *motion, key in list(found):
        if key == "file":  # of a trace, whose rows are missing for that reason alone
            found.pop((*motion, "poses"), None)
    return list(found.values())


def unknown_names(error: ValidationError) -> list[str]:
    """Return what a scenario names that is not registered here, such as ``the shape 'pillar'``."""
    names = []
    for item in error.errors(include_url=False)[:MAX_WORDED]:
        if item["type"] == "union_tag_invalid":
            key = item["ctx"]["discriminator"].strip("'")
            kind = "motion" if key == MOTIONS.key else key
            names.append(f"the {kind} {shorten(item['ctx']['tag'])}")
        elif item["type"] == "unknown_robot":
            names.append(f"the robot {shorten(item['input'])}")
    return list(dict.fromkeys(names))[:MAX_SHOWN]


def _whose_key(loc: tuple[str | int, ...], data: Any) -> str:
    """Say which planner does not have a parameter, and which do."""
    if len(loc) != 2 or loc[0] != "planner":
        return ""
    knowing = [name for name in planner_names() if loc[1] in settings_for(name).model_fields]
    known = f", known to {', '.join(knowing)}" if knowing else ""
    return f" for the planner {_planner_in(data)}{known}"


def _planner_in(data: Any) -> str:
    """Return the name of the planner that plain data asks for."""
    given = data.get("planner") if isinstance(data, dict) else None
    return str(given.get("name", DEFAULT_PLANNER) if isinstance(given, dict) else given)


def _problem(error: dict[str, Any], data: Any) -> Problem:
    loc = _without_tag(tuple(error["loc"]))
    kind, value, context = error["type"], error["input"], error.get("ctx", {})
    if kind == "extra_forbidden" and (whose := _whose_key(loc, data)):
        keys = _keys_at(tuple(error["loc"][:-1]), data)
        return Problem(loc, refusal("unknown key" + whose, loc[-1], keys))
    if kind == "union_tag_not_found":
        key = context["discriminator"].strip("'")
        names = ", ".join(_NAMES[key]())
        return Problem((*loc, key), f"is required; allowed: {names}", missing=True)
    if kind == "union_tag_invalid":
        key, tag = context["discriminator"].strip("'"), context["tag"]
        allowed = re.findall("'([^']*)'", context["expected_tags"])
        return Problem((*loc, key), refusal(f"no {key} {shorten(tag)}", tag, allowed))
    if kind == "unknown_planner":
        return Problem(loc, no_planner(value))
    if kind == "unknown_robot":
        return Problem(loc, no_robot(value))
    keys = _keys_at(tuple(error["loc"][:-1]), data) if kind == "extra_forbidden" else []
    problem = problem_of(error, loc, keys)
    if kind in ("model_type", "model_attributes_type") and (right := _as_mapping(loc, value)):
        return replace(problem, message=f"{problem.message}; write {right}")
    if loc[-1] in ANGLE_KEYS and kind in ("less_than_equal", "greater_than_equal"):
        turned = f"; radians are meant: {round(math.radians(value), 2):g}?"
        return replace(problem, message=problem.message + turned)
    return problem


def _as_mapping(loc: Loc, value: Any) -> str:
    """Return how a value that stands alone is written as the mapping that belongs there."""
    key = _ALONE.get(str(loc[0])) if len(loc) == 1 or loc[0] == "via" else None
    if key is None:
        return ""
    if key in ("position", "size"):
        numbers = isinstance(value, list) and len(value) == 2
        fits = numbers and all(type(one) in (int, float) for one in value)
    else:
        fits = isinstance(value, str) and value.replace("_", "").isalnum()
    shown = value if isinstance(value, str) else shorten(value)
    return f"{{{key}: {shown}}}" if fits else ""


def _without_tag(loc: Loc) -> Loc:
    """Drop the names that pydantic puts behind their places: shape, motion, layout and sensor."""
    if loc[0] in ("random", "sensor"):
        return loc[:1] + loc[2:]
    if loc[0] != "obstacles" or loc[2:3] == () or loc[2] not in SHAPES.names():
        return loc
    loc = loc[:2] + loc[3:]
    return loc[:3] + loc[4:] if loc[2:3] == ("motion",) else loc


_ALONE = {
    **dict.fromkeys(("start", "goal", "via"), "position"),
    "arena": "size",
    "robot": "model",
    "expect": "outcome",
}
"""The key that a value which stands alone was meant for."""
_NAMES = {one.key: one.names for one in (SHAPES, MOTIONS, LAYOUTS)}
"""The names that are registered, by the key that gives one."""


def _keys_at(loc: Loc, data: Any) -> list[str]:
    """Return the keys allowed in the mapping that ``loc`` leads to."""
    here: list[type[BaseModel]] = [Scenario]
    if loc[:1] == ("planner",):
        here, loc = [settings_for(_planner_in(data))], loc[1:]
    if loc[:1] == ("expect",):
        here, loc = [expect_model()], loc[1:]
    if loc[:1] == ("sensor",):
        here, loc = list(SENSORS), loc[1:]
    return keys_at(here, loc, _tags)


def _tags(kind: type[BaseModel]) -> tuple[Any, ...]:
    """Return the values that choose this model among others, as pydantic puts them into places."""
    for key in _NAMES:
        if key in kind.model_fields:
            return typing.get_args(kind.model_fields[key].annotation)
    return ()
