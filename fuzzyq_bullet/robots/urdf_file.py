"""A URDF as it is written: links and joints with their lines, every number read and bounded."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from xml.sax import SAXException, SAXParseException
from xml.sax.handler import ContentHandler
from xml.sax.xmlreader import AttributesImpl

from defusedxml import DefusedXmlException
from defusedxml.sax import parse as parse_xml

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import read_bytes

MAX_BYTES = 1_000_000
_MAX_ELEMENTS = 20_000
_MAX_DEPTH = 30
_MAX_LINE = 8_000
"""A longer line is an XML error to PyBullet (letters)."""


@dataclass
class Element:
    """One XML element, with the line on which it begins."""

    tag: str
    attributes: dict[str, str]
    line: int
    children: list[Element] = field(default_factory=list)

    def all(self, tag: str) -> list[Element]:
        """Return the children of that tag."""
        return [child for child in self.children if child.tag == tag]

    def first(self, tag: str) -> Element | None:
        """Return the first child of that tag, if there is one."""
        return next(iter(self.all(tag)), None)


class UrdfError(UserError):
    """A mistake in a URDF: one line with file and line."""


class Reader:
    """Reads values of a URDF; what is wrong becomes one line with file and line.

    Args:
        path: The file.
    """

    def __init__(self, path: Path) -> None:
        self.path = path

    def error(self, at: Element | int, why: str) -> UrdfError:
        """Return the error that says what is wrong at an element or line."""
        line = at if isinstance(at, int) else at.line
        return UrdfError(f"{self.path}:{line}: {why}")

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

    Entities and document types are refused: they are how XML blows up.

    Raises:
        UserError: If it cannot be read, or is no URDF; one line.
    """
    content = read_bytes(path, what="a robot (URDF)", most=MAX_BYTES)
    reader = Reader(path)
    for number, letters in enumerate(map(len, content.splitlines()), 1):
        if letters > _MAX_LINE:
            raise reader.error(number, f"a line of {letters} letters; at most {_MAX_LINE}")
    tree = _Tree(reader)
    try:
        parse_xml(BytesIO(content), tree, forbid_dtd=True)
    except DefusedXmlException as error:
        raise reader.error(1, "document types and entities are not allowed in a URDF") from error
    except SAXParseException as error:
        line = error.getLineNumber() or 1
        raise reader.error(line, f"not valid XML: {error.getMessage()}") from error
    except (SAXException, ValueError, LookupError) as error:  # an unknown encoding
        raise reader.error(1, f"not valid XML: {error}") from error
    root = tree.root
    if root is None or root.tag != "robot":
        name = "nothing" if root is None else f"<{root.tag[:40]}>"
        raise reader.error(1, f"holds {name}; a URDF holds one <robot>")
    return root


class _Tree(ContentHandler):
    def __init__(self, reader: Reader) -> None:
        super().__init__()
        self.root: Element | None = None
        self._reader, self._open, self._count = reader, list[Element](), 0

    def startElement(self, name: str, attrs: AttributesImpl) -> None:  # noqa: N802
        line = self._locator.getLineNumber() or 1  # type: ignore[attr-defined]
        self._count += 1
        if self._count > _MAX_ELEMENTS or len(self._open) > _MAX_DEPTH:
            raise self._reader.error(line, "too many elements, or nested too deeply, for a robot")
        element = Element(name, dict(attrs.items()), line)
        if self._open:
            self._open[-1].children.append(element)
        else:
            self.root = element
        self._open.append(element)

    def endElement(self, name: str) -> None:  # noqa: N802
        self._open.pop()


def _numbers(count: int) -> str:
    return "a number" if count == 1 else f"{count} numbers"
