"""What is wrong with a controller that is well formed, and what is doubtful."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, TypeAlias

import numpy as np

from fuzzyq_bullet.wording import did_you_mean

if TYPE_CHECKING:
    from fuzzyq_bullet.fuzzy.definition import (
        ControllerDefinition,
        Outputs,
        SetDefinition,
        VariableDefinition,
    )

NOTHING = 1e-6
"""A membership below this counts as none: a Gaussian never reaches 0."""
GRID = 1001
"""Points at which a range is looked at for gaps."""

Mistakes: TypeAlias = list[tuple[tuple[str | int, ...], str]]
"""Each with the keys that lead to it."""


def gaps_of(definition: ControllerDefinition) -> Mistakes:
    """Return where an input may lie without belonging to any set, so that no rule fires.

    This is allowed: the robot then goes straight on, with the smallest step.
    """
    found: Mistakes = []
    for name, variable in definition.inputs.named():
        x = np.linspace(*variable.range, GRID)
        empty = variable.variable(name).memberships(x).max(axis=0) < NOTHING
        edges = np.flatnonzero(np.diff(np.concatenate([[False], empty, [False]]).astype(int)))
        for first, last in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
            found.append(
                (
                    ("inputs", name, "sets"),
                    f"from {x[first]:.3g} to {x[last - 1]:.3g} belongs to no set: no rule fires "
                    "there, and the robot goes straight on with its smallest step",
                )
            )
    return found


def mistakes_in(definition: ControllerDefinition) -> Mistakes:
    """Return what does not fit together."""
    found = _useless_sets(definition, "inputs", GRID)
    found += _useless_outputs(definition, definition.inference.samples)
    if definition.outputs.step.range[0] < 0.0:
        found.append(
            (("outputs", "step", "range"), "a step cannot be negative; begin at 0 or more")
        )
    if not definition.outputs.turn.range[0] <= 0.0 <= definition.outputs.turn.range[1]:
        found.append((("outputs", "turn", "range"), "straight on, 0, must lie within it"))
    return found + _wrong_rules(definition)


def too_few(definition: ControllerDefinition, samples: int) -> str:
    """Say which set of an output none of so many points of the centroid meets; empty if all do."""
    for (_, name, _, label), _ in _useless_outputs(definition, samples):
        return f"with {samples} points, none belongs to the set {label} of {name}: take more"
    return ""


def _useless_outputs(definition: ControllerDefinition, samples: int) -> Mistakes:
    average = definition.inference.defuzzification == "average"
    return _useless_sets(definition, "outputs", GRID if average else samples, singletons=average)


def _useless_sets(
    definition: ControllerDefinition,
    group: Literal["inputs", "outputs"],
    points: int,
    *,
    singletons: bool = False,
) -> Mistakes:
    return [
        ((group, name, "sets", label), why)
        for name, variable in getattr(definition, group).named()
        for label, one in variable.sets.items()
        if (why := _useless(one, variable, points, singletons=singletons))
    ]


def _useless(
    one: SetDefinition, variable: VariableDefinition, points: int, *, singletons: bool
) -> str:
    """Say why nothing can belong to a set, if nothing can.

    Args:
        one: The set.
        variable: Whose it is.
        points: How many points of the range are looked at: for an output, those of the centroid.
        singletons: Whether it may be a single number.
    """
    low, high = variable.range
    if one.singleton is not None:
        if not singletons:
            return (
                "a singleton has no width; only outputs may have some, with "
                "inference: {defuzzification: average}"
            )
        return "" if low <= one.singleton <= high else "lies outside the range"
    most = one.fuzzy_set("").function.degrees(np.linspace(low, high, points)).max()
    if most >= NOTHING:
        return ""
    return f"none of {points} points of the range belongs to it: too narrow, or outside"


def _wrong_rules(definition: ControllerDefinition) -> Mistakes:
    rows, columns = definition.inputs.distance.sets, definition.inputs.difference.sets
    found: Mistakes = [
        (("rules",), f"has no row {label}; it needs one for each label of distance")
        for label in rows
        if label not in definition.rules
    ]
    for row, cells in definition.rules.items():
        if row not in rows:
            hint = did_you_mean(row, rows)
            found.append((("rules", row), f"no label of distance; {hint}it has {', '.join(rows)}"))
        elif len(cells) != len(columns):
            what = f"needs {len(columns)} cells, for {', '.join(columns)}; got {len(cells)}"
            found.append((("rules", row), what))
        else:
            for i, (column, cell) in enumerate(zip(columns, cells, strict=True)):
                why = _wrong_cell(cell, definition.outputs)
                if why:
                    found.append((("rules", row, i), f"({row}, {column}): {why}"))
    return found


def _wrong_cell(cell: str, outputs: Outputs) -> str:
    labels = cell.split()
    if len(labels) != 2:
        return f"expected the labels of turn and step, as in NL VL, got {cell[:40]!r}"
    for label, (name, output) in zip(labels, outputs.named(), strict=True):
        if label not in output.sets:
            hint = did_you_mean(label, output.sets)
            return f"{name} has no label {label[:20]!r}; {hint}it has {', '.join(output.sets)}"
    return ""
