"""What is wrong with a scenario, in words: pydantic's errors, with what is allowed."""

from __future__ import annotations

import math
import re
import typing
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from pydantic import BaseModel, ValidationError

from fuzzyq_bullet.planning.registry import DEFAULT_PLANNER, no_planner, planner_names, settings_for
from fuzzyq_bullet.quantities import ANGLE_KEYS, ModelRegistry
from fuzzyq_bullet.robots import no_robot
from fuzzyq_bullet.scenario.expectations import expect_model
from fuzzyq_bullet.scenario.layouts import LAYOUTS
from fuzzyq_bullet.scenario.models import Scenario
from fuzzyq_bullet.sensors import SENSORS
from fuzzyq_bullet.shapes import MOTIONS, SHAPES
from fuzzyq_bullet.wording import did_you_mean, shorten

Loc: TypeAlias = tuple[str | int, ...]

MAX_WORDED = 1000
"""Most mistakes put into words, so that a file of nothing else does not keep anyone waiting."""
MAX_SHOWN = 10
"""Most problems of one file that are told; the rest are counted."""


@dataclass(frozen=True, slots=True)
class Problem:
    """One mistake.

    Attributes:
        loc: The keys and indices that lead to it, as pydantic gives them.
        message: What is wrong and what is allowed.
        missing: Whether the last key of ``loc`` is one that should be there.
    """

    loc: Loc
    message: str
    missing: bool = False


def key_path(loc: Iterable[str | int]) -> str:
    """Return ``obstacles[3].radius`` for ``("obstacles", 3, "radius")``."""
    path = ""
    for part in loc:
        if isinstance(part, int):
            path += f"[{part}]"
        else:
            shown = part if part.isidentifier() and len(part) <= 60 else shorten(part)
            path += f".{shown}" if path else shown
    return path


def problems_of(error: ValidationError, data: Any) -> list[Problem]:
    """Return what is wrong with a scenario, each mistake once, the first ``MAX_WORDED`` in words.

    Args:
        error: What ``Scenario.model_validate(data)`` raised.
        data: The plain data it was given.
    """
    found: dict[Loc, Problem] = {}
    for item in error.errors(include_url=False)[:MAX_WORDED]:
        problem = _problem(dict(item), data)
        if problem.loc not in found or _is_short_list(dict(item)):
            found[problem.loc] = problem
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


def _is_short_list(error: dict[str, Any]) -> bool:
    """Tell a list with too few items, of which pydantic reports each absent item."""
    return error["type"] == "missing" and isinstance(error["loc"][-1], int)


def _known_elsewhere(loc: tuple[str | int, ...]) -> str:
    """Say which planners do have a parameter that the chosen one has not."""
    if len(loc) != 2 or loc[0] != "planner":
        return ""
    knowing = [name for name in planner_names() if loc[1] in settings_for(name).model_fields]
    return f" for this planner, known to {', '.join(knowing)}" if knowing else ""


def _problem(error: dict[str, Any], data: Any) -> Problem:
    loc = _without_tag(tuple(error["loc"]))
    kind, value, context = error["type"], error["input"], error.get("ctx", {})
    if _is_short_list(error):
        return Problem(loc[:-1], f"needs {int(loc[-1]) + 1} values, got {shorten(value)}")
    if kind == "missing":
        return Problem(loc, "is required", missing=True)
    if kind == "extra_forbidden":
        what = "unknown key" + _known_elsewhere(loc)
        return Problem(loc, _refusal(what, loc[-1], _keys_at(tuple(error["loc"][:-1]), data)))
    if kind == "union_tag_not_found":
        key = context["discriminator"].strip("'")
        names = ", ".join(_NAMES[key]())
        return Problem((*loc, key), f"is required; allowed: {names}", missing=True)
    if kind == "union_tag_invalid":
        key, tag = context["discriminator"].strip("'"), context["tag"]
        allowed = re.findall("'([^']*)'", context["expected_tags"])
        return Problem((*loc, key), _refusal(f"no {key} {shorten(tag)}", tag, allowed))
    if kind == "unknown_planner":
        return Problem(loc, no_planner(value))
    if kind == "unknown_robot":
        return Problem(loc, no_robot(value))
    if kind == "literal_error":
        allowed = re.findall("'([^']*)'", context["expected"])
        return Problem(loc, _refusal(f"got {shorten(value)}", value, allowed))
    say = _WORDING.get(kind)
    message = say(value, context) if say else _plain(error["msg"])
    if loc[-1] in ANGLE_KEYS and kind in ("less_than_equal", "greater_than_equal"):
        message += f"; radians are meant: {round(math.radians(value), 2):g}?"
    return Problem(loc, message)


