"""What was learned: the weights ω1 and ω2 of every rule, as two tables to look at."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fuzzyq_bullet.figures import MARK
from fuzzyq_bullet.figures.style import INK, new_figure, plain, save_png
from fuzzyq_bullet.files import writable_folder
from fuzzyq_bullet.fuzzy import ControllerDefinition, paper_controller
from fuzzyq_bullet.fuzzy.memberships import Floats
from fuzzyq_bullet.fuzzy.rules import RuleBase
from fuzzyq_bullet.planning.fuzzy_q_lambda import learned_policy, weights_of


def draw(
    out: Path, policy: Path | None = None, rules: ControllerDefinition | None = None
) -> list[Path]:
    """Draw the weights of a policy, by default the shipped one, into ``out/weights.png``.

    Raises:
        UserError: If the policy cannot be used, or the file cannot be written.
    """
    learned = learned_policy(None if policy is None else str(policy), rules)
    base = None if rules is None else rules.controller().base
    path = writable_folder(out) / "weights.png"
    title = f"Learned in {learned.episodes} episodes ({plain(learned.drive)}, seed {learned.seed})"
    save_png(picture(weights_of(learned), title, base), path, metadata={"Software": MARK})
    return [path]


def picture(weights: Floats, title: str, base: RuleBase | None = None) -> Figure:
    """Return the figure: ω1 on the left, ω2 on the right.

    Args:
        weights: (ω1, ω2) of each rule, shape (R, 2), row by row of Table 4.
        title: How they were learned, in one line.
        base: The rules; those of Table 4 by default.
    """
    figure = new_figure(11.0, 4.6)
    figure.suptitle(title, fontsize=13, weight="bold", color=INK)
    base = paper_controller().base if base is None else base
    tables = weights.reshape(len(base.row.sets), len(base.column.sets), 2)
    names = ("ω1: how much of the rule's step", "ω2: how much of the rule's turn")
    for axes, name, table in zip(
        figure.subplots(1, 2), names, np.moveaxis(tables, 2, 0), strict=True
    ):
        _table(axes, name, table, base)
    return figure


def _table(axes: Axes, name: str, table: Floats, base: RuleBase) -> None:
    """Draw a table; columns from "left much freer" to "right much freer", as in the film."""
    columns = list(base.column.falling)
    mirrored = table[:, columns]
    low, high = float(table.min()), float(table.max())
    shades = (mirrored - low) / (high - low) if high > low else np.full(mirrored.shape, 0.5)
    axes.imshow(shades, cmap="cividis", vmin=0.0, vmax=1.0, aspect="auto")
    for (row, column), value in np.ndenumerate(mirrored):
        ink = "white" if shades[row, column] < 0.6 else INK
        axes.text(column, row, f"{value:g}", ha="center", va="center", color=ink, fontsize=13)
    sides = [
        one.meaning.replace(" ", "\n", 1) for one in map(base.column.sets.__getitem__, columns)
    ]
    near = [one.meaning for one in base.row.sets]
    axes.set_xticks(range(len(sides)), sides, fontsize=9)
    axes.set_yticks(range(len(near)), near, fontsize=10)
    axes.set_ylabel("free distance towards the aim")
    axes.set_title(name, fontsize=12, color=INK)
    axes.set_xticks(np.arange(-0.5, len(sides)), minor=True)
    axes.set_yticks(np.arange(-0.5, len(near)), minor=True)
    axes.grid(which="minor", color="white", lw=2)
    axes.tick_params(which="both", length=0)
    for spine in axes.spines.values():
        spine.set_visible(False)
