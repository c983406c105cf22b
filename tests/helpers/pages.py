"""The pages of the documentation: their blocks of code, and what the blocks ask of a test.

A comment in front of a block, which no reader sees, says what else there is to know of it:

- ``<!-- file: NAME -->``: the reader saves the block under this name, and so does the test.
- ``<!-- not run: REASON -->``: the commands are only read by the command line, and not run.
- ``<!-- tested with: COMMAND OPTIONS; ... -->``: these commands of ``fuzzyq`` are run with these
  options added, which make them shorter.
- ``<!-- exits with: CODE or CODE -->``: commands of the block may end so.
- ``<!-- printed -->``: the last command printed all lines of the block, but for ``...``.

And anywhere ``<!-- given: NAME = PATH -->``: the reader has a file; the test takes this one.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
PAGES = [
    ROOT / "README.md",
    ROOT / "CONTRIBUTING.md",
    *sorted(p for p in DOCS.rglob("*.md") if not p.match("docs/lessons/[0-9]*.md")),
]
"""All but the lessons, whose cells tests/test_lessons.py runs."""
NAMES = [page.relative_to(ROOT).as_posix() for page in PAGES]

FENCE = re.compile(
    r"(?P<notes>(?:^<!-- [^\n]* -->\n)*)"
    r"^(?P<indent> *)```(?P<kind>\w*)[^\n]*\n(?P<code>.*?)^ *```$",
    re.MULTILINE | re.DOTALL,
)
NOTE = re.compile(
    r"<!-- (?P<key>file|not run|tested with|exits with|printed)(?:: (?P<what>.+?))? -->"
)
GIVEN = re.compile(r"<!-- given: (?P<name>\S+) = (?P<path>\S+) -->")
INLINE = re.compile(r"(?<!`)`(?P<command>fuzzyq [a-z][^`]+)`(?!`)")


@dataclass(frozen=True)
class Block:
    """A block of code.

    Attributes:
        page: The page that it is on.
        line: Where it begins.
        kind: What follows the backticks, such as ``sh``.
        code: What is in it.
        notes: What the comments in front of it say.
    """

    page: Path
    line: int
    kind: str
    code: str
    notes: dict[str, str] = field(default_factory=dict)

    @property
    def place(self) -> str:
        """Where it is, for a message."""
        return f"{self.page.relative_to(ROOT)}:{self.line}"

    def commands(self) -> list[list[str]]:
        """Return the commands of a block for the shell, each as its words."""
        joined = self.code.replace("\\\n", " ")
        found = [shlex.split(line, comments=True) for line in joined.splitlines()]
        return [[words[0].removeprefix(".venv/bin/"), *words[1:]] for words in found if words]


def blocks(page: Path) -> list[Block]:
    """Return the blocks of a page in their order."""
    text = page.read_text(encoding="utf-8")
    return [
        Block(
            page,
            text.count("\n", 0, match.start("indent")) + 1,
            match["kind"],
            re.sub(rf"^{match['indent']}", "", match["code"], flags=re.MULTILINE),
            {note["key"]: note["what"] or "" for note in NOTE.finditer(match["notes"])},
        )
        for match in FENCE.finditer(text)
    ]


def given(page: Path) -> dict[str, Path]:
    """Return the files that the reader of a page has, by name."""
    text = page.read_text(encoding="utf-8")
    return {one["name"]: ROOT / one["path"] for one in GIVEN.finditer(text)}


def inline_commands(page: Path) -> Iterator[list[str]]:
    """Yield the commands that stand within a line, such as `fuzzyq run mixed`, as words."""
    text = FENCE.sub("", page.read_text(encoding="utf-8"))
    for match in INLINE.finditer(text):
        yield shlex.split(" ".join(match["command"].split()))
