"""The columns of a record: what is declared once is what is in the file, in CSV and in the docs.

After a change of the declarations::

    python tests/test_record.py
"""

from __future__ import annotations

import csv
import re
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from fuzzyq_bullet import Decision, Trajectory
from fuzzyq_bullet.columns import Columns
from fuzzyq_bullet.planning.decision import RARE_FIELDS
from fuzzyq_bullet.recording.trajectory import DECISIONS, OPTIONAL, TICKS, Decisions, Ticks

PAGE = Path(__file__).parent.parent / "docs" / "reference" / "record.md"
GROUPS = {"ticks": TICKS, "decisions": DECISIONS}


def table(columns: Columns) -> str:
    """Return the table of a group as the page has it."""
    lines = ["| Array | Shape | Unit | Meaning |", "|---|---|---|---|"]
    for name, column in columns.items():
        axes = " × ".join(", ".join(labels) for labels in column.axes)
        words = ", ".join(f"{k} {word}" for k, word in enumerate(column.words))
        shape = f"{column.shape}: {axes}" if axes else ""
        meaning = f"{column.meaning} {words}.".removesuffix(" .")
        lines.append(f"| `{name}` | {shape} | {column.unit} | {meaning} |")
    return "\n".join(lines) + "\n"


def page() -> str:
    """Return the page with the tables of today."""
    text = PAGE.read_text(encoding="utf-8")
    for group, columns in GROUPS.items():
        text = re.sub(
            rf"(## `{group}\.\*`\n\n)(\|[^\n]*\n)*", rf"\1{table(columns)}\n", text + "\n"
        ).replace("\n\n\n", "\n\n")
    return text.rstrip("\n") + "\n"


@pytest.fixture(scope="module")
def record(filmed: Path) -> Trajectory:
    return Trajectory.load(filmed / "short.npz")


def test_the_page_about_the_record_is_what_is_declared() -> None:
    assert PAGE.read_text(encoding="utf-8") == page()


def test_every_field_of_a_decision_but_hopeless_is_recorded() -> None:
    assert [*Decision._fields] == [*list(DECISIONS)[1:], "hopeless", *RARE_FIELDS]
    assert Decision.__doc__ is not None
    assert all(f"\n    {name}" in Decision.__doc__ for name in list(DECISIONS)[1:])


def test_the_arrays_are_what_is_declared(record: Trajectory) -> None:
    for kind, held, columns in (
        (Ticks, record.ticks, TICKS),
        (Decisions, record.decisions, DECISIONS),
    ):
        names = [column.name for column in fields(kind)]  # type: ignore[arg-type]
        assert [name for name in names if name not in OPTIONAL] == list(columns)
        for name, column in columns.items():
            array = getattr(held, name)
            assert (array.dtype, array.shape[1:]) == (column.dtype, column.shape)


@pytest.mark.parametrize("group", GROUPS)
def test_csv_holds_every_number_and_reads_back_as_the_same(group: str, record: Trajectory) -> None:
    heading, *rows = csv.reader(record.csv(group).splitlines())  # type: ignore[arg-type]
    names = [
        f"{name}{label}" for name, column in GROUPS[group].items() for label in column.names("")
    ]
    assert heading == names
    held = getattr(record, group)
    for name, column in GROUPS[group].items():
        at = [heading.index(one) for one in column.names(name)]
        cells = [[row[k] for k in at] for row in rows]
        if column.words:
            numbers = [[column.words.index(cell) for cell in row] for row in cells]
        else:
            numbers = [[float(cell or "nan") for cell in row] for row in cells]
        read = np.array(numbers, dtype=column.dtype).reshape(-1, *column.shape)
        np.testing.assert_array_equal(read, getattr(held, name))


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
