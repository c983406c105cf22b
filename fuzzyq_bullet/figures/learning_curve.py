"""The learning curve of a training: what each episode earned, how often the goal was reached."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, PercentFormatter
from numpy.typing import NDArray

from fuzzyq_bullet.figures.style import (
    BLUE,
    GREEN,
    GREY,
    INK,
    ORANGE,
    PURPLE,
    RED,
    new_figure,
    tidy,
)
from fuzzyq_bullet.learning.checkpoint import WINDOW, Curve, last_mean, reached


class Mark(NamedTuple):
    """How an episode is drawn: matplotlib's name of the mark, colour, words of the legend."""

    shape: str
    colour: str
    words: str


MARKS = {
    "goal": Mark("o", BLUE, "goal"),
    "collision": Mark("X", RED, "collision"),
    "stuck": Mark("s", PURPLE, "stuck"),
    "timeout": Mark("^", ORANGE, "out of time"),
    (OTHERWISE := "going on"): Mark("D", GREY, "cut short"),
}
"""By outcome; the last is an episode that the training itself ended, by its number of steps."""

_OUTLIERS = 0.02
"""Share of the episodes that may lie so low that they are only hinted at."""


def picture(curve: Curve, title: str, *, same: bool = False, bound: float | None = None) -> Figure:
    """Return the figure: above what every episode earned, below the share that reached the goal.

    Args:
        curve: A row for each episode (``learning.train``).
        title: What was trained, in one line.
        same: Whether all episodes are the same task. Then the best so far is shown, and not a
            mean.
        bound: What an episode could earn at most (s), if that is known.
    """
    figure = new_figure(9.6, 6.6)
    figure.get_layout_engine().set(w_pad=0.12, h_pad=0.1)  # type: ignore[union-attr,call-arg]
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    episodes = np.arange(1, len(curve) + 1)
    _returns(above, episodes, curve, same=same)
    if bound is not None:
        above.axhline(bound, color=GREEN, lw=2.0, ls="--", label="shortest path at full speed")
    _legend(above, len(curve))
    _success(below, episodes, curve)
    below.set_xlabel("episode", fontsize=12)
    margin = max(0.5, 0.01 * len(curve))
    below.set_xlim(1 - margin, len(curve) + margin)
    below.xaxis.set_major_locator(MaxNLocator("auto", integer=True, min_n_ticks=1))
    figure.suptitle(title, fontsize=14, weight="bold", color=INK)
    return figure


def _returns(axes: Axes, episodes: NDArray[np.int64], curve: Curve, *, same: bool) -> None:
    size = _size(len(curve))
    totals, floor = curve["total"], _floor(curve["total"])
    outcomes = np.char.decode(curve["outcome"], "ascii")
    kinds = np.where(np.isin(outcomes, list(MARKS)), outcomes, OTHERWISE)
    for kind, mark in MARKS.items():
        ended = kinds == kind
        if ended.any():
            axes.scatter(
                episodes[ended], np.maximum(totals[ended], floor), s=size, marker=mark.shape,
                facecolor=mark.colour, edgecolor="white", linewidth=0.4, alpha=0.8,
                label=f"{mark.words} ({ended.sum()})", zorder=5, clip_on=False,
            )  # fmt: skip
    line, words = last_mean(totals), _mean_of(curve)
    if same:
        best = np.maximum.accumulate(np.where(reached(curve), totals, -np.inf))
        line = np.where(np.isfinite(best), best, np.nan)
        words = "fastest so far"
    axes.plot(
        episodes, line, color=INK, lw=2.4, marker=_alone(curve), label=words, zorder=6,
        drawstyle="steps-post" if same else "default",
    )  # fmt: skip
    if floor > totals.min():
        axes.set_ylim(bottom=floor)
        axes.annotate(
            f"marks on the lower edge: lower still, down to {_plain(totals.min())} s", (0.0, 0.0),
            (6, 9), xycoords="axes fraction", textcoords="offset points", fontsize=10, zorder=7,
            color=INK, bbox={"fc": "white", "ec": "none", "alpha": 0.8, "pad": 1.5},
        )  # fmt: skip
    axes.set_ylabel("return of an episode (s)", fontsize=12)
    tidy(axes, "both")
    axes.tick_params(labelsize=11)


def _legend(axes: Axes, episodes: int) -> None:
    axes.legend(
        loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=6, frameon=False, fontsize=11,
        columnspacing=1.4, handletextpad=0.4, handlelength=1.4,
        markerscale=(26 / _size(episodes)) ** 0.5,
    )  # fmt: skip


def _size(episodes: int) -> float:
    """Return how large the mark of an episode is."""
    return 26.0 if episodes <= 400 else 10.0


def _floor(totals: NDArray[np.float64]) -> float:
    """Return the least return that gets a height of its own.

    One episode that ran out of time must not press all others into a line. But where the few
    lowest do not lie far below the rest, all are shown where they are.
    """
    lowest, highest = float(totals.min()), float(totals.max())
    low = min(float(np.quantile(totals, _OUTLIERS)), float(last_mean(totals).min()))
    low -= 0.1 * (highest - low)
    return low if highest - lowest > 2.0 * (highest - low) else lowest


def _success(axes: Axes, episodes: NDArray[np.int64], curve: Curve) -> None:
    share = last_mean(reached(curve))
    axes.fill_between(episodes, share, color=GREEN, alpha=0.18, lw=0)
    axes.plot(episodes, share, color="#00795A", lw=2.4, marker=_alone(curve), clip_on=False)
    axes.set_ylim(0.0, 1.04)
    axes.yaxis.set_major_formatter(PercentFormatter(1.0, symbol=" %"))
    axes.set_ylabel(f"goal reached,\n{_mean_of(curve)}", fontsize=12)
    tidy(axes, "both")
    axes.tick_params(labelsize=11)
    axes.annotate(
        f"{100 * share[-1]:.0f} %", (1.0, float(share[-1])), (4, 0),
        xycoords=("axes fraction", "data"), textcoords="offset points", ha="left", va="center",
        fontsize=12, weight="bold", color="#00523D",
    )  # fmt: skip


def _plain(number: float) -> str:
    return f"{number:.0f}".replace("-", "\N{MINUS SIGN}")


def _alone(curve: Curve) -> str:
    """Return the mark of a line's points: a line of one point would not be seen without."""
    return "o" if len(curve) == 1 else ""


def _mean_of(curve: Curve) -> str:
    return f"mean of the last {WINDOW}" if len(curve) > WINDOW else "mean so far"
