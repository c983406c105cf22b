"""Path, time and clearance of each planner by the number of obstacles, as a picture.

In the colours, marks and dashes of Fig. 13's picture: dark on white, told apart without colour.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from fuzzyq_bullet.studies.runner.rows import Row
from fuzzyq_bullet.studies.success.measures import MEASURES, by_planner, measures_of
from fuzzyq_bullet.studies.success.picture import GRID, INK, beside, looks_of, ticks_of


def picture(rows: Sequence[Row], title: str) -> Figure:
    """Return the figure: median and middle half over the runs that reached the goal."""
    figure = Figure(figsize=(11.0, 11.5), dpi=100, layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(title, fontsize=13, weight="bold", color=INK)
    panels = figure.subplots(len(MEASURES), 1, sharex=True)
    table = by_planner(rows)
    counts = np.array(sorted({row.count or 0 for row in rows}))
    for axes, (what, figure_of) in zip(panels, MEASURES.items(), strict=True):
        for name, look, offset in zip(table, looks_of(table), beside(counts, table), strict=True):
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
        axes.grid(axis="y", color=GRID, lw=0.8)
        axes.set_axisbelow(True)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    panels[-1].set_xlabel("obstacles", fontsize=11)
    panels[-1].xaxis.set_major_locator(ticks_of(counts))
    figure.legend(
        *panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=6, fontsize=10,
        frameon=False, handlelength=3.2,
    )  # fmt: skip
    return figure
