"""The gain as a picture: time learned over best pair in each environment, and all intervals.

For print: dark on white, in Okabe and Ito's palette, which the colour-blind tell apart; shapes and
places say the same as colours do.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from fuzzyq_bullet.studies.learning.table import LEAST_GAIN, Summary

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.axes import Axes

_INK = "#222222"
_GRID = "#D9DCE1"
_POINT = "#56B4E9"
_MEAN = "#0072B2"
_TARGET = "#D55E00"
_TICKS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.4, 1.7, 2, 3, 5, 10)


def picture(summary: Summary, ratios: Mapping[int, Sequence[float]], title: str) -> Figure:
    """Return the figure: on the left every environment, on the right the intervals."""
    figure = Figure(figsize=(10.4, 4.8), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(title, fontsize=11, color=_INK)
    left, right = figure.subplots(1, 2, width_ratios=(3, 2))
    _environments(left, summary, ratios)
    _intervals(right, summary)
    figure.legend(
        *left.get_legend_handles_labels(), loc="outside lower center", ncols=4, fontsize=9
    )
    return figure


def _environments(axes: Axes, summary: Summary, ratios: Mapping[int, Sequence[float]]) -> None:
    """Draw a point for each environment, side by side by rank so that none hides another."""
    names = [str(one.count) for one in summary.counts]
    for place, one in enumerate(summary.counts):
        here = np.sort(np.asarray(ratios.get(one.count, ())))
        beside = (
            place + np.linspace(-0.36, 0.2, here.size) if here.size > 1 else [place] * here.size
        )
        label = "an environment, sorted" if place == 0 else None
        axes.plot(beside, here, "o", ms=3.6, color=_POINT, mec=_MEAN, mew=0.5, label=label)
        if one.time is not None:
            off = [[one.time.value - one.time.low], [one.time.high - one.time.value]]
            label = "ratio of the mean times, 95 %" if place == 0 else None
            axes.errorbar(
                place + 0.32, one.time.value, off, fmt="D", ms=6, capsize=5, lw=2.0, color=_INK,
                label=label,
            )  # fmt: skip
    axes.set_yscale("log")
    values = [value for here in ratios.values() for value in here] or [1.0]
    axes.set_ylim(min(*values, LEAST_GAIN) / 1.06, max(*values, 1.0) * 1.06)
    _bounds(axes, axes.axhline)
    axes.yaxis.set_major_locator(FixedLocator(_TICKS))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.set_xticks(range(len(names)), names)
    axes.set_xlim(-0.5, len(names) - 0.5)
    axes.set_xlabel("obstacles")
    axes.set_ylabel("time to goal, learned ÷ best pair")
    _plain(axes, "y")


def _intervals(axes: Axes, summary: Summary) -> None:
    """Draw the ratio of mean times against each of the others."""
    for place, one in enumerate(summary.against):
        if one.time is not None:
            off = [[one.time.value - one.time.low], [one.time.high - one.time.value]]
            axes.errorbar(
                one.time.value, place, xerr=off, fmt="D", ms=6, capsize=5, lw=2.0, color=_MEAN
            )
            told = f"{one.time.value:.3f}  [{one.time.low:.3f}, {one.time.high:.3f}]"
            axes.annotate(
                told, (one.time.value, place), (0, 11), textcoords="offset points", ha="center",
                fontsize=8, color=_INK,
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.0},
            )  # fmt: skip
    axes.set_yticks(
        range(len(summary.against)),
        [_named(one.role, one.planner) for one in summary.against],
    )
    axes.set_ylim(len(summary.against) - 0.5, -0.7)
    axes.margins(x=0.25)
    _bounds(axes, axes.axvline)
    axes.set_xlabel("mean time to goal, learned ÷ the other, 95 %")
    _plain(axes, "x")


def _named(role: str, planner: str) -> str:
    """Return what another planner is there for, and its weights where that does not say them."""
    weights = planner.removeprefix("fixed-").replace("-", "/")
    return role if weights == role else f"{role}\n{weights}"


def _bounds(axes: Axes, line: object) -> None:
    for value, colour, style, name in (
        (1.0, _INK, "-", "no gain"),
        (LEAST_GAIN, _TARGET, (0, (5, 3)), f"target {LEAST_GAIN:g}"),
    ):
        assert callable(line)
        line(value, color=colour, lw=1.3, ls=style, zorder=0.5, label=name)


def _plain(axes: Axes, grid: str) -> None:
    axes.grid(axis=grid, color=_GRID, lw=0.8)  # type: ignore[arg-type]
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
