"""YAML text to plain data that remembers its lines; safe and quick on whatever it is given.

Reads the parser's events instead of composing a document: events come from a loop, so no depth of
nesting can exhaust the stack, and every limit below stops the work where it is exceeded. Plain
scalars follow YAML 1.2 (``1e-1`` is a number, ``yes`` is text), not PyYAML's 1.1.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any, TypeAlias

import yaml

from fuzzyq_bullet.errors import UserError

MAX_NODES = 200_000
"""Most keys and values in one file, aliases counted wherever used. 10 000 boxes: 130 000."""
MAX_DEPTH = 20

Key: TypeAlias = "str | int"

_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_INTEGER = re.compile(r"[-+]?[0-9]{1,300}")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_WHOLE, _DIGITS = re.compile(r"[-+]?[0-9]+"), re.compile(r"[0-9]+")
_COMMA = re.compile(r"[-+]?[0-9]+,[0-9]+")
_MOST_COMMAS = 10
"""Most decimal commas that are told of."""
_WORDS: dict[str, Any] = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL")),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
    **dict.fromkeys((".nan", ".NaN", ".NAN"), float("nan")),
    **dict.fromkeys((".inf", ".Inf", ".INF", "+.inf", "+.Inf", "+.INF"), float("inf")),
    **dict.fromkeys(("-.inf", "-.Inf", "-.INF"), float("-inf")),
}


_NO_CHILDREN: dict[Key, Node] = {}  # shared by all plain values, and never written to
_NO_LINES: dict[Key, int] = {}


@dataclass(slots=True)
class Node:
    """One value of the document.

    Attributes:
        data: The value as plain data: dict, list, str, int, float, bool or None.
        line: The line it begins on, counted from 1.
        children: The values inside a mapping (by key) or a list (by index).
        lines: The line of each key of a mapping, of each item of a list.
        count: How many values it holds, itself included, aliases expanded.
    """

    data: Any
    line: int
    children: dict[Key, Node]
    lines: dict[Key, int]
    count: int = 1

    def line_of(self, key: Key) -> int:
        """Return the line of one child: of its key in a mapping, of the item in a list."""
        return self.lines[key]


@dataclass(slots=True)
class _Open:
    """A mapping or list whose end has not come yet."""

    node: Node
    anchor: str | None
    key: str | None = None


def read_tree(text: str, where: str) -> Node:
    """Read one YAML document.

    Args:
        text: The document.
        where: What to call it in messages: the file's path.

    Raises:
        UserError: If the text is not YAML, is empty or several documents, repeats a key, uses
            tags, directives or keys that are not text, or is too deep or too large.
    """
    # The parser compares every directive with all before: quadratic, and nobody needs them.
    directive = re.search(r"^%", text, re.MULTILINE)
    if directive:
        line = text.count("\n", 0, directive.start()) + 1
        raise UserError(
            f"{where}:{line}: YAML directives (lines that begin with %) are not allowed"
        )
    loader = _LOADER(text)
    try:
        return _Builder(where).build(loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = mark.line + 1 if mark is not None else 1
        context = f"{error.context}, " if error.context else ""
        why = f"{context}{error.problem}"
        if _is_indented_by_tab(text, line):
            why = "tabs cannot indent; use spaces"
        raise UserError(f"{where}:{line}: not valid YAML: {why}") from error
    except yaml.YAMLError as error:
        line = _line_of_unprintable(text)
        raise UserError(f"{where}:{line}: not valid YAML: an unprintable character") from error
    finally:
        loader.dispose()


def _is_indented_by_tab(text: str, line: int) -> bool:
    lines = re.split(r"\r\n|[\r\n\x85\u2028\u2029]", text)[line - 1 : line]
    return any(re.match(r" *\t", shown) for shown in lines)


def _line_of_unprintable(text: str) -> int:
    found = yaml.reader.Reader.NON_PRINTABLE.search(text)
    return text.count("\n", 0, found.start()) + 1 if found else 1


class _Builder:
    """Builds the tree of one document from the parser's events."""

    def __init__(self, where: str) -> None:
        self.where = where
        self.count = 0
        self.anchors: dict[str, Node | None] = {}  # None: not finished yet
        self.open: list[_Open] = []
        self.commas: list[str] = []  # a line for each decimal comma
        self.before: Any = None  # the plain value that was read last

    def build(self, loader: Any) -> Node:
        root: Node | None = None
        while loader.check_event():
            event = loader.get_event()
            line = event.start_mark.line + 1
            if isinstance(event, yaml.ScalarEvent):
                finished = self._scalar(event, line)
            elif isinstance(event, yaml.AliasEvent):
                finished = self._alias(event, line)
            elif isinstance(event, yaml.CollectionStartEvent):
                self._begin(event, line)
                continue
            elif isinstance(event, yaml.CollectionEndEvent):
                finished = self._end()
            elif isinstance(event, yaml.DocumentStartEvent) and root is not None:
                raise self._error(line, "a second document begins; one in a file")
            else:
                continue
            if finished is None:
                continue
            if self.open:
                self._place(finished, line if isinstance(event, yaml.AliasEvent) else finished.line)
            else:
                root = finished
        if self.commas:
            raise UserError(*self.commas[:_MOST_COMMAS])
        if root is None:
            raise self._error(1, "the file is empty")
        return root

    def _scalar(self, event: Any, line: int) -> Node | None:
        self._refuse_tag(event, line)
        self._spend(1, line)
        plain = event.style is None or event.style == ""
        value = _resolve(event.value) if plain else event.value
        if self._awaits_key():
            if plain and self._goes_on(event):
                value = self._note_comma(event.value, line)
            if not isinstance(value, str):
                shown = event.value or "nothing"
                raise self._error(line, f"a key must be text, got {shown:.40}; put it in quotes")
            self._open_key(value, line)
            return None
        self.before = event if plain else None
        node = Node(value, line, _NO_CHILDREN, _NO_LINES)
        if event.anchor:
            self.anchors[event.anchor] = node
        return node

    def _alias(self, event: Any, line: int) -> Node:
        if event.anchor not in self.anchors:
            raise self._error(line, f"the alias *{event.anchor:.60} has no anchor before it")
        node = self.anchors[event.anchor]
        if node is None:
            raise self._error(line, f"the alias *{event.anchor:.60} contains itself")
        if self._awaits_key():
            raise self._error(line, "a key must be text, got an alias")
        self._spend(node.count, line)
        return node

    def _begin(self, event: Any, line: int) -> None:
        self._refuse_tag(event, line)
        self._spend(1, line)
        if self._awaits_key():
            raise self._error(line, "a key must be text, got a list or mapping")
        if len(self.open) >= MAX_DEPTH:
            raise self._error(line, f"nested deeper than {MAX_DEPTH} levels")
        if event.anchor:
            self.anchors[event.anchor] = None
        data: Any = {} if isinstance(event, yaml.MappingStartEvent) else []
        self.open.append(_Open(Node(data, line, {}, {}), event.anchor))

    def _end(self) -> Node:
        closed = self.open.pop()
        if closed.anchor:
            self.anchors[closed.anchor] = closed.node
        return closed.node

    def _place(self, node: Node, line: int) -> None:
        parent = self.open[-1]
        parent.node.count += node.count
        if parent.key is None:
            index = len(parent.node.data)
            parent.node.children[index] = node
            parent.node.lines[index] = line
            parent.node.data.append(node.data)
        else:
            parent.node.children[parent.key] = node
            parent.node.data[parent.key] = node.data
            parent.key = None

    def _awaits_key(self) -> bool:
        return (
            bool(self.open)
            and isinstance(self.open[-1].node.data, dict)
            and (self.open[-1].key is None)
        )

    def _open_key(self, key: str, line: int) -> None:
        parent = self.open[-1]
        if key in parent.node.lines:
            before = parent.node.lines[key]
            raise self._error(line, f"the key {key!r:.60} is given twice, first on line {before}")
        parent.node.lines[key] = line
        parent.key = key

    def _goes_on(self, event: Any) -> bool:
        """Tell whether digits stand right behind a whole number: with a comma in between."""
        if self.before is None or not _DIGITS.fullmatch(event.value):
            return False
        end, begin = self.before.end_mark, event.start_mark
        beside = (begin.line, begin.column) == (end.line, end.column + 1)
        return beside and _WHOLE.fullmatch(self.before.value) is not None

    def _note_comma(self, digits: str, line: int) -> str:
        """Note that ``radius: 0,3`` in braces is no value 0 with a key 3 behind it.

        Returns:
            A key under which the document can be read to its end: there may be more of them.
        """
        steps = [
            f"[{len(one.node.data)}]" if one.key is None else f".{one.key:.60}"
            for one in self.open[:-1]
        ]
        key = next(reversed(self.open[-1].node.data))
        place = "".join((*steps, f".{key:.60}")).lstrip(".")
        told = f"{self.before.value:.20},{digits:.20}"
        self.commas.append(f"{self.where}:{line}: {place}: {decimal_comma(told)}")
        return f"{key} {told}"

    def _spend(self, nodes: int, line: int) -> None:
        self.count += nodes
        if self.count > MAX_NODES:
            raise self._error(line, f"holds more than {MAX_NODES} values, aliases expanded")

    def _refuse_tag(self, event: Any, line: int) -> None:
        if event.tag is not None:
            raise self._error(line, f"tags are not allowed, got {event.tag:.60}")

    def _error(self, line: int, message: str) -> UserError:
        return UserError(f"{self.where}:{line}: {message}")


def decimal_comma(text: str) -> str:
    """Say what is wrong with ``0,3``; nothing about what is no number with a comma."""
    if not _COMMA.fullmatch(text):
        return ""
    return f"{text:.40} has a decimal comma; write {text.replace(',', '.'):.40}"


def _resolve(text: str) -> Any:
    """Return what a plain scalar means in YAML 1.2."""
    if text in _WORDS:
        return _WORDS[text]
    if _INTEGER.fullmatch(text):
        return int(text)
    if _FLOAT.fullmatch(text):
        return float(text)
    return text
