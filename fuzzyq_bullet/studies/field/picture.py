"""Planners in each kind of fields as a picture: above success, below the time over the bound."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, MaxNLocator, PercentFormatter

from fuzzyq_bullet.figures.style import BLUE, GREY, INK, RED, new_figure, plain, tidy
from fuzzyq_bullet.studies.field.plan import BOUND
from fuzzyq_bullet.studies.field.table import FEWEST_PAIRS, Summary
from fuzzyq_bullet.studies.options import PAPER

_LOOKS = ((PAPER, (BLUE, "o")), ((BOUND,), (INK, "D")))
_OTHERS = (RED, "s")
_LEAST = 0.6
_MOST = 4.0
"""Least and greatest time over the bound that are drawn to scale; the rest stands at the edge."""


def field_picture(lines: Sequence[Summary], about: str) -> Figure:
    """Return the figure: a column for each kind, a line for each planner, named at the left."""
    kinds = list(dict.fromkeys(line.kind for line in lines))
    planners = list(dict.fromkeys(line.planner for line in lines))
    scored = len(kinds) == 1 and any(line.score is not None for line in lines)
    height = 2.2 + 0.52 * len(planners) * (1.5 if scored else 1.0)
    figure = new_figure(2.6 + 2.3 * max(len(kinds), 2), height)
    figure.suptitle(f"Planners in the same fields: {about}", fontsize=12, weight="bold", color=INK)
    figure.supxlabel(
        "circle: the paper's; square: others; diamond: the bound.\n"
        f"Lines: 95 %, of a time where both solved {FEWEST_PAIRS} fields or more.",
        fontsize=9, color=INK,
    )  # fmt: skip
    axes = figure.subplots(3 if scored else 2, len(kinds), sharey=True, squeeze=False)
    for column, kind in enumerate(kinds):
        own = [line for line in lines if line.kind == kind]
        count = f"{own[0].fields} field{'' if own[0].fields == 1 else 's'}"
        axes[0][column].set_title(f"{kind}\n{count}", fontsize=10, color=INK)
        for line in own:
            place = planners.index(line.planner)
            _success(axes[0][column], line, place)
            _time(axes[1][column], line, place)
            if scored:
                _score(axes[2][column], line, place)
    for row in axes:
        for one in row:
            tidy(one, "both")
        row[0].set_yticks(range(len(planners)), [plain(name) for name in planners])
        row[0].set_ylim(len(planners) - 0.5, -0.7)
        for tick, name in zip(row[0].get_yticklabels(), planners, strict=True):
            tick.set_color(_look(name)[0])
    for one in axes[0]:
        one.set_xlim(-0.06, 1.6)
        one.xaxis.set_major_locator(FixedLocator([0.0, 0.5, 1.0]))
        one.xaxis.set_major_formatter(PercentFormatter(1.0, symbol=" %"))
        one.set_xlabel("reached")
    for one in axes[1]:
        one.set_xlim(_LEAST - 0.1, _MOST + 0.9)
        one.xaxis.set_major_locator(MaxNLocator(integer=True))
        one.axvline(1.0, color=INK, lw=1)
        one.set_xlabel("time ÷ bound")
    for one in axes[2] if scored else ():
        one.set_xlim(-0.02, 0.6)
        one.set_xlabel("score, at most 0.5")
    return figure


def _look(planner: str) -> tuple[str, str]:
    """Return colour and mark of a planner."""
    return next((look for names, look in _LOOKS if planner in names), _OTHERS)


def _success(axes: Axes, line: Summary, place: int) -> None:
    """Draw the share with its interval; contacts stand at the right."""
    colour, mark = _look(line.planner)
    if line.success is None:
        axes.annotate("no field has a way", (0.0, place), va="center", fontsize=7, color=GREY)
        return
    axes.plot([line.success.low, line.success.high], [place, place], color=colour, lw=1.5)
    axes.plot(line.success.value, place, mark, color=colour, ms=6)
    if line.contacts:
        words = f"{line.contacts} contact{'s' if line.contacts > 1 else ''}"
        axes.annotate(words, (1.59, place), va="center", ha="right", fontsize=7, color=INK)


def _time(axes: Axes, line: Summary, place: int) -> None:
    colour, mark = _look(line.planner)
    if line.planner == BOUND:
        axes.plot(1.0, place, mark, color=colour, ms=6)
        return
    if line.over_bound is None:
        axes.annotate("–", (1.0, place), (6, 0), textcoords="offset points", va="center", color=INK)
        return
    value = line.over_bound.value
    low = high = max(value, _LEAST)
    if line.over_bound.pairs >= FEWEST_PAIRS:
        low, high = max(line.over_bound.low, _LEAST), line.over_bound.high
    axes.plot([min(low, _MOST), min(high, _MOST)], [place, place], color=colour, lw=1.5)
    axes.plot(
        min(max(value, _LEAST), _MOST), place, ">" if value > _MOST else mark, color=colour, ms=6
    )
    axes.annotate(
        f"{value:.2f}", (min(high, _MOST), place), (7, 0), textcoords="offset points", va="center",
        fontsize=8, color=INK,
    )  # fmt: skip


def _score(axes: Axes, line: Summary, place: int) -> None:
    colour, mark = _look(line.planner)
    if line.score is None:
        return
    axes.plot([0.0, line.score], [place, place], color=colour, lw=1.5)
    axes.plot(line.score, place, mark, color=colour, ms=6)
    axes.annotate(
        f"{line.score:.3f}", (line.score, place), (7, 0), textcoords="offset points", va="center",
        fontsize=8, color=INK,
    )  # fmt: skip
