"""Mistakes in a file, in words: where it stands, what is wrong, and what is allowed instead."""

from __future__ import annotations

import itertools
import re
import typing
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from fuzzyq_bullet.quantities import ModelRegistry
from fuzzyq_bullet.reading.yaml_tree import Node, decimal_comma
from fuzzyq_bullet.wording import did_you_mean, shorten

Loc: TypeAlias = tuple[str | int, ...]

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


def lines_of(problems: list[Problem], more: int, tree: Node, where: str) -> list[str]:
    """Return the printed lines of the problems, in the order of the file's lines.

    ``more`` is the number of problems beside those given.
    """
    told = []
    for problem in problems:
        line, shown = _locate(problem, tree)
        told.append((line, f"{where}:{line}: {key_path(shown)}: {problem.message}"))
    told.sort(key=lambda entry: entry[0])
    return first_lines([text for _, text in told], where, more)


def first_lines(lines: Sequence[str], where: str, more: int = 0) -> list[str]:
    """Return the first ``MAX_SHOWN`` lines, and one that counts the others, if there are any.

    Args:
        lines: A line for each mistake.
        where: The file or scenario that has them.
        more: Number of mistakes beside those given.
    """
    more += max(0, len(lines) - MAX_SHOWN)
    return [*lines[:MAX_SHOWN], *([f"{where}: and {more} more"] if more else [])]


def _locate(problem: Problem, tree: Node) -> tuple[int, Loc]:
    """Return the line of a problem and its path in the file.

    A key that is absent is shown behind the mapping that should hold it, on that one's line.
    Parts that pydantic adds and the file does not have are passed over, unless it has none of them.
    """
    node, line, shown = tree, tree.line, ()  # type: Node, int, Loc
    for i, part in enumerate(problem.loc):
        if part in node.children:
            line = node.line_of(part)
            node = node.children[part]
            shown += (part,)
        elif problem.missing and i == len(problem.loc) - 1:
            shown += (part,)
    return line, shown or problem.loc


def is_short_list(error: dict[str, Any]) -> bool:
    """Tell a list with too few items, of which pydantic reports each absent item."""
    return error["type"] == "missing" and isinstance(error["loc"][-1], int)


def is_of_its_items(error: dict[str, Any]) -> bool:
    """Tell a list that is long enough, of which pydantic counts only the items that are right."""
    value, bound = error["input"], error.get("ctx", {}).get("min_length", 0)
    return error["type"] == "too_short" and isinstance(value, list | tuple) and len(value) >= bound


def problem_of(error: dict[str, Any], loc: Loc, keys: Sequence[str]) -> Problem:
    """Return one of pydantic's errors in words.

    Args:
        error: One of ``ValidationError.errors()``.
        loc: Where it is in the file.
        keys: The keys that are allowed beside an unknown one.
    """
    kind, value, context = error["type"], error["input"], error.get("ctx", {})
    if is_short_list(error):
        return Problem(loc[:-1], f"needs {int(loc[-1]) + 1} values, got {shorten(value)}")
    if kind == "missing":
        return Problem(loc, "is required", missing=True)
    if kind == "extra_forbidden":
        return Problem(loc, refusal("unknown key", loc[-1], keys))
    if kind == "literal_error":
        allowed = re.findall("'([^']*)'", context["expected"])
        return Problem(loc, refusal(f"got {shorten(value)}", value, allowed))
    say = _WORDING.get(kind)
    return Problem(loc, say(value, context) if say else _plain(error["msg"]))


def keys_at(
    here: list[type[BaseModel]],
    loc: Loc,
    tags: Callable[[type[BaseModel]], tuple[Any, ...]] = lambda kind: (),
) -> list[str]:
    """Return the keys allowed in the mapping that ``loc`` leads to.

    Args:
        here: What the outermost mapping may be.
        loc: The keys and indices.
        tags: The values that choose a model among others, as pydantic puts them into places.
    """
    for part in loc:
        inner = [
            found
            for kind in here
            if isinstance(part, str) and part in kind.model_fields
            for found in _models_of(kind.model_fields[part])
        ]
        tagged = [kind for kind in here if part in tags(kind)]
        here = inner or tagged or here
    fields = (one for kind in here for one in kind.model_fields.items())
    return list(dict.fromkeys(field.alias or name for name, field in fields))


def _models_of(field: FieldInfo) -> Iterator[type[BaseModel]]:
    registries = [one for one in field.metadata if isinstance(one, ModelRegistry)]
    return itertools.chain(*registries) if registries else _models_in(field.annotation)


def _models_in(annotation: Any) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for inner in typing.get_args(annotation):
        yield from inner if isinstance(inner, ModelRegistry) else _models_in(inner)


def refusal(what: str, word: Any, allowed: Sequence[str]) -> str:
    """Return what is refused, the word that may have been meant, and all that are allowed."""
    return f"{what}; {did_you_mean(word, allowed)}allowed: {', '.join(allowed)}"


def _plain(message: str) -> str:
    """Return pydantic's own words, or a validator's, on one line."""
    return " ".join(message.removeprefix("Value error, ").split())


def _expected(what: str) -> Callable[[Any, dict[str, Any]], str]:
    return lambda value, context: f"expected {what}, got {shorten(value)}"


def _number(value: Any, context: dict[str, Any]) -> str:
    comma = decimal_comma(value) if isinstance(value, str) else ""
    return comma or f"expected a number, got {shorten(value)}"


def _bound(words: str, limit: str) -> Callable[[Any, dict[str, Any]], str]:
    def say(value: Any, context: dict[str, Any]) -> str:
        bound = context[limit]
        shown = f"{bound:g}" if isinstance(bound, float) else str(bound)
        return f"must be {words} {shown}, got {shorten(value)}"

    return say


def _length(value: Any, context: dict[str, Any]) -> str:
    bound = context.get("max_length", context.get("min_length"))
    limit = "at most" if "max_length" in context else "at least"
    got = context.get("actual_length")  # None of a long one: pydantic stops counting
    return f"must have {limit} {bound} values, got {'more' if got is None else got}"


_WORDING: dict[str, Callable[[Any, dict[str, Any]], str]] = {
    "float_type": _number,
    "float_parsing": _number,
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
