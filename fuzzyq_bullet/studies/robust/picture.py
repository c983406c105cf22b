"""What disturbances do to planners, as a picture: a column for each disturbance."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, PercentFormatter

from fuzzyq_bullet.figures.style import BLUE, GREEN, INK, ORANGE, PURPLE, new_figure, tidy
from fuzzyq_bullet.studies.robust.table import ALL, Line

_LOOKS = ((BLUE, "o", "-"), (ORANGE, "s", "--"), (GREEN, "^", ":"), (PURPLE, "D", "-."))
_ROWS = ("reached", "contacts", "time ÷ undisturbed")


def robust_picture(lines: Sequence[Line], about: str) -> Figure:
    """Return the figure: success, contacts and time, by the strength of each disturbance."""
    names = list(dict.fromkeys(line.disturbance for line in lines if line.level))
    planners = list(dict.fromkeys(line.planner for line in lines))
    figure = new_figure(max(8.0, 2.2 + 2.1 * len(names)), 7.2)
    figure.suptitle(f"Disturbed planners: {about}", fontsize=12, weight="bold", color=INK)
    axes = figure.subplots(len(_ROWS), len(names), sharex="col", sharey="row", squeeze=False)
    for column, name in zip(axes.T, names, strict=True):
        shown = [line for line in lines if line.disturbance == name or not line.level]
        for number, planner in enumerate(planners):
            _plot(column, [line for line in shown if line.planner == planner], _LOOKS[number % 4])
        column[0].set_title(name, fontsize=10, color=INK)
        ticks = {line.level: _tick(line) for line in shown}
        column[-1].set_xticks(list(ticks), list(ticks.values()), fontsize=8)
        unit = {line.strength.partition(" ")[2] for line in shown if line.level}
        told = unit.pop() if len(unit) == 1 else ""
        column[-1].set_xlabel("level" if name == ALL else told or "share")
        for one in column:
            tidy(one, "y")
    for row, label in zip(axes, _ROWS, strict=True):
        row[0].set_ylabel(label)
    reached, contacts, time = axes[:, 0]
    reached.set_ylim(-0.03, 1.05)
    reached.yaxis.set_major_formatter(PercentFormatter(1.0, symbol=" %"))
    contacts.set_ylim(-0.2, max(contacts.get_ylim()[1], 4.2))
    contacts.yaxis.set_major_locator(MaxNLocator(integer=True))
    contacts.set_title("hollow: all; filled: at fault", fontsize=8, loc="left", color=INK)
    low, high = time.get_ylim()
    time.set_ylim(min(low, 0.8), max(high, 1.2))  # or chance would look like a slope
    if len(planners) > 1:
        reached.legend(fontsize=8)
    return figure


def _plot(column: Sequence[Axes], lines: Sequence[Line], look: tuple[str, str, str]) -> None:
    """Draw one planner with one disturbance."""
    colour, mark, dashes = look
    filled: dict[str, Any] = {"color": colour, "marker": mark, "ls": dashes}
    hollow = {**filled, "mfc": "none", "ms": 9, "alpha": 0.6}
    reached, contacts, time = column
    levels = [line.level for line in lines]
    shares = [line.reached / line.feasible if line.feasible else 0.0 for line in lines]
    reached.plot(levels, shares, **filled, label=lines[0].planner)
    contacts.plot(levels, [line.contacts for line in lines], **hollow)
    contacts.plot(levels, [line.at_fault for line in lines], **filled)
    timed = {line.level: line.time_ratio for line in lines if line.time_ratio is not None}
    time.plot(list(timed), list(timed.values()), **filled)


def _tick(line: Line) -> str:
    """Return a strength without its unit."""
    if not line.level:
        return "0"
    return str(line.level) if line.disturbance == ALL else line.strength.partition(" ")[0]
