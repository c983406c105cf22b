"""The lessons in ``docs/lessons`` as Jupyter sees them, and run without it.

``python -m tests.helpers.lessons [NAME ...]`` runs them and writes what their solutions print.
"""

from __future__ import annotations

import ast
import contextlib
import io
import os
import re
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import jupytext
import matplotlib

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "docs" / "lessons"
LESSONS = sorted(FOLDER.glob("[0-9]*.md"))

SOLUTION = re.compile(
    r"<details>\n<summary>[^\n]+</summary>\n\n```python\n(?P<code>.*?)```\n\n"
    r"It prints:\n\n```text\n(?P<prints>.*?)```\n\n(?:[^<]+\n\n)?</details>",
    re.DOTALL,
)

Show = Callable[[Any], None]
"""Called with what a cell shows: the value of its last line, or a figure."""


def notebook(lesson: Path) -> Any:
    """Return the notebook that Jupyter opens."""
    return jupytext.read(lesson, fmt="md")


@contextlib.contextmanager
def desk(folder: Path) -> Iterator[None]:
    """Make ``folder`` the checkout of a student, who sits in its ``docs/lessons``."""
    here = folder / "docs" / "lessons"
    here.mkdir(parents=True)
    (folder / "examples").symlink_to(ROOT / "examples")
    (folder / "docs" / "results").symlink_to(ROOT / "docs" / "results")
    before, path = Path.cwd(), list(sys.path)
    os.chdir(here)
    try:
        yield
    finally:
        os.chdir(before)
        sys.path[:] = path


def play(lesson: Path, show: Show) -> tuple[dict[str, Any], list[tuple[str, str]]]:
    """Run all cells of a lesson, and its solutions where they stand.

    Returns:
        What the cells left, by name; and for each solution what it says that it prints, and prints.
    """
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    def show_figures(*_: Any, **__: Any) -> None:
        for number in plt.get_fignums():
            show(plt.figure(number))
        plt.close("all")

    names: dict[str, Any] = {"__name__": "__main__"}
    solutions = []
    kept, plt.show = plt.show, show_figures  # type: ignore[assignment]
    try:
        for cell in notebook(lesson).cells:
            if cell.cell_type == "code":
                with contextlib.redirect_stdout(io.StringIO()):
                    value = _run(cell.source, names, f"{lesson.name}")
                if value is not None:
                    show(value)
                show_figures()
            for solution in SOLUTION.finditer(cell.source):
                with contextlib.redirect_stdout(io.StringIO()) as out:
                    _run(solution["code"], names, f"{lesson.name}, a solution")
                show_figures()
                solutions.append((solution["prints"], out.getvalue()))
    finally:
        plt.show = kept
    return names, solutions


def _run(source: str, names: dict[str, Any], file: str) -> Any:
    """Run a cell, and return the value of its last line, as Jupyter shows it."""
    tree = ast.parse(source)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, file, "exec"), names)
    if last is None:
        return None
    return eval(compile(ast.Expression(last.value), file, "eval"), names)


def _write(lesson: Path) -> None:
    with tempfile.TemporaryDirectory() as folder, desk(Path(folder)):
        _, solutions = play(lesson, lambda shown: None)
    printed = iter(solutions)

    def renewed(match: re.Match[str]) -> str:
        start, end = (at - match.start() for at in match.span("prints"))
        return match[0][:start] + next(printed)[1] + match[0][end:]

    lesson.write_text(SOLUTION.sub(renewed, lesson.read_text("utf-8")), "utf-8")


if __name__ == "__main__":
    for one in LESSONS:
        if not sys.argv[1:] or any(one.name.startswith(name) for name in sys.argv[1:]):
            _write(one)
