"""XML of other people read into plain elements that know their lines, and blown up by nothing."""

from __future__ import annotations

import xml.sax
import xml.sax.handler
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import read_bytes
from fuzzyq_bullet.reading.untrusted import number
from fuzzyq_bullet.wording import shorten

_MAX_BYTES = 20_000_000
_MAX_ELEMENTS = 500_000
_MAX_DEPTH = 60
_MAX_TEXT = 10_000


@dataclass(slots=True)
class Element:
    """One element.

    Attributes:
        tag: What it is called.
        attributes: Its attributes.
        path: The file it is in.
        line: The line it begins on, counted from 1.
        children: The elements in it.
        text: The text before, between and behind them.
    """

    tag: str
    attributes: dict[str, str]
    path: Path
    line: int
    children: list[Element] = field(default_factory=list)
    text: str = ""

    @property
    def name(self) -> str:
        """Its attribute ``name``, shortened, or else its tag."""
        return self.attributes.get("name", self.tag)[:60]

    @property
    def where(self) -> str:
        """File, line and tag, for messages."""
        return f"{self.path}:{self.line}: {self.tag}"

    def first(self, tag: str) -> Element | None:
        """Return the first child of that tag, if there is one."""
        return next(self.every(tag), None)

    def every(self, *tags: str) -> Iterator[Element]:
        """Yield the children of those tags."""
        return (child for child in self.children if child.tag in tags)

    def need(self, tag: str) -> Element:
        """Return the first child of that tag.

        Raises:
            UserError: If there is none.
        """
        child = self.first(tag)
        if child is None:
            raise UserError(f"{self.where}: <{tag}> is missing")
        return child

    def numbers(self, *counts: int, positive: bool = False) -> list[float]:
        """Return the numbers in its text.

        Args:
            counts: How many there may be.
            positive: Whether all are greater than 0.

        Raises:
            UserError: If there are more or fewer, or they are not what is asked for.
        """
        words = self.text.split()
        if len(words) not in counts:
            count = " or ".join(map(str, counts))
            what = "number" if counts == (1,) else "numbers"
            raise UserError(f"{self.where}: expected {count} {what}, got {shorten(self.text)}")
        found = [number(word, self.where, least=-1e6, most=1e6) for word in words]
        if positive and min(found) <= 0.0:
            raise UserError(f"{self.where}: {min(found):g} m is no size; it must be more than 0")
        return found


def read_xml(path: Path, what: str) -> Element:
    """Return the outermost element of an XML file.

    Raises:
        UserError: If it cannot be read, or as ``parse_xml``.
    """
    return parse_xml(read_bytes(path, what=what, most=_MAX_BYTES), path, what)


def parse_xml(content: bytes, path: Path, what: str) -> Element:
    """Return the outermost element of XML that was read.

    Entities and document types are refused: they are how XML blows up.

    Args:
        content: What was read.
        path: The file that it was read from.
        what: What it should be, in words.

    Raises:
        UserError: If it is no XML, declares entities or a document type, or is too deep; one line.
    """
    from defusedxml import DefusedXmlException
    from defusedxml.sax import parseString

    builder = _Builder(path)
    try:
        parseString(content, builder, forbid_dtd=True)
    except DefusedXmlException as error:
        raise UserError(
            f"{path}:{builder.line}: declares a document type or entities, which {what} does not "
            "need; take <!DOCTYPE ...> out"
        ) from error
    except xml.sax.SAXParseException as error:
        why = error.getMessage()
        raise UserError(f"{path}:{error.getLineNumber()}: is not valid XML: {why}") from error
    except (LookupError, ValueError) as error:  # an encoding that nobody knows
        raise UserError(f"{path}: is not valid XML: {error}") from error
    assert builder.root is not None
    return builder.root


class _Builder(xml.sax.handler.ContentHandler):
    """Builds the elements of one document from the parser's events."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.root: Element | None = None
        self._path = path
        self._open: list[Element] = []
        self._count = 0
        self._locator: Any = None

    def setDocumentLocator(self, locator: Any) -> None:  # noqa: N802
        """Keep what knows the line."""
        self._locator = locator

    @property
    def line(self) -> int:
        """Where the parser is; 1 where it does not know."""
        return (self._locator.getLineNumber() if self._locator is not None else None) or 1

    def startElement(self, name: str, attrs: Any) -> None:  # noqa: N802
        """Begin an element."""
        line = self.line
        self._count += 1
        if self._count > _MAX_ELEMENTS:
            raise UserError(f"{self._path}:{line}: more than {_MAX_ELEMENTS} elements")
        if len(self._open) >= _MAX_DEPTH:
            raise UserError(f"{self._path}:{line}: nested deeper than {_MAX_DEPTH} levels")
        element = Element(name, dict(attrs.items()), self._path, line)
        if self._open:
            self._open[-1].children.append(element)
        else:
            self.root = element
        self._open.append(element)

    def endElement(self, name: str) -> None:  # noqa: N802
        """End the innermost element."""
        self._open.pop()

    def characters(self, content: str) -> None:
        """Add text to the innermost element."""
        if len(self._open[-1].text) < _MAX_TEXT:  # it comes in pieces, as small as one letter
            self._open[-1].text += content
