"""What learning gains: three tables, and a picture of every environment and all intervals."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from fuzzyq_bullet.figures.style import BLUE, INK, RED, SKY, new_figure, tidy
from fuzzyq_bullet.studies.learning.table import LEAST_GAIN, Against, Figures, Summary
from fuzzyq_bullet.studies.statistics import Estimate
from fuzzyq_bullet.studies.study import Table, cell

_FIGURES: tuple[tuple[str, Callable[[Figures], float | None], str], ...] = (
    ("success", lambda one: one.found, ".3f"),
    ("hits", lambda one: one.collisions, "d"),
    ("time s", lambda one: one.time, ".2f"),
    ("steps", lambda one: one.steps, ".0f"),
    ("path", lambda one: one.path, ".3f"),
    ("clear m", lambda one: one.clearance, ".3f"),
    ("least m", lambda one: one.least, ".3f"),
)
_AGAINST: tuple[tuple[str, Callable[[Against], Estimate | None], str], ...] = (
    ("time ÷", lambda one: one.time, ".3f"),
    ("usual time ÷", lambda one: one.usual_time, ".3f"),
    ("path ÷", lambda one: one.path, ".3f"),
    ("success − %", lambda one: _times(one.success, 100.0), "+.1f"),
)
_TICKS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.4, 1.7, 2, 3, 5, 10)


def tables_of(summary: Summary, about: str) -> tuple[Table, ...]:
    """Return the tables; they fit into 100 columns.

    Args:
        summary: What to show.
        about: How it was made, in words.
    """
    return _planners(summary, about), _against(summary), _counts(summary)


def _planners(summary: Summary, about: str) -> Table:
    rows = []
    for line in summary.lines:
        named = "by rule" if line.role == line.planner else _weights(line.planner)
        cells = [cell(figure(line.figures), form) for _, figure, form in _FIGURES]
        rows.append([line.role, named, *cells])
    return Table(
        f"{about}\n{summary.feasible} of {summary.environments} environments have a way for a disc "
        "of radius 0.22 m. success: share of these in which the goal was reached; hits: collisions "
        f"in all. The rest are means over the {summary.common} environments that all planners "
        "solved: time to the goal, steps of the simulation, driven over shortest path, least "
        "distance to anything in a run; least: the least of any run.",
        ("planner", "weights", *(name for name, _, _ in _FIGURES)),
        rows,
        left=(0, 1),
    )


def _against(summary: Summary) -> Table:
    met = "; ".join(f"{one}: {'met' if one.met else 'MISSED'}" for one in summary.targets)
    rows = [
        [one.role, *(cell(figure(one), form) for _, figure, form in _AGAINST)]
        for one in summary.against
    ]
    return Table(
        "÷: learned over the other, −: learned less the other, with 95 % intervals from the same "
        "environments: over those that both solved, except success (all feasible). time, path: "
        "ratio of means; usual time: median of the ratios. %: in 100 runs. The JSON has hits, "
        "steps and clearance too.\n"
        f"Targets: {met}.",
        ("learned to", *(name for name, _, _ in _AGAINST)),
        rows,
        left=(0,),
    )


def _counts(summary: Summary) -> Table:
    return Table(
        "The learned planner and the best triple by the number of obstacles.",
        ("obstacles", "feasible", "learned solved", "triple solved", "time ÷"),
        [
            [*map(str, (one.count, one.feasible, one.ours, one.theirs)), cell(one.time, ".3f")]
            for one in summary.counts
        ],
        left=(),
    )


def _times(estimate: Estimate | None, factor: float) -> Estimate | None:
    return None if estimate is None else estimate.times(factor)


def picture(summary: Summary, ratios: Mapping[int, Sequence[float]], title: str) -> Figure:
    """Return the figure: on the left every environment, on the right the intervals."""
    figure = new_figure(10.4, 4.8)
    figure.suptitle(title, fontsize=11, color=INK)
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
        axes.plot(beside, here, "o", ms=3.6, color=SKY, mec=BLUE, mew=0.5, label=label)
        if one.time is not None:
            label = "ratio of the mean times, 95 %" if place == 0 else None
            axes.errorbar(
                place + 0.32, one.time.value, _beside(one.time), fmt="D", ms=6, capsize=5, lw=2.0,
                color=INK, label=label,
            )  # fmt: skip
    axes.set_yscale("log")
    values = [value for here in ratios.values() for value in here] or [1.0]
    axes.set_ylim(min(*values, LEAST_GAIN) / 1.06, max(*values, 1.0) * 1.06)
    _bounds(axes.axhline)
    axes.yaxis.set_major_locator(FixedLocator(_TICKS))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.set_xticks(range(len(names)), names)
    axes.set_xlim(-0.5, len(names) - 0.5)
    axes.set_xlabel("obstacles")
    axes.set_ylabel("time to goal, learned ÷ best triple")
    tidy(axes, "y")


def _intervals(axes: Axes, summary: Summary) -> None:
    """Draw the ratio of mean times against each of the others."""
    for place, one in enumerate(summary.against):
        if one.time is not None:
            axes.errorbar(
                one.time.value,
                place,
                xerr=_beside(one.time),
                fmt="D",
                ms=6,
                capsize=5,
                lw=2.0,
                color=BLUE,
            )
            told = f"{one.time.value:.3f}  [{one.time.low:.3f}, {one.time.high:.3f}]"
            axes.annotate(
                told, (one.time.value, place), (0, 11), textcoords="offset points", ha="center",
                fontsize=8, color=INK,
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.0},
            )  # fmt: skip
    axes.set_yticks(
        range(len(summary.against)),
        [_named(one.role, one.planner) for one in summary.against],
    )
    axes.set_ylim(len(summary.against) - 0.5, -0.7)
    axes.margins(x=0.25)
    _bounds(axes.axvline)
    axes.set_xlabel("mean time to goal, learned ÷ the other, 95 %")
    tidy(axes, "x")


def _beside(estimate: Estimate) -> list[list[float]]:
    """Return how far the interval reaches below and above, as matplotlib takes it."""
    return [[estimate.value - estimate.low], [estimate.high - estimate.value]]


def _named(role: str, planner: str) -> str:
    """Return what another planner is there for, and its weights where that does not say them."""
    weights = _weights(planner)
    return role if weights in (role, "–") else f"{role}\n{weights}"


def _weights(planner: str) -> str:
    """Return the weights in what rows call a planner; it may have none."""
    fixed = planner.startswith("fixed-")
    return planner.removeprefix("fixed-").replace("-", "/") if fixed else "–"


def _bounds(line: Callable[..., object]) -> None:
    """Draw where there is no gain, and where the target is."""
    for value, colour, style, name in (
        (1.0, INK, "-", "no gain"),
        (LEAST_GAIN, RED, (0, (5, 3)), f"target {LEAST_GAIN:g}"),
    ):
        line(value, color=colour, lw=1.3, ls=style, zorder=0.5, label=name)
