"""A controller in the FuzzyLite Language (``.fll``), which FuzzyLite and pyfuzzylite read.

Read are Mamdani engines with two inputs, two outputs and one block of rules that join both inputs
with "and". FuzzyLite samples the middles of the parts of a range, Eq. 22 both its ends: with a
centroid of n points the two agree to half a part.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.fuzzy.formats.lines import (
    INPUTS,
    OUTPUTS,
    Cells,
    Shapes,
    mapping,
    named,
    numbers,
    ordered,
    table,
    term,
    terms,
    value,
)
from fuzzyq_bullet.reading.yaml_tree import Node
from fuzzyq_bullet.wording import not_one_of, shorten

if TYPE_CHECKING:
    from fuzzyq_bullet.fuzzy.definition import ControllerDefinition, VariableDefinition

_TERMS: Shapes = {
    "Gaussian": ("gaussian", (0, 1)),
    "Triangle": ("triangular", (0, 1, 2)),
    "Trapezoid": ("trapezoidal", (0, 1, 2, 3)),
    "Bell": ("bell", (0, 1, 2)),
    "Constant": ("singleton", (0,)),
}
"""FuzzyLite's names of the shapes, and the order of their numbers, which is ours."""
_AND = {"AlgebraicProduct": "product", "Minimum": "minimum"}
_BLOCKS = ("Engine", "InputVariable", "OutputVariable", "RuleBlock")
_RULE = re.compile(
    r"if\s+(\w+)\s+is\s+(\w+)\s+and\s+(\w+)\s+is\s+(\w+)\s+"
    r"then\s+(\w+)\s+is\s+(\w+)\s+and\s+(\w+)\s+is\s+(\w+)\s*(?:with\s+([0-9]{1,9}(?:\.[0-9]*)?))?"
)


@dataclass
class _Block:
    """One block of the file: its name, its line, and what stands in it, in order."""

    name: str
    line: int
    entries: list[tuple[str, str, int]] = field(default_factory=list)

    def first(self, key: str, where: str) -> tuple[str, int]:
        for one, text, line in self.entries:
            if one == key:
                return text, line
        raise UserError(f"{where}:{self.line}: {self.name}: {key} is missing")


def read(text: str, where: str) -> Node:
    """Return the data with line numbers.

    Raises:
        UserError: If it is no such engine; with the line.
    """
    blocks = _blocks(text, where)
    inputs = {one.name: one for kind, one in blocks if kind == "InputVariable"}
    outputs = {one.name: one for kind, one in blocks if kind == "OutputVariable"}
    rules = [one for kind, one in blocks if kind == "RuleBlock"]
    if len(rules) != 1:
        raise UserError(f"{where}: needs one RuleBlock, got {len(rules)}")
    for name in inputs:
        if name in outputs:
            raise UserError(f"{where}:{outputs[name].line}: {name} is an input and an output")
    _refuse_other(blocks, where)
    names = named(inputs, INPUTS, "inputs", where) | named(outputs, OUTPUTS, "outputs", where)
    groups = {
        group: ordered({names[name]: _variable(one, where) for name, one in held.items()}, order)
        for group, held, order in (("inputs", inputs, INPUTS), ("outputs", outputs, OUTPUTS))
    }
    title = next((one.name for kind, one in blocks if kind == "Engine"), "")
    return mapping(
        1,
        {
            "name": value(1, title),
            **groups,
            "rules": _rules(rules[0], groups, names, where),
            "inference": _inference(rules[0], list(outputs.values()), where),
        },
    )


_ONLY = {
    "enabled": ("true",),
    "activation": ("General", "none"),
    "default": ("nan",),
    "lock-previous": ("false",),
}
"""What means something else if it says anything else."""


def _refuse_other(blocks: list[tuple[str, _Block]], where: str) -> None:
    """Refuse what would be left out of the controller.

    Raises:
        UserError: If something is.
    """
    for _, block in blocks:
        for key, text, line in block.entries:
            if key in _ONLY and text not in _ONLY[key]:
                raise UserError(
                    f"{where}:{line}: {key}: must be {_ONLY[key][0]}, got {shorten(text)}"
                )


def _blocks(text: str, where: str) -> list[tuple[str, _Block]]:
    found: list[tuple[str, _Block]] = []
    for number, raw in enumerate(text.splitlines(), start=1):
        line = raw.partition("#")[0].strip()
        if not line:
            continue
        key, colon, rest = line.partition(":")
        key, rest = key.strip(), rest.strip()
        if not colon:
            raise UserError(f"{where}:{number}: expected KEY: VALUE, got {shorten(line)}")
        if key in _BLOCKS:
            found.append((key, _Block(rest, number)))
        elif found:
            found[-1][1].entries.append((key, rest, number))
        else:
            raise UserError(f"{where}:{number}: {key} stands before the first block")
    if not found:
        raise UserError(f"{where}: holds no blocks such as InputVariable: distance")
    return found


