"""Files that hold a controller, read and written by suffix.

A format is a module with ``read``, text to a tree of plain data with line numbers in the form of
``fuzzy.definition``, and ``write``, a controller to text.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from pydantic import ValidationError

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import read_text, written_beside
from fuzzyq_bullet.fuzzy.definition import ControllerDefinition
from fuzzyq_bullet.fuzzy.formats import fis, fll, yaml_format
from fuzzyq_bullet.reading.kinds import RULES, refuse_other_kind
from fuzzyq_bullet.reading.problems import Problem, keys_at, lines_of, problem_of
from fuzzyq_bullet.reading.yaml_tree import Node
from fuzzyq_bullet.wording import shorten

MAX_BYTES = 200_000
"""Largest file of a controller: one of 15 × 15 rules takes about 10 kB."""


class Format(NamedTuple):
    """How one kind of file is read and written.

    Attributes:
        read: Takes the text and what to call it, and raises ``UserError`` with the line.
        write: Takes the controller.
    """

    read: Callable[[str, str], Node]
    write: Callable[[ControllerDefinition], str]


FORMATS = {
    ".yaml": Format(yaml_format.read, yaml_format.write),
    ".yml": Format(yaml_format.read, yaml_format.write),
    ".fll": Format(fll.read, fll.write),
    ".fis": Format(fis.read, fis.write),
}
"""By suffix: our own, the FuzzyLite Language, and the Fuzzy Logic Toolbox's."""


def format_of(path: Path) -> Format:
    """Return the format of a file by its suffix.

    Raises:
        UserError: If it is none of them.
    """
    if path.suffix.lower() not in FORMATS:
        raise UserError(
            f"{path}: a file of rules ends in {', '.join(FORMATS)}, got {shorten(path.suffix)}"
        )
    return FORMATS[path.suffix.lower()]


def load_controller(path: Path | str) -> ControllerDefinition:
    """Read a controller from a file.

    Args:
        path: A ``.yaml`` (docs/how-to/rules.md), ``.fll`` (FuzzyLite Language) or ``.fis`` file
            (Fuzzy Logic Toolbox) of a Mamdani controller with two inputs and two outputs.

    Raises:
        UserError: If it cannot be read or is wrong; one line a mistake:
            ``path:line: key.path: what is wrong; what is allowed``.
    """
    path = Path(path)
    read = format_of(path).read
    text = read_text(path, what="a controller", most=MAX_BYTES)
    where, tree = str(path), read(text, str(path))
    if not isinstance(tree.data, dict):
        raise UserError(
            f"{where}:{tree.line}: expected a mapping with the keys inputs, outputs and rules, "
            f"got {shorten(tree.data)}"
        )
    try:
        return ControllerDefinition.model_validate(tree.data)
    except ValidationError as error:
        refuse_other_kind(where, tree.data, RULES)
        raise UserError(*lines_of(_problems_in(error), 0, tree, where)) from error


def _problems_in(error: ValidationError) -> list[Problem]:
    """Return each mistake once."""
    found: dict[tuple[str | int, ...], Problem] = {}
    for item in error.errors(include_url=False):
        loc = tuple(part for part in item["loc"] if part != "[key]")
        keys = keys_at([ControllerDefinition], loc[:-1])
        found.setdefault(loc, problem_of(dict(item), loc, keys))
    return list(found.values())


def save_controller(definition: ControllerDefinition, path: Path | str) -> None:
    """Write a controller to a file, whole or not at all, in the format of its suffix.

    Raises:
        UserError: If the suffix is none of a format, or the file cannot be written.
    """
    path = Path(path)
    text = format_of(path).write(definition)
    with written_beside(path) as part:
        part.write_text(text, encoding="utf-8")
