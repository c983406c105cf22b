"""The learning curve of a training: what each episode earned, and how often the goal was reached.

For print: dark on white, in Okabe and Ito's palette, which the colour-blind tell apart. How an
episode ended is told by a mark's shape too, so that the picture can be read in grey.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, PercentFormatter

from fuzzyq_bullet.files import written_beside
from fuzzyq_bullet.training.curves import WINDOW, last_mean, reached

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from fuzzyq_bullet.learning.checkpoint import Curve


class Mark(NamedTuple):
    """How an episode is drawn that ended in one of the ways.

    Attributes:
        shape: matplotlib's name of the mark.
        colour: Its colour.
        words: What the legend says.
    """

    shape: str
    colour: str
    words: str


MARKS = {
    "goal": Mark("o", "#0072B2", "goal"),
    "collision": Mark("X", "#D55E00", "collision"),
    "stuck": Mark("s", "#A0478A", "stuck"),
    "timeout": Mark("^", "#E69F00", "out of time"),
    "going on": Mark("D", "#7C828C", "cut short"),
}
"""By outcome; the last is an episode that the training itself ended, by its number of steps."""

_INK = "#222222"
_GRID = "#D9DCE1"


def draw(curve: Curve, title: str, path: Path) -> None:
    """Draw the learning curve into a PNG, whole or not at all.

    Args:
        curve: A row for each episode (``learning.train``).
        title: What was trained, in one line.
        path: The file.

    Raises:
        UserError: If the file cannot be written.
    """
    figure = picture(curve, title)
    with written_beside(path) as part:
        figure.savefig(part, format="png")


def picture(curve: Curve, title: str) -> Figure:
    """Return the figure: above what every episode earned, below the share that reached the goal."""
    figure = Figure(figsize=(9.6, 6.6), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    episodes = np.arange(1, len(curve) + 1)
    _returns(above, episodes, curve)
    _success(below, episodes, curve)
    below.set_xlabel("episode", fontsize=12)
    margin = max(0.5, 0.01 * len(curve))
    below.set_xlim(1 - margin, len(curve) + margin)
    below.xaxis.set_major_locator(MaxNLocator("auto", integer=True))
    figure.suptitle(title, fontsize=14, weight="bold", color=_INK)
    return figure


def _returns(axes: Axes, episodes: NDArray[np.int64], curve: Curve) -> None:
    size = 26 if len(curve) <= 400 else 10
    outcomes = np.char.decode(curve["outcome"], "ascii")
    for outcome, mark in MARKS.items():
        ended = outcomes == outcome
        if ended.any():
            axes.scatter(
                episodes[ended], curve["total"][ended], s=size, marker=mark.shape,
                facecolor=mark.colour, edgecolor="white", linewidth=0.4, alpha=0.75,
                label=f"{mark.words} ({ended.sum()})", zorder=3,
            )  # fmt: skip
    axes.plot(
        episodes, last_mean(curve["total"]), color=_INK, lw=2.4, zorder=4, label=_mean_of(curve)
    )
    axes.set_ylabel("return of an episode (s)", fontsize=12)
    _house(axes)
    axes.legend(
        loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=6, frameon=False, fontsize=11,
        columnspacing=1.4, handletextpad=0.4, handlelength=1.4,
    )  # fmt: skip


def _success(axes: Axes, episodes: NDArray[np.int64], curve: Curve) -> None:
    share = last_mean(reached(curve))
    axes.fill_between(episodes, share, color="#009E73", alpha=0.18, lw=0, zorder=2)
    axes.plot(episodes, share, color="#00795A", lw=2.4, zorder=3)
    axes.set_ylim(0.0, 1.04)
    axes.yaxis.set_major_formatter(PercentFormatter(1.0))
    axes.set_ylabel(f"goal reached,\n{_mean_of(curve)}", fontsize=12)
    _house(axes)
    axes.annotate(
        f"{100 * share[-1]:.0f} %", (float(episodes[-1]), float(share[-1])), (-4, -8),
        textcoords="offset points", ha="right", va="top", fontsize=12, weight="bold",
        color="#00523D",
    )  # fmt: skip


def _mean_of(curve: Curve) -> str:
    return f"mean of the last {WINDOW}" if len(curve) > WINDOW else "mean so far"


def _house(axes: Axes) -> None:
    axes.grid(color=_GRID, lw=0.8, zorder=0)
    axes.set_axisbelow(True)
    axes.tick_params(labelsize=11)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