def _without_tag(loc: Loc) -> Loc:
    """Drop the names that pydantic puts behind their places: shape, motion, layout and sensor."""
    if loc[0] in ("random", "sensor"):
        return loc[:1] + loc[2:]
    if loc[0] != "obstacles" or loc[2:3] == () or loc[2] not in SHAPES.names():
        return loc
    loc = loc[:2] + loc[3:]
    return loc[:3] + loc[4:] if loc[2:3] == ("motion",) else loc


def _refusal(what: str, word: Any, allowed: Sequence[str]) -> str:
    return f"{what}; {did_you_mean(word, allowed)}allowed: {', '.join(allowed)}"


def _plain(message: str) -> str:
    """Return pydantic's own words, or a validator's, on one line."""
    return " ".join(message.removeprefix("Value error, ").split())


def _expected(what: str) -> Callable[[Any, dict[str, Any]], str]:
    return lambda value, context: f"expected {what}, got {shorten(value)}"


def _bound(words: str, limit: str) -> Callable[[Any, dict[str, Any]], str]:
    def say(value: Any, context: dict[str, Any]) -> str:
        bound = context[limit]
        shown = f"{bound:g}" if isinstance(bound, float) else str(bound)
        return f"must be {words} {shown}, got {shorten(value)}"

    return say


def _length(value: Any, context: dict[str, Any]) -> str:
    bound = context.get("max_length", context.get("min_length"))
    limit = "at most" if "max_length" in context else "at least"
    got = context.get("actual_length") or "more"  # pydantic stops counting a long one
    return f"must have {limit} {bound} values, got {got}"


_WORDING: dict[str, Callable[[Any, dict[str, Any]], str]] = {
    "float_type": _expected("a number"),
    "float_parsing": _expected("a number"),
    "finite_number": lambda value, context: f"must be finite, got {shorten(value)}",
    "int_type": _expected("a whole number"),
    "int_parsing": _expected("a whole number"),
    "int_from_float": _expected("a whole number"),
    "int_parsing_size": _expected("a smaller whole number"),
    "bool_type": _expected("true or false"),
    "bool_parsing": _expected("true or false"),
    "string_type": lambda value, context: f"expected text, got {shorten(value)}; put it in quotes",
    "string_unicode": lambda value, context: "must be text that can be written as UTF-8",
    "string_too_long": lambda value, context: (
        f"must have at most {context['max_length']} characters, got {len(value)}"
    ),
    "string_too_short": lambda value, context: "is empty; leave it out or give it a value",
    "string_pattern_mismatch": lambda value, context: (
        f"got {shorten(value)}; allowed: letters, digits, '.', '-' and '_', at most 100, "
        "beginning with a letter or digit"
    ),
    "tuple_type": _expected("a list"),
    "list_type": _expected("a list"),
    "model_type": _expected("a mapping (key: value)"),
    "model_attributes_type": _expected("a mapping (key: value)"),
    "dict_type": _expected("a mapping (key: value)"),
    "too_long": _length,
    "too_short": _length,
    "greater_than": _bound("more than", "gt"),
    "greater_than_equal": _bound("at least", "ge"),
    "less_than": _bound("less than", "lt"),
    "less_than_equal": _bound("at most", "le"),
}

_NAMES = {one.key: one.names for one in (SHAPES, MOTIONS, LAYOUTS)}
"""The names that are registered, by the key that gives one."""


def _keys_at(loc: Loc, data: Any) -> list[str]:
    """Return the keys allowed in the mapping that ``loc`` leads to."""
    here: list[type[BaseModel]] = [Scenario]
    if loc[:1] == ("planner",):
        given = data.get("planner") if isinstance(data, dict) else None
        name = given.get("name", DEFAULT_PLANNER) if isinstance(given, dict) else given
        here, loc = [settings_for(str(name))], loc[1:]
    if loc[:1] == ("expect",):
        here, loc = [expect_model()], loc[1:]
    if loc[:1] == ("sensor",):
        here, loc = list(SENSORS), loc[1:]
    for part in loc:
        inner = [
            found
            for kind in here
            if isinstance(part, str) and part in kind.model_fields
            for found in _models_in(kind.model_fields[part].annotation)
        ]
        tagged = [kind for kind in here if part in _tags(kind)]
        here = inner or tagged or here
    return list(dict.fromkeys(key for kind in here for key in kind.model_fields))


def _models_in(annotation: Any) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for inner in typing.get_args(annotation):
        yield from inner if isinstance(inner, ModelRegistry) else _models_in(inner)


def _tags(kind: type[BaseModel]) -> tuple[Any, ...]:
    """Return the values that choose this model among others, as pydantic puts them into places."""
    for key in _NAMES:
        if key in kind.model_fields:
            return typing.get_args(kind.model_fields[key].annotation)
    return ()
