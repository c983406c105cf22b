"""Values of other programs' YAML files, read with the line and key of every mistake."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import read_text
from fuzzyq_bullet.reading.yaml_tree import Key, Node, read_tree
from fuzzyq_bullet.wording import not_one_of, shorten

_MAX_BYTES = 2_000_000


def read_yaml(path: Path, what: str) -> Mapping:
    """Return the mapping that a YAML file holds.

    Raises:
        UserError: If it cannot be read, or is no mapping.
    """
    tree = read_tree(read_text(path, what=what, most=_MAX_BYTES), str(path))
    if not isinstance(tree.data, dict):
        raise UserError(f"{path}:{tree.line}: expected the keys of {what}")
    return Mapping(tree, str(path), "")


def keys_in(path: Path) -> set[str]:
    """Return the keys at the top of a YAML file; none if it cannot be read."""
    try:
        return set(read_yaml(path, "a map").node.data)
    except UserError:
        return set()


class Mapping:
    """A mapping, or a list by its numbers, in a YAML file.

    Args:
        node: Its place in the file.
        path: The file.
        key: The keys that lead to it.
    """

    def __init__(self, node: Node, path: str, key: str) -> None:
        self.node = node
        self._path = path
        self._key = key

    def __contains__(self, key: Key) -> bool:
        return key in self.node.children

    def where(self, key: Key) -> str:
        """Return file, line and key of a value, for messages."""
        line = self.node.lines.get(key, self.node.line)
        name = f"{self._key}[{key}]" if isinstance(key, int) else f"{self._key}.{key}".lstrip(".")
        return f"{self._path}:{line}: {name}"

    def at(self, key: Key) -> str:
        """Return line and key of a value, for notes that go into a file."""
        return self.where(key).removeprefix(f"{self._path}:").replace(": ", " ", 1)

    def get(self, key: Key) -> Any:
        """Return a value as plain data; None if it is not there."""
        child = self.node.children.get(key)
        return None if child is None else child.data

    def inner(self, key: Key) -> Mapping:
        """Return what is below a key.

        Raises:
            UserError: If it is not there, or neither mapping nor list.
        """
        child = self.node.children.get(key)
        if child is None or not isinstance(child.data, dict | list):
            got = "nothing" if child is None else shorten(child.data)
            raise UserError(f"{self.where(key)}: expected a mapping or a list, got {got}")
        name = self.at(key).split(" ", 1)[1]
        return Mapping(child, self._path, name)

    def items(self, key: Key) -> list[Mapping]:
        """Return the mappings below a key: those of a list, or the one that stands there.

        Raises:
            UserError: If there are others.
        """
        if self.get(key) is None:
            return []
        inner = self.inner(key)
        if isinstance(inner.node.data, dict):
            return [inner]
        found = [inner.inner(i) for i in range(len(inner.node.data))]
        for i, one in enumerate(found):
            if not isinstance(one.node.data, dict):
                raise UserError(f"{inner.where(i)}: expected a mapping")
        return found

    def number(
        self,
        key: Key,
        default: float | None = None,
        *,
        least: float = -math.inf,
        most: float = math.inf,
    ) -> float:
        """Return a number.

        Raises:
            UserError: If it is missing without a default, is none, or is out of bounds.
        """
        value = self.get(key)
        if value is None and key not in self and default is not None:
            return default
        if isinstance(value, bool) or not isinstance(value, int | float):
            got = "nothing" if value is None else shorten(value)
            raise UserError(f"{self.where(key)}: expected a number, got {got}")
        if isinstance(value, int):
            value = float(value) if abs(value) < 10**15 else math.inf
        if not math.isfinite(value):
            raise UserError(f"{self.where(key)}: {value} is not a finite number")
        if not least <= value <= most:
            raise UserError(
                f"{self.where(key)}: {value:g} is out of bounds; allowed: {least:g} to {most:g}"
            )
        return value

    def numbers(self, key: Key, least: int, most: int) -> list[float]:
        """Return a list of numbers.

        Raises:
            UserError: If it is none, or has fewer or more.
        """
        value = self.get(key)
        if not isinstance(value, list) or not least <= len(value) <= most:
            count = str(least) if least == most else f"{least} to {most}"
            got = "nothing" if value is None else shorten(value)
            raise UserError(f"{self.where(key)}: expected a list of {count} numbers, got {got}")
        inner = self.inner(key)
        return [inner.number(i) for i in range(len(value))]

    def one_of(self, key: Key, allowed: Sequence[str], default: str) -> str:
        """Return one of some words.

        Raises:
            UserError: If it is another one.
        """
        value = self.get(key)
        if value is None:
            return default
        if value not in allowed:
            raise UserError(f"{self.where(key)}: {not_one_of(str(key), value, allowed)}")
        return str(value)
