"""The paper's figures, by number, and pictures of what was learned.

A new figure is one new line in ``FIGURES``, and what draws it: a module with a function ``draw``,
or, if it is made of runs, an entry in ``runs``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from fuzzyq_bullet.errors import UserError

if TYPE_CHECKING:
    from fuzzyq_bullet.fuzzy import ControllerDefinition

Draw: TypeAlias = Callable[[Path], list[Path]]
"""Draws into a folder and returns the files written, the main one first."""
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


LEARNED = {
    "weights": "the weights that each rule has learned: of a POLICY, or of the one shipped",
    "curves": "the learning curves of the trainings that wrote the POLICY files",
}
"""Pictures of trainings, by name."""


def file_name(name: str, planner: str | None = None) -> str:
    """Return what the file of a figure is called, with the planner that drives instead, if any."""
    return f"{name}.png" if planner is None else f"{name}-{planner}.png"


def drawing(
    number: int,
    planner: str | None = None,
    rules: ControllerDefinition | None = None,
    variant: str | None = None,
) -> Draw:
    """Return the function that draws a figure; only now is its module imported.

    Args:
        number: Of the figure.
        planner: Planner that drives instead; only for those ``OF_RUNS``.
        rules: Controller to show instead of the paper's; only for figure 4.
        variant: What its file is called beside its number; only for figure 4.

    Raises:
        KeyError: If no figure has this number.
    """
    if number == 4:
        from fuzzyq_bullet.figures import figure4

        return partial(figure4.draw, rules=rules, name=file_name("figure4", variant))
    from fuzzyq_bullet.figures import runs

    return partial(runs.FIGURES[number].draw, planner=planner)


def drawing_learned(
    name: str, policies: Sequence[Path], rules: ControllerDefinition | None = None
) -> Draw:
    """Return the function that draws a picture of ``LEARNED``.

    Args:
        name: Of the picture.
        policies: What it shows.
        rules: The rules that the policy of ``weights`` weighs; by default those of Table 4.

    Raises:
        UserError: If more policies are named than it shows.
    """
    if name == "curves":
        from fuzzyq_bullet.figures import curves

        return partial(curves.draw, policies=policies)
    from fuzzyq_bullet.figures import rule_weights

    if len(policies) > 1:
        raise UserError(f"POLICY: weights shows one policy, got {len(policies)}")
    return partial(rule_weights.draw, policy=policies[0] if policies else None, rules=rules)
