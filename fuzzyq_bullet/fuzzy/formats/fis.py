"""A controller as a file of the Fuzzy Logic Toolbox (``.fis``): sections, ``[Input1]``, ``MF1=…``.

Read are Mamdani systems, and Sugeno systems with constants, of two inputs and two outputs whose
rules join both inputs with "and".
"""

from __future__ import annotations

import re
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
    "gaussmf": ("gaussian", (1, 0)),
    "trimf": ("triangular", (0, 1, 2)),
    "trapmf": ("trapezoidal", (0, 1, 2, 3)),
    "gbellmf": ("bell", (2, 0, 1)),
    "constant": ("singleton", (0,)),
}
"""The Toolbox's names of the shapes, and for each of our numbers the place of theirs."""
_AND = {"prod": "product", "min": "minimum"}
_SECTION = re.compile(r"\[(\w+)\]")
_MF = re.compile(r"'(?P<label>[^']*)'\s*:\s*'(?P<kind>[^']*)'\s*,\s*\[(?P<numbers>[^\]]*)\]")
_RULE = re.compile(
    r"(-?[0-9]{1,4})\s+(-?[0-9]{1,4})\s*,\s*(-?[0-9]{1,4})\s+(-?[0-9]{1,4})\s*"
    r"\(([0-9]{1,9}(?:\.[0-9]*)?)\)\s*:\s*([0-9]{1,4})"
)


class _Section:
    """One section: its line, its entries ``KEY=VALUE`` by key, and its other lines."""

    def __init__(self, line: int) -> None:
        self.line = line
        self.entries: dict[str, tuple[str, int]] = {}
        self.others: list[tuple[str, int]] = []

    def of(self, key: str, where: str, usual: str | None = None) -> tuple[str, int]:
        if key in self.entries:
            text, line = self.entries[key]
            return text.strip("'"), line
        if usual is not None:
            return usual, self.line
        raise UserError(f"{where}:{self.line}: {key} is missing")


def read(text: str, where: str) -> Node:
    """Return the data with line numbers.

    Raises:
        UserError: If it is no such system; with the line.
    """
    sections = _sections(text, where)
    system = sections.get("System")
    if system is None or "Rules" not in sections:
        raise UserError(f"{where}: needs the sections [System] and [Rules]")
    kind, line = system.of("Type", where, "mamdani")
    if kind not in ("mamdani", "sugeno"):
        raise UserError(f"{where}:{line}: Type: {not_one_of('type', kind, ['mamdani', 'sugeno'])}")
    groups: dict[str, Node] = {}
    orders: list[list[str]] = []
    for group, prefix, wanted in (("inputs", "Input", INPUTS), ("outputs", "Output", OUTPUTS)):
        found = [sections[name] for name in sorted(sections) if re.fullmatch(prefix + r"\d+", name)]
        by_name = {one.of("Name", where, f"{prefix}{i}")[0]: one for i, one in enumerate(found)}
        names = named(by_name, wanted, group, where)
        held = {names[name]: _variable(one, where) for name, one in by_name.items()}
        groups[group] = ordered(held, wanted)
        orders.append([names[name] for name in by_name])
    return mapping(
        1,
        {
            "name": value(1, system.of("Name", where, "")[0]),
            **groups,
            "rules": _rules(sections["Rules"], groups, orders, where),
            "inference": _inference(system, kind, where),
        },
    )


def _sections(text: str, where: str) -> dict[str, _Section]:
    sections: dict[str, _Section] = {}
    here: _Section | None = None
    for number, raw in enumerate(text.splitlines(), start=1):
        line = raw.partition("%")[0].strip()
        if not line:
            continue
        match = _SECTION.fullmatch(line)
        if match:
            if match[1] in sections:
                raise UserError(f"{where}:{number}: [{match[1]}] is there already")
            here = sections[match[1]] = _Section(number)
            continue
        if here is None:
            raise UserError(f"{where}:{number}: expected a section such as [System]")
        key, equals, rest = line.partition("=")
        if equals and key.strip() in here.entries:
            raise UserError(f"{where}:{number}: {shorten(key.strip())} is there already")
        if equals:
            here.entries[key.strip()] = (rest.strip(), number)
        else:
            here.others.append((line, number))
    return sections


def _variable(section: _Section, where: str) -> Node:
    text, line = section.of("Range", where)
    sets: dict[str, Node] = {}
    numbered = {int(key[2:]): key for key in section.entries if re.fullmatch(r"MF[0-9]{1,4}", key)}
    for number in sorted(numbered):
        key = numbered[number]
        entry, at = section.entries[key]
        here = f"{where}:{at}: {key}"
        match = _MF.fullmatch(entry)
        if match is None:
            raise UserError(f"{here}: expected 'LABEL':'KIND',[NUMBERS], got {shorten(entry)}")
        label = match["label"]
        if label in sets:
            raise UserError(f"{here}: the label {shorten(label)} is there already")
        told = term(match["kind"], numbers(match["numbers"], here), _TERMS, here)
        sets[label] = mapping(at, {name: value(at, one) for name, one in told.items()})
    return mapping(
        section.line,
        {
            "range": value(line, numbers(text.strip("[]"), f"{where}:{line}: Range")),
            "sets": mapping(section.line, sets),
        },
    )


