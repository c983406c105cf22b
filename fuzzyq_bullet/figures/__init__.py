"""The paper's figures, by number, and the learning curve.

A new figure is one new line in ``FIGURES``, and what draws it: a module with a function ``draw``,
or, if it is made of runs, an entry in ``runs``.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

Draw: TypeAlias = Callable[..., list[Path]]
"""Draws into a folder and returns the files written, the main one first. Figures that are made of
runs take the name of another planner, too."""
OF_RUNS = (9, 10, 11, 12)
"""Figures that are made of runs."""

MARK = "fuzzyq figure"
"""Stands as ``Software`` in every file, so that one is known again."""
FIGURES = {
    4: "step and turn over all that the fuzzy controller can be told",
    9: "an obstacle at the start or the goal, and the safer environment",
    10: "deadlock in a semicircle without breakout, and three escapes",
    11: "a large obstacle without and with sustained avoidance",
    12: "80 and 120 random obstacles, rectangles, dense rectangles",
}
"""What each figure shows, in a few words."""


def drawing(number: int) -> Draw:
    """Return the function that draws a figure; only now is its module imported.

    Raises:
        KeyError: If no figure has this number.
    """
    if number == 4:
        from fuzzyq_bullet.figures import figure4

        return figure4.draw
    from fuzzyq_bullet.figures import runs

    return runs.FIGURES[number].draw
