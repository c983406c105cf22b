"""What disturbances do to planners, as a picture: a column for each disturbance."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, PercentFormatter

from fuzzyq_bullet.figures.style import BLUE, GREEN, INK, ORANGE, PURPLE, new_figure, tidy
from fuzzyq_bullet.studies.robust.table import Line

_LOOKS = ((BLUE, "o", "-"), (ORANGE, "s", "--"), (GREEN, "^", ":"), (PURPLE, "D", "-."))


def robust_picture(lines: Sequence[Line], about: str) -> Figure:
    """Return the figure: above success, below time, by the strength of each disturbance."""
    names = list(dict.fromkeys(line.disturbance for line in lines if line.level))
    planners = list(dict.fromkeys(line.planner for line in lines))
    figure = new_figure(2.2 + 2.1 * len(names), 5.6)
    figure.suptitle(f"Disturbed planners: {about}", fontsize=12, weight="bold", color=INK)
    axes = figure.subplots(2, len(names), sharex=True, sharey="row", squeeze=False)
    for column, name in enumerate(names):
        for number, planner in enumerate(planners):
            colour, mark, dashes = _LOOKS[number % len(_LOOKS)]
            own = [
                line
                for line in lines
                if line.planner == planner and (line.disturbance == name or not line.level)
            ]
            look = {"color": colour, "marker": mark, "ls": dashes, "label": planner}
            levels = [line.level for line in own]
            reached = [line.reached / line.feasible if line.feasible else 0.0 for line in own]
            axes[0][column].plot(levels, reached, **look)
            timed = [line for line in own if line.time_ratio is not None]
            axes[1][column].plot([t.level for t in timed], [t.time_ratio for t in timed], **look)
            for line in own:
                if line.contacts:
                    place = (line.level, line.reached / max(line.feasible, 1))
                    axes[0][column].annotate(
                        f"{line.contacts} contacts", place, (0, -14), textcoords="offset points",
                        ha="center", fontsize=8, color=colour,
                    )  # fmt: skip
        axes[0][column].set_title(name, fontsize=10, color=INK)
        axes[1][column].set_xlabel("strength")
        axes[1][column].xaxis.set_major_locator(MaxNLocator(integer=True))
        for one in (axes[0][column], axes[1][column]):
            tidy(one, "y")
    axes[0][0].set_ylim(-0.03, 1.05)
    axes[0][0].yaxis.set_major_formatter(PercentFormatter(1.0, symbol=" %"))
    axes[0][0].set_ylabel("reached")
    axes[1][0].set_ylabel("time ÷ undisturbed")
    low, high = axes[1][0].get_ylim()
    axes[1][0].set_ylim(min(low, 0.8), max(high, 1.2))  # or chance would look like a slope
    if len(planners) > 1:
        axes[0][0].legend(fontsize=8)
    return figure
