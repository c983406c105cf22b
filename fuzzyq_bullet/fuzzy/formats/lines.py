"""What formats share that are no YAML: a tree of data whose values know their lines."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.fuzzy.definition import NAMES
from fuzzyq_bullet.reading.yaml_tree import Node
from fuzzyq_bullet.wording import not_one_of, shorten

if TYPE_CHECKING:
    from fuzzyq_bullet.fuzzy.definition import VariableDefinition

Shapes: TypeAlias = dict[str, tuple[str, tuple[int, ...]]]
"""For each kind of set the name of ours, and for each of our numbers the place of theirs."""
Cells: TypeAlias = dict[tuple[str, str], tuple[str, int]]
INPUTS, OUTPUTS = ("distance", "difference"), ("turn", "step")


def mapping(line: int, children: dict[str, Node]) -> Node:
    """Return a mapping that begins on a line."""
    data = {key: child.data for key, child in children.items()}
    lines: dict[str | int, int] = {key: child.line for key, child in children.items()}
    named: dict[str | int, Node] = dict(children.items())
    return Node(data, line, named, lines)


def listing(line: int, children: list[Node]) -> Node:
    """Return a list that begins on a line."""
    numbered: dict[str | int, Node] = dict(enumerate(children))
    lines = {key: child.line for key, child in numbered.items()}
    return Node([child.data for child in children], line, numbered, lines)


def value(line: int, data: Any) -> Node:
    """Return a plain value, which may be a list of numbers."""
    if isinstance(data, list):
        return listing(line, [value(line, one) for one in data])
    return Node(data, line, {}, {})


def numbers(text: str, where: str) -> list[float]:
    """Return the numbers in a text, with blanks or commas between.

    Raises:
        UserError: If one is no finite number.
    """
    found = []
    for word in text.replace(",", " ").split():
        try:
            number = float(word)
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            raise UserError(f"{where}: expected a number, got {shorten(word)}")
        found.append(number)
    return found


def named(names: Iterable[str], wanted: tuple[str, str], kind: str, where: str) -> dict[str, str]:
    """Return which variable of a file is which of the controller's.

    They are told by their names (``distance``, ``difference``, ``turn`` and ``step``, or those of
    the paper) and otherwise by their order.

    Args:
        names: Those of the file, in order.
        wanted: Those of the controller, in order.
        kind: What they are, for messages: ``inputs``.
        where: The file.

    Raises:
        UserError: If there are not two.
    """
    given = list(names)
    if len(given) != 2:
        raise UserError(f"{where}: needs two {kind}, {' and '.join(wanted)}; got {len(given)}")
    known = {name: one for one in wanted for name in (one.lower(), NAMES[one].lower())}
    told = [known.get(name.lower()) for name in given]
    if sorted(filter(None, told)) == sorted(wanted):
        return {name: str(one) for name, one in zip(given, told, strict=True)}
    return dict(zip(given, wanted, strict=True))


def table(cells: Cells, rows: list[str], columns: list[str], line: int, where: str) -> Node:
    """Return the rules as a table.

    Args:
        cells: For a row and a column what then holds, and the line that says so.
        rows: Labels of the distance.
        columns: Labels of the difference.
        line: Where the rules begin.
        where: The file.

    Raises:
        UserError: If one is missing.
    """
    told = {}
    for row in rows:
        missing = [column for column in columns if (row, column) not in cells]
        if missing:
            raise UserError(
                f"{where}:{line}: no rule for distance {row} and difference {missing[0]}"
            )
        found = [cells[row, column] for column in columns]
        told[row] = listing(found[0][1], [value(at, cell) for cell, at in found])
    return mapping(line, told)


def terms(
    variable: VariableDefinition, shapes: Shapes, *, centers: bool
) -> Iterator[tuple[str, str, str]]:
    """Yield label, kind and numbers of each set as a file writes them.

    Args:
        variable: Whose sets.
        shapes: The kinds that the file may name.
        centers: Whether only their centers count, as in an average.
    """
    theirs = {name: (kind, order) for kind, (name, order) in shapes.items()}
    for label, one in variable.sets.items():
        name, numbers = ("singleton", (one.fuzzy_set(label).center,)) if centers else one.shape
        kind, order = theirs[name]
        given = (numbers[order.index(place)] for place in range(len(order)))
        yield label, kind, " ".join(map(repr, given))


def ordered(held: Mapping[str, Node], names: Sequence[str]) -> Node:
    """Return the variables of a controller in its own order, whatever that of the file was."""
    return mapping(1, {name: held[name] for name in names})


def term(kind: str, parameters: list[float], shapes: Shapes, where: str) -> dict[str, Any]:
    """Return the shape of a set.

    Args:
        kind: What the file calls it.
        parameters: Its numbers.
        shapes: The kinds that the file may name.
        where: File and line.

    Raises:
        UserError: If it is of another kind, or has another count of numbers.
    """
    if kind not in shapes:
        raise UserError(f"{where}: {not_one_of('kind of set', kind, list(shapes))}")
    name, order = shapes[kind]
    if len(parameters) != len(order):
        raise UserError(f"{where}: {kind} needs {len(order)} numbers, got {len(parameters)}")
    ours = [parameters[place] for place in order]
    return {name: ours[0] if name == "singleton" else ours}
