"""Columns: what is recorded of every instant, each declared once with its unit, shape and meaning.

The arrays of a record, the checks of a record's file, its CSV and its documentation follow from the
declarations: those of a decision in ``planning/decision.py``, those of a tick in
``recording/trajectory.py``.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from inspect import cleandoc
from itertools import product
from typing import Any, TypeAlias, get_type_hints

import numpy as np
from numpy.typing import NDArray

FAR = 1e7
"""No position (m), angle (rad), speed or other number of a run comes near this."""


@dataclass(frozen=True)
class Column:
    """What one column of a record holds.

    A field of a class is declared with ``Annotated[float, Column(...)]``.

    Attributes:
        unit: Unit of the numbers, such as ``m``; empty if they have none.
        meaning: What they tell, in one sentence.
        axes: For numbers in rows and tables, the names along each axis of one entry.
        bounds: The least and the greatest number that can be carried out; None for a number that
            moves nothing.
        blank: Whether it may be left out (NaN).
        endless: Whether it may be infinite.
        whole: Whether the numbers are integers.
        words: If given, each number stands for one of these words.
    """

    unit: str
    meaning: str
    axes: tuple[tuple[str, ...], ...] = ()
    bounds: tuple[float, float] | None = None
    blank: bool = False
    endless: bool = False
    whole: bool = False
    words: tuple[str, ...] = ()

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """Shape of one entry; () for a plain number."""
        return tuple(map(len, self.axes))

    @property
    def dtype(self) -> np.dtype[Any]:
        """Type of the array: 64-bit floats or integers."""
        return np.dtype(np.int64 if self.whole or self.words else np.float64)

    def names(self, name: str) -> list[str]:
        """Return a name for every number of one entry, such as ``lines_left``; no two are alike.

        Labels of one's own may hold ``_``: where that makes two alike, ``:`` joins instead.
        """
        parts = [(name, *labels) for labels in product(*self.axes)]
        names = list(map("_".join, parts))
        return names if len(set(names)) == len(names) else list(map(":".join, parts))


Columns: TypeAlias = Mapping[str, Column]


def columns_of(declared: type) -> dict[str, Column]:
    """Return the columns by name, in order, that the annotations of a class declare."""
    hints = get_type_hints(declared, include_extras=True).items()
    found = {name: getattr(hint, "__metadata__", ()) for name, hint in hints}
    return {name: data[0] for name, data in found.items() if data and isinstance(data[0], Column)}


def documented(doc: str | None, columns: Columns) -> str:
    """Return a class's docstring with its columns, in Google's style."""
    lines = [cleandoc(doc or ""), "", "Attributes:"]
    for name, column in columns.items():
        kind = filter(None, (column.unit, f"shape {column.shape}" if column.axes else ""))
        lines.append(f"    {name} ({', '.join(kind)}): {column.meaning}".replace(" ():", ":"))
    return "\n".join(lines) + "\n"


def check_arrays(group: str, columns: Columns, arrays: Mapping[str, Any]) -> dict[str, Any]:
    """Return the arrays of a group from those of a record's file, each as it was declared.

    A column that may be left blank and is not there is blank: an older version did not know it.

    Args:
        group: Name of the group: an array is called ``group.column``.
        columns: What was declared.
        arrays: What was read.

    Raises:
        ValueError: If another array is missing, of another type, length or shape, or holds a number
            that no run leaves.
    """
    found: dict[str, Any] = {}
    rows = None
    for key, column in columns.items():
        name = f"{group}.{key}"
        if name not in arrays and not (column.blank and rows):
            raise ValueError(f"{name} is missing")
        array = arrays[name] if name in arrays else np.full((*(rows or ()), *column.shape), np.nan)
        rows = array.shape[:1] if rows is None else rows
        if array.dtype != column.dtype:
            raise ValueError(f"{name} holds {array.dtype} instead of {column.dtype}")
        if not rows or rows == (0,) or array.shape != rows + column.shape:
            raise ValueError(f"{name} is of the wrong shape {array.shape}")
        if column.words and (array.min() < 0 or array.max() >= len(column.words)):
            raise ValueError(f"{name} leaves the range 0 to {len(column.words) - 1}")
        left_out = column.blank & np.isnan(array) | column.endless & (array == np.inf)
        if not (np.abs(array[~left_out]) < FAR).all():
            raise ValueError(f"{name} holds a number that is not finite, or is absurd")
        found[key] = array
    return found


def array_of(column: Column, values: list[Any]) -> NDArray[Any]:
    """Return what was decided as an array, a row for each value: of words, their numbers."""
    if column.words:
        return np.array([column.words.index(word) for word in values], dtype=column.dtype)
    array = np.array(values, dtype=column.dtype).reshape(len(values), *column.shape)
    # What a planner cannot put into a number is not explained; only a reach may be endless.
    return array if column.endless else np.where(np.isinf(array), np.nan, array)


def csv_of(columns: Columns, arrays: Mapping[str, NDArray[Any]], *, units: bool = False) -> str:
    """Return a table as CSV: a heading, then a line for every row of the arrays.

    Args:
        columns: What the table consists of.
        arrays: An array for each column, all of one length.
        units: Whether the heading has the unit of each column, as in ``speed [m/s]``.

    Returns:
        The text. Numbers read back as the very same, words stand for themselves, and what is
        blank is empty.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(
        f"{name} [{column.unit}]" if units and column.unit else name
        for key, column in columns.items()
        for name in column.names(key)
    )
    cells: list[list[Any]] = []
    for key, column in columns.items():
        for values in arrays[key].reshape(len(arrays[key]), -1).T.tolist():
            if column.words:
                values = [column.words[value] for value in values]
            cells.append(["" if value != value else value for value in values])
    writer.writerows(zip(*cells, strict=True))
    return text.getvalue()
