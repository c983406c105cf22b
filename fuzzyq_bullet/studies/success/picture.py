"""Fig. 13 as a picture, success by the number of obstacles; and path, time and clearance beside it.

Planners stand side by side where they meet.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import NamedTuple, TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, MaxNLocator, PercentFormatter

from fuzzyq_bullet.figures.style import (
    BLUE,
    BROWN,
    GREEN,
    GREY,
    INK,
    ORANGE,
    PURPLE,
    RED,
    SKY,
    new_figure,
    tidy,
)
from fuzzyq_bullet.studies.episodes import Row
from fuzzyq_bullet.studies.statistics import Share
from fuzzyq_bullet.studies.success.table import MEASURES, Line, Summary, by_planner, measures_of

Counts: TypeAlias = "np.ndarray[tuple[int, ...], np.dtype[np.int64]]"
"""Numbers of obstacles, rising."""


class Look(NamedTuple):
    """How a planner is drawn: colour, matplotlib's name of the mark, dashes of the line."""

    colour: str
    mark: str
    dashes: str | tuple[int, tuple[float, ...]]


LOOKS = {
    "fuzzy": Look(RED, "v", (0, (5, 2))),
    "improved-fuzzy": Look(GREEN, "s", (0, (7, 2, 1.5, 2))),
    "q-learning": Look(ORANGE, "^", (0, (3, 2))),
    "q-lambda": Look(PURPLE, "D", (0, (1.5, 1.5))),
    "fuzzy-q-lambda": Look(BLUE, "o", "-"),
    "q-learning-guarded": Look(SKY, "<", (0, (3, 2))),
    "q-lambda-guarded": Look(INK, "p", (0, (1.5, 1.5))),
    "q-learning-position": Look(GREY, ">", (0, (3, 2))),
    "q-lambda-position": Look(BROWN, "h", (0, (1.5, 1.5))),
}
_OTHERS = (Look(INK, "P", "-"), Look(SKY, "X", "--"), Look(GREY, "*", ":"))

MOST_TICKS = 8
_SPREAD = 0.55
"""Width over which planners stand side by side, as a share of the least gap between counts, or of a
fifth of their range if that is less."""


def success_picture(summary: Summary, title: str) -> Figure:
    """Return the figure: above over all environments, below over those that have a way."""
    figure = new_figure(11.0, 8.6)
    figure.suptitle(title, fontsize=13, weight="bold", color=INK)
    above, below = figure.subplots(2, 1, sharex=True, sharey=True)
    counts = np.array([line.count or 0 for line in summary.lines])
    ways = [line.feasible / line.environments for line in summary.lines]
    above.plot(
        counts, ways, color=GREY, lw=1.4, ls=":", marker="_", ms=9, zorder=2,
        label="has a way for 0.22 m",
    )  # fmt: skip
    for axes, feasible in ((above, False), (below, True)):
        _planners(axes, summary, counts, feasible)
        axes.set_ylim(-0.02, 1.04)
        axes.yaxis.set_major_formatter(PercentFormatter(1.0, symbol=" %"))
        tidy(axes, "y")
    above.set_title("of all environments", loc="left", fontsize=11, color=INK)
    below.set_title("of the environments that have a way", loc="left", fontsize=11, color=INK)
    figure.supylabel("goal reached, with Wilson's 95 % intervals", fontsize=11, color=INK)
    _finish(figure, above, below, counts)
    return figure


def measures_picture(rows: Sequence[Row], title: str) -> Figure:
    """Return the figure: median and middle half over the runs that reached the goal."""
    figure = new_figure(11.0, 11.5, dpi=100)
    figure.suptitle(title, fontsize=13, weight="bold", color=INK)
    panels = figure.subplots(len(MEASURES), 1, sharex=True)
    table = by_planner(rows)
    counts = np.array(sorted({row.count or 0 for row in rows}))
    for axes, (what, figure_of) in zip(panels, MEASURES.items(), strict=True):
        for name, look, offset in zip(table, _looks_of(table), _beside(counts, table), strict=True):
            found = [
                (count + offset, one)
                for count in counts
                if (one := figure_of(measures_of(r for r in table[name] if r.count == count)))
            ]
            x = [place for place, _ in found]
            y = [one.middle for _, one in found]
            off = [
                [one.middle - one.low for _, one in found],
                [one.high - one.middle for _, one in found],
            ]
            axes.errorbar(
                x, y, off, fmt=look.mark, ls=look.dashes, lw=1.6, ms=5.5, color=look.colour,
                mec="white", mew=0.5, elinewidth=1.0, capsize=1.8, label=name,
            )  # fmt: skip
        axes.set_title(what, loc="left", fontsize=11, color=INK)
        tidy(axes, "y")
    _finish(figure, panels[0], panels[-1], counts)
    return figure


def _looks_of(planners: Collection[str]) -> list[Look]:
    """Return how each planner is drawn; those that the paper does not have take turns."""
    others = iter(_OTHERS * len(planners))
    return [LOOKS.get(name) or next(others) for name in planners]


def _finish(figure: Figure, first: Axes, last: Axes, counts: Counts) -> None:
    """Name the axis of obstacles, mark it at the counts, if these are few, and add the legend."""
    last.set_xlabel("obstacles", fontsize=11)
    few = counts.size <= MOST_TICKS
    ticks = FixedLocator(counts.tolist()) if few else MaxNLocator("auto", integer=True)
    last.xaxis.set_major_locator(ticks)
    figure.legend(
        *first.get_legend_handles_labels(), loc="outside lower center", ncols=4, fontsize=10,
        frameon=False, handlelength=3.2,
    )  # fmt: skip


def _beside(counts: Counts, planners: Collection[str]) -> list[float]:
    """Return how far beside a count each planner stands, so that none hides another."""
    gap = float(min(np.diff(counts).min(), np.ptp(counts) / 5)) if counts.size > 1 else 1.0
    width = 0.5 * _SPREAD * gap
    places: list[float] = np.linspace(-width, width, len(planners)).tolist()
    return places if len(planners) > 1 else [0.0]


def _planners(axes: Axes, summary: Summary, counts: Counts, feasible: bool) -> None:
    """Draw a line for each planner, each a little beside the others."""
    looks, offsets = _looks_of(summary.planners), _beside(counts, summary.planners)
    for name, look, offset in zip(summary.planners, looks, offsets, strict=True):
        found = [
            (count + offset, one)
            for count, line in zip(counts, summary.lines, strict=True)
            if (one := _share(line, name, feasible)) is not None
        ]
        if not found:
            continue
        x = [place for place, _ in found]
        y = [one.value for _, one in found]
        off = [
            [one.value - one.low for _, one in found],
            [one.high - one.value for _, one in found],
        ]
        axes.plot(x, y, color=look.colour, lw=1.9, ls=look.dashes, zorder=4)
        axes.errorbar(
            x, y, off, fmt=look.mark, ms=5.5, color=look.colour, mec="white", mew=0.5,
            ecolor=look.colour, elinewidth=1.0, capsize=1.8, zorder=5,
        )  # fmt: skip
        axes.plot(
            [], [], color=look.colour, lw=1.9, ls=look.dashes, marker=look.mark, ms=6, mec="white",
            mew=0.5, label=name,
        )  # fmt: skip


def _share(line: Line, planner: str, feasible: bool) -> Share | None:
    cell = line.cells[planner]
    return cell.feasible if feasible else cell.all
