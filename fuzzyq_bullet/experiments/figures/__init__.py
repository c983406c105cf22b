"""The paper's figures, by number.

A new figure is one new line in ``FIGURES``, and what draws it: a module with a function ``draw``,
or, if it is made of runs, an entry in ``runs``.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple, TypeAlias

Draw: TypeAlias = Callable[[Path], list[Path]]
"""Draws into a folder and returns the files written, the main one first."""


MARK = "fuzzyq figure"
"""Stands as ``Software`` in every file, so that one is known again."""


class Entry(NamedTuple):
    """One line of the registry.

    Attributes:
        shows: What the figure shows, in a few words.
    """

    shows: str


FIGURES: dict[int, Entry] = {
    4: Entry("step and turn over all that the fuzzy controller can be told"),
    9: Entry("an obstacle at the start or the goal, and the safer environment"),
    10: Entry("deadlock in a semicircle without breakout, and three escapes"),
    11: Entry("a large obstacle without and with sustained avoidance"),
    12: Entry("80 and 120 random obstacles, rectangles, dense rectangles"),
}


def drawing(number: int) -> Draw:
    """Return the function that draws a figure; only now is its module imported.

    Raises:
        KeyError: If no figure has this number.
    """
    if number == 4:
        from fuzzyq_bullet.experiments.figures import figure4

        return figure4.draw
    from fuzzyq_bullet.experiments.figures import runs

    return runs.FIGURES[number].draw
