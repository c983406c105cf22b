"""A controller as YAML: the form of ``fuzzy.definition``, with the rules as a table."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from fuzzyq_bullet.reading.yaml_tree import Node, read_tree

if TYPE_CHECKING:
    from fuzzyq_bullet.fuzzy.definition import ControllerDefinition, SetDefinition

_HEAD = (
    "# distance: free distance ahead; difference: that on the left less that on the right; step:",
    "# all in steps S_p (the robot's radius). turn: in A_p (60 degrees), positive to the left.",
    "# gaussian: [center, width]; triangular: [left, peak, right]; trapezoidal: [left, left",
    "# shoulder, right shoulder, right]; bell: [center, half width, slope]; singleton: number.",
    "# rules: in each row of distance a cell for each label of difference: [TURN STEP].",
)


def read(text: str, where: str) -> Node:
    """Return the data with line numbers.

    Raises:
        UserError: If it is no YAML.
    """
    return read_tree(text, where)


def write(definition: ControllerDefinition) -> str:
    """Return the text."""
    lines = list(_HEAD)
    if definition.name:
        lines.append(f"name: {_flow(definition.name)}")
    for title, group in (("inputs", definition.inputs), ("outputs", definition.outputs)):
        lines.append(f"{title}:")
        for name, variable in group.named():
            lines += [f"  {name}:", f"    range: {_flow(list(variable.range))}", "    sets:"]
            lines += [f"      {label}: {_set(one)}" for label, one in variable.sets.items()]
    lines += ["rules:", *_table(definition), "inference:"]
    how = definition.inference.model_dump()
    lines += [f"  {name}: {_flow(value)}" for name, value in how.items()]
    return "\n".join(lines) + "\n"


def _set(one: SetDefinition) -> str:
    told = (f"{name}: {_flow(value)}" for name, value in one.model_dump(mode="json").items())
    return "{" + ", ".join(told) + "}"


def _table(definition: ControllerDefinition) -> list[str]:
    """Return the rules with their columns below each other, in the order of their sets."""
    columns = definition.inputs.difference.sets
    rows = [definition.rules[label] for label in definition.inputs.distance.sets]
    wide = [max(len(label), *(len(row[i]) for row in rows)) + 1 for i, label in enumerate(columns)]
    margin = max(map(len, definition.inputs.distance.sets)) + len("  :")
    head = "".join(f" {label:<{width}}" for label, width in zip(columns, wide, strict=True))
    lines = [f"  #{' ' * (margin - 2)}{head}".rstrip()]
    shown = [list(columns)[i] for i in definition.inputs.difference.variable("difference").falling]
    if shown != list(columns):
        order = ", ".join(shown)
        lines.insert(0, f"  # explain, film and page show these columns in another order: {order}.")
    for label, row in zip(definition.inputs.distance.sets, rows, strict=True):
        cells = [f"{cell}," for cell in row[:-1]] + [row[-1]]
        told = " ".join(f"{cell:<{width}}" for cell, width in zip(cells, wide, strict=True))
        lines.append(f"  {label + ':':<{margin - 2}} [{told.rstrip()}]")
    return lines


def _flow(value: Any) -> str:
    """Return a value as JSON, which is YAML."""
    return json.dumps(value, ensure_ascii=False)
