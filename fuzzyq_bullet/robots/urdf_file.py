"""A URDF as it is written: links and joints with their lines, every number read and bounded."""

from __future__ import annotations

import math
from pathlib import Path

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import read_bytes
from fuzzyq_bullet.reading.xml_tree import Element, parse_xml

MAX_BYTES = 1_000_000
_MAX_LINE = 8_000
"""A longer line is an XML error to PyBullet (letters)."""


class Reader:
    """Reads values of a URDF; what is wrong becomes one line with file and line.

    Args:
        path: The file.
    """

    def __init__(self, path: Path) -> None:
        self.path = path

    def error(self, at: Element | int, why: str) -> UserError:
        """Return the error that says what is wrong at an element or line."""
        line = at if isinstance(at, int) else at.line
        return UserError(f"{self.path}:{line}: {why}")

    def text(self, element: Element, key: str) -> str:
        """Return an attribute that must be there."""
        value = element.attributes.get(key, "").strip()
        if not value:
            raise self.error(element, f"<{element.tag}> has no {key}")
        return value

    def numbers(
        self, element: Element, key: str, count: int, default: str | None = None
    ) -> tuple[float, ...]:
        """Return an attribute of so many finite numbers, each within 1000."""
        text = element.attributes.get(key, default)
        if text is None:
            raise self.error(element, f"<{element.tag}> has no {key}")
        shown = f"{key}={text[:40]!r}"
        if "${" in text:
            raise self.error(element, f"{shown}: this is a xacro; expand it first: xacro IN > OUT")
        try:
            values = tuple(float(word) for word in text.split())
        except ValueError:
            raise self.error(element, f"{shown}: must be {_numbers(count)}") from None
        if len(values) != count or not all(math.isfinite(value) for value in values):
            raise self.error(element, f"{shown}: must be {_numbers(count)}, finite")
        if any(abs(value) > 1000.0 for value in values):
            raise self.error(element, f"{shown}: must be within 1000 (metres, kilograms, radians)")
        return values

    def positive(self, element: Element, key: str, count: int = 1) -> tuple[float, ...]:
        """Return an attribute of so many numbers greater than 0."""
        values = self.numbers(element, key, count)
        if min(values) <= 0.0:
            raise self.error(element, f"{key} must be greater than 0, got {min(values):g}")
        return values


def read_urdf(path: Path) -> Element:
    """Return the ``<robot>`` element of a URDF.

    Raises:
        UserError: If it cannot be read, or is no URDF; one line.
    """
    content = read_bytes(path, what="a robot (URDF)", most=MAX_BYTES)
    reader = Reader(path)
    for number, letters in enumerate(map(len, content.splitlines()), 1):
        if letters > _MAX_LINE:
            raise reader.error(number, f"a line of {letters} letters; at most {_MAX_LINE}")
    root = parse_xml(content, path, "a robot")
    if root.tag != "robot":
        raise reader.error(1, f"holds <{root.tag[:40]}>; a URDF holds one <robot>")
    return root


def _numbers(count: int) -> str:
    return "a number" if count == 1 else f"{count} numbers"