def _variable(block: _Block, where: str) -> Node:
    text, line = block.first("range", where)
    sets: dict[str, Node] = {}
    for key, entry, at in block.entries:
        if key != "term":
            continue
        label, _, rest = entry.partition(" ")
        kind, _, parameters = rest.strip().partition(" ")
        here = f"{where}:{at}: term {label[:20]}"
        if label in sets:
            raise UserError(f"{here}: is there already")
        told = term(kind, numbers(parameters, here), _TERMS, here)
        sets[label] = mapping(at, {name: value(at, one) for name, one in told.items()})
    return mapping(
        block.line,
        {
            "range": value(line, numbers(text, f"{where}:{line}: range")),
            "sets": mapping(block.line, sets),
        },
    )


def _rules(block: _Block, groups: dict[str, Node], names: dict[str, str], where: str) -> Node:
    rows, columns = (list(groups["inputs"].data[name]["sets"]) for name in INPUTS)
    cells: Cells = {}
    for key, text, line in block.entries:
        if key != "rule":
            continue
        here = f"{where}:{line}: rule"
        match = _RULE.fullmatch(text)
        if match is None or (match[9] and float(match[9]) != 1.0):
            raise UserError(
                f"{here}: expected 'if distance is A and difference is B then turn is C and step "
                f"is D', without a weight; got {shorten(text)}"
            )
        said = {names.get(match[i], match[i]): match[i + 1] for i in (1, 3, 5, 7)}
        if sorted(said) != sorted((*INPUTS, *OUTPUTS)):
            raise UserError(f"{here}: names {', '.join(said)}; each variable is needed once")
        place = (said["distance"], said["difference"])
        if place[0] not in rows or place[1] not in columns:
            raise UserError(f"{here}: no term {place[0]} of distance or {place[1]} of difference")
        if place in cells:
            raise UserError(f"{here}: there is one for {' and '.join(place)} already")
        cells[place] = (f"{said['turn']} {said['step']}", line)
    return table(cells, rows, columns, block.line, where)


def _inference(block: _Block, outputs: list[_Block], where: str) -> Node:
    conjunction, line = block.first("conjunction", where)
    implication, at = block.first("implication", where)
    if conjunction not in _AND:
        raise UserError(
            f"{where}:{line}: conjunction: {not_one_of('norm', conjunction, list(_AND))}"
        )
    told: dict[str, Node] = {"and": value(line, _AND[conjunction])}
    kinds = set()
    for one in outputs:
        text, number = one.first("defuzzifier", where)
        kind, _, points = text.partition(" ")
        here = f"{where}:{number}: defuzzifier"
        if kind not in ("Centroid", "WeightedAverage"):
            raise UserError(
                f"{here}: {not_one_of('defuzzifier', kind, ['Centroid', 'WeightedAverage'])}"
            )
        kinds.add(kind)
        told["defuzzification"] = value(number, "centroid" if kind == "Centroid" else "average")
        if kind == "Centroid":
            given = numbers(points, here)
            samples = int(given[0]) if given else 101
            if "samples" in told and told["samples"].data != samples:
                raise UserError(f"{here}: both outputs need the same number of points")
            told["samples"] = value(number, samples)
            aggregation, _ = one.first("aggregation", where)
            if aggregation != "Maximum":
                raise UserError(f"{here}: aggregation {shorten(aggregation)}; it must be Maximum")
    if len(kinds) > 1:
        raise UserError(f"{where}: both outputs need the same defuzzifier")
    if kinds == {"Centroid"} and implication != conjunction:
        raise UserError(f"{where}:{at}: implication: must be {conjunction}, as the conjunction")
    return mapping(block.line, told)


def write(definition: ControllerDefinition) -> str:
    """Return the text. Words and meanings have no place in it."""
    how = definition.inference
    average = how.defuzzification == "average"
    norm = {ours: theirs for theirs, ours in _AND.items()}[how.conjunction]
    lines = [f"Engine: {definition.name or 'controller'}"]
    for name, variable in definition.inputs.named():
        lines += [f"InputVariable: {name}", *_range(variable), "  lock-range: true"]
        lines += _written(variable, centers=False)
    for name, variable in definition.outputs.named():
        lines += [f"OutputVariable: {name}", *_range(variable), "  lock-range: true"]
        lines += [f"  aggregation: {'none' if average else 'Maximum'}"]
        defuzzifier = "WeightedAverage TakagiSugeno" if average else f"Centroid {how.samples}"
        lines += [f"  defuzzifier: {defuzzifier}", "  default: nan", "  lock-previous: false"]
        lines += _written(variable, centers=average)
    lines += ["RuleBlock:", "  enabled: true", f"  conjunction: {norm}", "  disjunction: none"]
    lines += [f"  implication: {'none' if average else norm}", "  activation: General"]
    for row, cells in definition.rules.items():
        for column, cell in zip(definition.inputs.difference.sets, cells, strict=True):
            turn, step = cell.split()
            lines.append(
                f"  rule: if distance is {row} and difference is {column} "
                f"then turn is {turn} and step is {step}"
            )
    return "\n".join(lines) + "\n"


def _range(variable: VariableDefinition) -> list[str]:
    low, high = variable.range
    return ["  enabled: true", f"  range: {low!r} {high!r}"]


def _written(variable: VariableDefinition, *, centers: bool) -> list[str]:
    """Return the terms; for an average only their centers count."""
    told = terms(variable, _TERMS, centers=centers)
    return [f"  term: {label} {kind} {given}" for label, kind, given in told]
