"""A rule base as a table: a row and a column of labels, and in each cell what then holds."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from fuzzyq_bullet.fuzzy.sets import Variable

_ROW = re.compile(r"(?P<label>\w+)\s*:\s*(?P<cells>(\[[^\[\]]*\]\s*)*)")
_CELL = re.compile(r"\[([^\[\]]*)\]")


class Rule(NamedTuple):
    """If the row variable is ``row`` and the column variable is ``column``, then ``then``.

    Attributes:
        row: Label of the row variable.
        column: Label of the column variable.
        then: One label for each output.
    """

    row: str
    column: str
    then: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class RuleBase:
    """One rule for every pair of labels of two variables, each naming a label of every output.

    Attributes:
        row: The variable whose labels name the rows.
        column: The variable whose labels name the columns.
        outputs: The variables that a cell speaks of, in the order in which it names them.
        cells: ``cells[i][j][k]``: the label of output ``k`` in row ``i`` and column ``j``.

    Raises:
        ValueError: If the table has not one cell for every pair, or a cell names a label that its
            output does not have.
    """

    row: Variable
    column: Variable
    outputs: tuple[Variable, ...]
    cells: tuple[tuple[tuple[str, ...], ...], ...]

    def __post_init__(self) -> None:
        if not self.outputs:
            raise ValueError("the rules have no output")
        if len(self.cells) != len(self.row.sets):
            raise ValueError(
                f"{len(self.cells)} rows of rules; {self.row.name} has the labels "
                f"{', '.join(self.row.labels)}"
            )
        for label, cells in zip(self.row.labels, self.cells, strict=True):
            if len(cells) != len(self.column.sets):
                raise ValueError(
                    f"row {label} has {len(cells)} cells; {self.column.name} has the labels "
                    f"{', '.join(self.column.labels)}"
                )
            for column, cell in zip(self.column.labels, cells, strict=True):
                self._check_cell(f"rule ({label}, {column})", cell)

    def _check_cell(self, place: str, cell: Sequence[str]) -> None:
        if len(cell) != len(self.outputs):
            names = ", ".join(output.name for output in self.outputs)
            raise ValueError(f"{place}: [{' '.join(cell)}] does not name one label each of {names}")
        for output, label in zip(self.outputs, cell, strict=True):
            if label not in output.labels:
                raise ValueError(
                    f"{place}: {output.name} has no label {label!r}; "
                    f"it has {', '.join(output.labels)}"
                )

    @classmethod
    def parse(
        cls,
        table: str,
        *,
        row: Variable,
        column: Variable,
        outputs: Sequence[Variable],
        aliases: Sequence[Mapping[str, str]] = (),
    ) -> RuleBase:
        """Read a table whose first line names the columns and whose others read ``ROW: [A B] …``.

        Args:
            table: The text; blank lines and blanks between words do not count.
            row: The variable that names the rows.
            column: The variable that names the columns.
            outputs: The variables that each cell names one label of.
            aliases: For each output, names that the cells use for its labels; empty if the cells
                use the labels themselves.

        Raises:
            ValueError: If rows or columns are not those of the variables in their order, a line
                does not read so, or the rule base would not be valid.
        """
        header, *lines = [line.strip() for line in table.strip().splitlines() if line.strip()]
        if tuple(header.split()) != column.labels:
            raise ValueError(f"columns {header!r} are not those of {column.name}: {column.labels}")
        rows, labels = [], []
        for line in lines:
            match = _ROW.fullmatch(line)
            if match is None:
                raise ValueError(f"not 'ROW: [label …] …': {line!r}")
            labels.append(match["label"])
            rows.append(tuple(_cell(text, aliases) for text in _CELL.findall(match["cells"])))
        if tuple(labels) != row.labels:
            raise ValueError(f"rows {labels} are not those of {row.name}: {row.labels}")
        return cls(row, column, tuple(outputs), tuple(rows))

    def __iter__(self) -> Iterator[Rule]:
        """Yield the rules, row by row."""
        for row, cells in zip(self.row.labels, self.cells, strict=True):
            for column, cell in zip(self.column.labels, cells, strict=True):
                yield Rule(row, column, cell)


def _cell(text: str, aliases: Sequence[Mapping[str, str]]) -> tuple[str, ...]:
    labels = text.split()
    if not aliases or len(labels) != len(aliases):
        return tuple(labels)
    return tuple(names.get(label, label) for names, label in zip(aliases, labels, strict=True))
