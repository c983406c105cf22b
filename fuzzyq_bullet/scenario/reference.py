"""The reference of the scenario file, in Markdown, made of its JSON Schema: every key, no other."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any, TypeAlias

from fuzzyq_bullet.scenario.models import scenario_schema

Node: TypeAlias = Mapping[str, Any]
"""A part of a JSON Schema."""

_HEAD = """\
# The scenario file

A scenario file says what a run is: the arena, where the robot starts, where the goal is, what
stands in the way, and who drives. It is YAML. `fuzzyq validate FILE` checks one and names every
mistake with its file, line and key. Lengths are in metres, angles in radians anticlockwise from x,
times in seconds.

```yaml
name: gap
start: {position: [1.0, 5.0]}
goal: {position: [9.0, 5.0]}
obstacles:
  - {shape: box, position: [5.0, 2.2], size: [0.4, 4.4]}
  - {shape: box, position: [5.0, 7.8], size: [0.4, 4.4]}
```

This page is made of the schema by `fuzzyq schema --markdown`; with `--plugin FILE` it has the keys
of your own file as well. `fuzzyq schema` prints the JSON Schema itself, for editors.
"""
_ELSEWHERE = {"ControllerDefinition": "a [controller](../how-to/rules.md)"}
"""Models that a page of their own explains."""


def scenario_reference() -> str:
    """Return the reference: a table of the file's keys, and one for each key that has keys."""
    schema = scenario_schema()
    models: Mapping[str, Node] = schema["$defs"]
    parts = [_HEAD, "## Keys of the file\n", _table(_keys(schema, models))]
    for key, node in schema["properties"].items():
        parts += _section(key, node, models)
    return "\n".join(parts)


def _section(key: str, node: Node, models: Mapping[str, Node]) -> Iterable[str]:
    """Yield what there is to say of the keys within a key; nothing if it has none."""
    members = [_model(one, models) for one in _choices(node) if "$ref" in one]
    if not members:
        return
    yield f"\n## `{key}`\n"
    told = node.get("description") or (members[0].get("description") if len(members) == 1 else "")
    if told:
        yield f"{_line(told)}\n"
    if len(members) == 1:
        yield _table(_keys(members[0], models))
        return
    chosen_by = next(k for k, v in members[0]["properties"].items() if "const" in v)
    yield f"`{chosen_by}` chooses:\n"
    yield _table(
        [
            (f"`{chosen_by}`", "what it is"),
            *((f"`{_name(one, chosen_by)}`", _line(one["description"])) for one in members),
        ]
    )
    yield ""
    yield _table(_keys_of_all(members, chosen_by, models))
    for within, its in {k: v for one in members for k, v in one["properties"].items()}.items():
        if any("$ref" in one and _referred(one) not in _ELSEWHERE for one in _choices(its)):
            yield from _section(within, its, models)


def _choices(node: Node) -> list[Node]:
    """Return the schemas that a value may fit, whether it is one or a list of them."""
    node = node.get("items", node)
    for word in ("oneOf", "anyOf"):
        if word in node:
            return [one for part in node[word] for one in _choices(part)]
    return [node]


def _model(node: Node, models: Mapping[str, Node]) -> Node:
    return models[_referred(node)]


def _referred(node: Node) -> str:
    return str(node["$ref"]).rsplit("/", 1)[-1]


def _name(model: Node, chosen_by: str) -> str:
    return str(model["properties"][chosen_by]["const"])


def _keys(model: Node, models: Mapping[str, Node]) -> list[tuple[str, ...]]:
    """Return a row for each key of a model."""
    rows: list[tuple[str, ...]] = [("key", "meaning", "allowed", "default")]
    for key, node in model["properties"].items():
        of_its_model = _model(node, models).get("description", "") if "$ref" in node else ""
        told = _line(node.get("description", of_its_model))
        rows.append((f"`{key}`", told, _allowed(node, key), _default(key, node, model)))
    return rows


def _keys_of_all(
    members: list[Node], chosen_by: str, models: Mapping[str, Node]
) -> list[tuple[str, ...]]:
    """Return a row for each key that any of several models has, and which of them have it."""
    found: dict[str, dict[tuple[str, ...], list[str]]] = {}
    for model in members:
        for key, *told in _keys(model, models)[1:]:
            if key != f"`{chosen_by}`":
                names = found.setdefault(key, {}).setdefault(tuple(told), [])
                names.append(_name(model, chosen_by))
    rows: list[tuple[str, ...]] = [("key", f"`{chosen_by}`", "meaning", "allowed", "default")]
    for key, differing in found.items():
        for told_of_it, names in differing.items():
            whose = "all" if len(names) == len(members) else ", ".join(names)
            rows.append((key, whose, *told_of_it))
    return rows


def _allowed(node: Node, key: str) -> str:
    """Say in words what the value of a key may be."""
    if "$ref" in node:
        return _ELSEWHERE.get(_referred(node), f"[keys of its own](#{key})")
    for word in ("oneOf", "anyOf"):
        if word in node:
            told = dict.fromkeys(_allowed(one, key) for one in node[word])
            return " or ".join(one for one in told if one != "null")
    if "const" in node or "enum" in node:
        return ", ".join(f"`{json.dumps(one)}`" for one in node.get("enum", [node.get("const")]))
    kind = node.get("type", "anything")
    if kind == "array":
        if "prefixItems" in node:
            each = [_allowed(one, key) for one in node["prefixItems"]]
            same = len(set(each)) == 1
            return f"{len(each)} × {each[0]}" if same else f"[{', '.join(each)}]"
        return f"a list{_length(node)}; each: {_allowed(node.get('items', {}), key)}"
    words = {"boolean": "`true` or `false`", "object": "keys of its own", "string": "text"}
    return words.get(kind) or f"{kind}{_bounds(node)}"


def _length(node: Node) -> str:
    """Say how many items a list may have."""
    least, most = node.get("minItems", 0), node.get("maxItems")
    if most is None:
        return f" of {least} or more" if least else ""
    return f" of {least} to {most}" if least else f" of at most {most}"


def _bounds(node: Node) -> str:
    least, most = node.get("minimum"), node.get("maximum")
    above, below = node.get("exclusiveMinimum"), node.get("exclusiveMaximum")
    if least is not None and most is not None:
        return f", {_number(least)} to {_number(most)}"
    told = [
        f"{sign} {_number(value)}"
        for sign, value in (("≥", least), (">", above), ("≤", most), ("<", below))
        if value is not None
    ]
    return f", {' and '.join(told)}" if told else ""


def _default(key: str, node: Node, model: Node) -> str:
    if key in model.get("required", ()):
        return "must be given"
    default = node.get("default")
    if default is None or isinstance(default, Mapping):
        return ""
    return f"`{json.dumps(_rounded(default), ensure_ascii=False)}`"


def _rounded(value: Any) -> Any:
    if isinstance(value, list):
        return [_rounded(one) for one in value]
    return float(f"{value:.4g}") if isinstance(value, float) else value


def _number(value: float) -> str:
    return str(value) if isinstance(value, int) else f"{value:.4g}"


def _line(text: str) -> str:
    """Return the first paragraph in one line, safe in a table."""
    return " ".join(text.partition("\n\n")[0].split()).replace("|", "\\|").replace("``", "`")


def _table(rows: list[tuple[str, ...]]) -> str:
    head, *body = rows
    lines = [head, ("---",) * len(head), *body]
    return "\n".join(f"| {' | '.join(row)} |" for row in lines)