def _rules(section: _Section, groups: dict[str, Node], orders: list[list[str]], where: str) -> Node:
    order = [*orders[0], *orders[1]]
    labels = {
        name: list(groups[group].data[name]["sets"])
        for group, names in (("inputs", INPUTS), ("outputs", OUTPUTS))
        for name in names
    }
    cells: Cells = {}
    for text, line in section.others:
        here = f"{where}:{line}"
        match = _RULE.fullmatch(text)
        if match is None or float(match[5]) != 1.0 or match[6] != "1":
            raise UserError(
                f"{here}: expected a rule of two inputs and two outputs joined by and, with weight "
                f"1, as in '1 1, 2 1 (1) : 1', got {shorten(text)}"
            )
        said = {}
        for name, number in zip(order, map(int, match.groups()[:4]), strict=True):
            if not 1 <= number <= len(labels[name]):
                raise UserError(
                    f"{here}: {name} has the sets 1 to {len(labels[name])}, got {number}"
                )
            said[name] = labels[name][number - 1]
        place = (said["distance"], said["difference"])
        if place in cells:
            raise UserError(f"{here}: there is a rule for {' and '.join(place)} already")
        cells[place] = (f"{said['turn']} {said['step']}", line)
    return table(cells, labels["distance"], labels["difference"], section.line, where)


def _inference(system: _Section, kind: str, where: str) -> Node:
    sugeno = kind == "sugeno"
    conjunction, line = system.of("AndMethod", where, "min")
    if conjunction not in _AND:
        raise UserError(
            f"{where}:{line}: AndMethod: {not_one_of('method', conjunction, list(_AND))}"
        )
    wanted = {
        "DefuzzMethod": "wtaver" if sugeno else "centroid",
        **({} if sugeno else {"ImpMethod": conjunction, "AggMethod": "max"}),
    }
    for key, word in wanted.items():
        got, at = system.of(key, where, word)
        if got != word:
            raise UserError(f"{where}:{at}: {key}: must be {word} here, got {shorten(got)}")
    return mapping(
        system.line,
        {
            "and": value(line, _AND[conjunction]),
            "defuzzification": value(line, "average" if sugeno else "centroid"),
        },
    )


def write(definition: ControllerDefinition) -> str:
    """Return the text. Words, meanings and the number of samples, which is 101, have no place."""
    how = definition.inference
    average = how.defuzzification == "average"
    method = {ours: theirs for theirs, ours in _AND.items()}[how.conjunction]
    count = sum(map(len, definition.rules.values()))
    lines = [
        "[System]",
        f"Name='{_quoted(definition.name or 'controller')}'",
        f"Type='{'sugeno' if average else 'mamdani'}'",
        *("Version=2.0", "NumInputs=2", "NumOutputs=2", f"NumRules={count}"),
        *(f"AndMethod='{method}'", "OrMethod='max'", f"ImpMethod='{method}'", "AggMethod='max'"),
        f"DefuzzMethod='{'wtaver' if average else 'centroid'}'",
    ]
    for prefix, group in (("Input", definition.inputs), ("Output", definition.outputs)):
        for number, (name, variable) in enumerate(group.named(), start=1):
            lines += ["", f"[{prefix}{number}]", f"Name='{name}'"]
            lines += [f"Range=[{variable.range[0]!r} {variable.range[1]!r}]"]
            lines += _written(variable, centers=average and prefix == "Output")
    lines += ["", "[Rules]"]
    turns, steps = (list(one.sets) for _, one in definition.outputs.named())
    for i, row in enumerate(definition.inputs.distance.sets, start=1):
        for j, cell in enumerate(definition.rules[row], start=1):
            turn, step = cell.split()
            lines.append(f"{i} {j}, {turns.index(turn) + 1} {steps.index(step) + 1} (1) : 1")
    return "\n".join(lines) + "\n"


def _written(variable: VariableDefinition, *, centers: bool) -> list[str]:
    """Return the sets; for an average only their centers count."""
    lines = [f"NumMFs={len(variable.sets)}"]
    told = terms(variable, _TERMS, centers=centers)
    for number, (label, kind, given) in enumerate(told, start=1):
        lines.append(f"MF{number}='{label}':'{kind}',[{given}]")
    return lines


def _quoted(text: str) -> str:
    return text.replace("'", " ").replace("%", " ")
