"""Link the names of code in ``docs/explanation`` to their lines, as ``make format`` does.

A name such as `planning.escape.Escape.aim` becomes a link to the lines where it is defined. The
lines move with the code; ``make format`` puts the links right, and a test tells when they are
wrong.
"""

from __future__ import annotations

import ast
import os
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "fuzzyq_bullet"
PAGES = sorted((ROOT / "docs" / "explanation").glob("*.md"))

DOTTED = r"(?P<name>[a-z_]+(?:\.[A-Za-z_0-9]+)+)"
PATH = r"(?P<path>(?:tests|assets|examples|fuzzyq_bullet)/[\w./-]+)"
NAME = re.compile(rf"(?P<linked>\[)?`(?:{DOTTED}|{PATH})`(?(linked)\]\([^)\s]*\))")
FENCE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)

SUFFIXES = (".md", ".yaml", ".json", ".csv", ".npz", ".png", ".mp4", ".svg", ".html")
"""A name that ends so is a file of the reader's, or a column."""


def renewed(page: Path) -> str:
    """Return the text of a page with the links of today.

    Raises:
        ValueError: If a name is not there.
    """
    text = page.read_text(encoding="utf-8")
    fenced = [match.span() for match in FENCE.finditer(text)]

    def linked(match: re.Match[str]) -> str:
        if any(start <= match.start() < end for start, end in fenced):
            return match[0]
        words = match["path"] or match["name"]
        try:
            target = place(words) if match["name"] else (ROOT / words, None)
        except KeyError:
            raise ValueError(f"{page.name}: there is no {words} in fuzzyq_bullet") from None
        if target is None:
            return match[0]
        file, lines = target
        if not file.exists():
            raise ValueError(f"{page.name}: there is no {words}")
        return f"[`{words}`]({os.path.relpath(file, page.parent)}{lines or ''})"

    return NAME.sub(linked, text)


def place(name: str) -> tuple[Path, str | None] | None:
    """Return the file of a dotted name, and its lines as GitHub has them in an address.

    Returns:
        None for a name that does not begin with a room of the package; no lines for a module.

    Raises:
        KeyError: If its room is there, and it is not.
    """
    parts = name.split(".")
    if name.endswith(SUFFIXES) or module(parts[:1]) is None:
        return None
    depth = next(n for n in range(len(parts), 0, -1) if module(parts[:n]) is not None)
    file = module(parts[:depth])
    assert file is not None
    if depth == len(parts):
        return file, None
    first, last = definitions(file)[".".join(parts[depth:])]
    return file, f"#L{first}" if first == last else f"#L{first}-L{last}"


def module(parts: list[str]) -> Path | None:
    """Return the file of a module; None if there is none."""
    stem = PACKAGE.joinpath(*parts)
    found = [one for one in (stem.with_suffix(".py"), stem / "__init__.py") if one.is_file()]
    return found[0] if found else None


@cache
def definitions(file: Path) -> dict[str, tuple[int, int]]:
    """Return the first and last line of everything that a module defines, by its name within it."""
    return dict(_defined(ast.parse(file.read_text(encoding="utf-8")), ""))


def _defined(node: ast.AST, prefix: str) -> Iterator[tuple[str, tuple[int, int]]]:
    for one in ast.iter_child_nodes(node):
        if isinstance(one, ast.ClassDef | ast.FunctionDef):
            yield prefix + one.name, (one.lineno, one.end_lineno or one.lineno)
        if isinstance(one, ast.ClassDef):
            yield from _defined(one, f"{prefix}{one.name}.")
        targets = one.targets if isinstance(one, ast.Assign) else [getattr(one, "target", None)]
        for target in targets if isinstance(one, ast.Assign | ast.AnnAssign) else []:
            if isinstance(target, ast.Name):
                yield prefix + target.id, (one.lineno, one.end_lineno or one.lineno)


if __name__ == "__main__":
    for one in PAGES:
        one.write_text(renewed(one), encoding="utf-8")
