"""The learning curves of several trainings in one picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, PercentFormatter

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.figures import MARK
from fuzzyq_bullet.figures.style import (
    BLUE,
    GREEN,
    GREY,
    INK,
    ORANGE,
    PURPLE,
    RED,
    SKY,
    new_figure,
    plain,
    save_png,
    tidy,
)
from fuzzyq_bullet.files import writable_folder
from fuzzyq_bullet.learning.checkpoint import WINDOW, Checkpoint, Curve, last_mean, reached

LINES = tuple(
    (colour, dashes)
    for dashes in ("-", "--")
    for colour in (BLUE, RED, GREEN, PURPLE, ORANGE, SKY, GREY)
)
"""Colour and dashes of each training; more than these cannot be told apart."""


def draw(out: Path, policies: Sequence[Path]) -> list[Path]:
    """Draw the curves of the trainings that wrote these policies into ``out/curves.png``.

    Raises:
        UserError: If there is none or too many, a training's checkpoint is missing or damaged, or
            the file cannot be written.
    """
    if not 1 <= len(policies) <= len(LINES):
        raise UserError(
            f"POLICY: give 1 to {len(LINES)} policies that fuzzyq train wrote, got {len(policies)}"
        )
    curves = [_curve_of(policy) for policy in policies]
    path = writable_folder(out) / "curves.png"
    save_png(picture(_named(policies, curves)), path, metadata={"Software": MARK})
    return [path]


def _curve_of(policy: Path) -> Curve:
    if not policy.stem:
        raise UserError(f"POLICY: {str(policy)!r} is no file")
    checkpoint = policy.with_name(f"{policy.stem}.checkpoint.npz")
    saved = Checkpoint.find(checkpoint)
    if saved is None or not len(saved.curve):
        raise UserError(
            f"{policy}: no learning curve beside it: {checkpoint} is missing or has no episode; "
            "fuzzyq train writes it"
        )
    return saved.curve


def _named(policies: Sequence[Path], curves: Sequence[Curve]) -> list[tuple[str, Curve]]:
    """Name each curve by its file, and by its folder too where files have the same name."""
    stems = [policy.stem for policy in policies]
    names = [
        stem if stems.count(stem) == 1 else str(policy.with_suffix(""))
        for stem, policy in zip(stems, policies, strict=True)
    ]
    return list(zip(names, curves, strict=True))


def picture(curves: Sequence[tuple[str, Curve]]) -> Figure:
    """Return the figure: above what the episodes earned, below the share that reached the goal.

    Args:
        curves: What each is called in the legend, and the curve.
    """
    figure = new_figure(9.6, 6.6)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    for (name, curve), (colour, dashes) in zip(curves, LINES, strict=False):
        episodes = np.arange(1, len(curve) + 1)
        for axes, values in ((above, curve["total"]), (below, reached(curve))):
            axes.plot(episodes, last_mean(values), dashes, color=colour, lw=2.2, label=plain(name))
    above.set_ylabel("return of an episode", fontsize=12)
    below.set_ylabel("goal reached", fontsize=12)
    below.set_ylim(0.0, 1.04)
    below.yaxis.set_major_formatter(PercentFormatter(1.0, symbol=" %"))
    below.set_xlabel(f"episode; means of the last {WINDOW}", fontsize=12)
    below.xaxis.set_major_locator(MaxNLocator("auto", integer=True, min_n_ticks=1))
    for axes in (above, below):
        tidy(axes, "both")
    figure.suptitle("Learning curves", fontsize=14, weight="bold", color=INK)
    figure.legend(*above.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure
