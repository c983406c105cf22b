"""The paper's figures, by number: each a module of its own with a function ``draw``.

A new figure is one new module here and one line in ``FIGURES``.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import NamedTuple, TypeAlias, cast

Draw: TypeAlias = Callable[[Path], list[Path]]
"""Draws into a folder and returns the files written, the main one first."""


class Entry(NamedTuple):
    """One line of the registry.

    Attributes:
        module: Name of the module in this package that draws the figure.
        shows: What the figure shows, in a few words.
    """

    module: str
    shows: str


FIGURES: dict[int, Entry] = {
    4: Entry("figure4", "step and turn over all that the fuzzy controller can be told"),
    9: Entry("figure9", "an obstacle at the start or the goal, and the safer environment"),
    10: Entry("figure10", "deadlock in a semicircle without breakout, and three escapes"),
    11: Entry("figure11", "a large obstacle without and with sustained avoidance"),
    12: Entry("figure12", "80 and 120 random obstacles, rectangles, dense rectangles"),
}


def drawing(number: int) -> Draw:
    """Return the function that draws a figure; only now is its module imported.

    Raises:
        KeyError: If no figure has this number.
    """
    module = import_module(f"{__name__}.{FIGURES[number].module}")
    return cast("Draw", module.draw)
