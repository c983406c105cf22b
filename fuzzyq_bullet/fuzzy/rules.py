"""A rule base as a table: a row and a column of labels, and in each cell what then holds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from fuzzyq_bullet.fuzzy.sets import Variable


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

    def __iter__(self) -> Iterator[Rule]:
        """Yield the rules, row by row."""
        for row, cells in zip(self.row.labels, self.cells, strict=True):
            for column, cell in zip(self.column.labels, cells, strict=True):
                yield Rule(row, column, cell)
