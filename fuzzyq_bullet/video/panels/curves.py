"""Panels 2 and 3 of a planner without rules: where it headed, and how near things were, over time.

There is nothing fuzzy to show of such a planner. What it decided and what came of it can be shown
of any.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np

from fuzzyq_bullet.recording.rules_turn import has_rules
from fuzzyq_bullet.video import style
from fuzzyq_bullet.video.asked import metres, nearest
from fuzzyq_bullet.video.explanation import aim_name, off_aim
from fuzzyq_bullet.video.panels.base import Canvas, Panel, register_panel
from fuzzyq_bullet.video.panels.fuzzification import Fuzzification
from fuzzyq_bullet.video.panels.rules import Rules
from fuzzyq_bullet.video.timeline import NO_DECISION, Moment

if TYPE_CHECKING:
    from fuzzyq_bullet.recording.trajectory import Trajectory
    from fuzzyq_bullet.video.map.footprints import Floats

Words: TypeAlias = Callable[[int], str]

_SPAN = 10.0
"""How much of the past is seen (s)."""
_LEFT, _TOP, _RIGHT, _BOTTOM = 56, 66, 20, 30
"""Pixels left free about the plot."""
_MOST_ROOM = 1.0
"""Greatest clearance on the axis (m)."""


class Scale(NamedTuple):
    """The upright axis of a curve.

    Attributes:
        low: Value at its foot.
        high: Value at its head.
        marks: Values that are named beside it, with their names.
    """

    low: float
    high: float
    marks: tuple[tuple[float, str], ...]


class Curve:
    """What one number of each decision was, up to the one that is shown.

    Args:
        canvas: What it draws on.
        times: When each decision was taken (s), shape (D,).
        values: The number of each, shape (D,).
        scale: Its axis.
        words: What is said of each decision, called with its index.
    """

    def __init__(
        self, canvas: Canvas, times: Floats, values: Floats, scale: Scale, words: Words
    ) -> None:
        self._canvas, self._times, self._scale, self._words = canvas, times, scale, words
        self._values = np.clip(np.nan_to_num(values, posinf=scale.high), scale.low, scale.high)
        self._decision: int | None = None

    def draw(self, moment: Moment) -> None:
        """Draw the last seconds before the decision shown."""
        index = moment.shown
        if index == self._decision:
            return
        self._decision = index
        canvas, scale = self._canvas, self._scale
        canvas.wipe()
        right, bottom = canvas.width - _RIGHT, canvas.height - _BOTTOM
        for value, name in scale.marks:
            level = float(self._height(value))
            canvas.line([(_LEFT, level), (right, level)], style.LINE, 1.0)
            canvas.write((_LEFT - 8, level + 5), name, style.MUTED, 15, align="r")
        canvas.write((_LEFT, bottom + 20), f"−{_SPAN:g} s", style.MUTED, 15)
        canvas.write((right, bottom + 20), "now", style.MUTED, 15, align="r")
        if index == NO_DECISION:
            return
        text, size = style.fitting(self._words(index), canvas.width - 28, (20, 18, 16), bold=True)
        canvas.write((14, 48), text, style.TEXT, size, bold=True)
        now = float(self._times[index])
        first = int(np.searchsorted(self._times, now - _SPAN))
        x = right - (now - self._times[first : index + 1]) / _SPAN * (right - _LEFT)
        y = self._height(self._values[first : index + 1])
        canvas.line(np.column_stack([x, y]), style.HEAT, 2.5)
        angle = np.linspace(0.0, math.tau, 17)
        canvas.fill(
            np.column_stack([np.cos(angle), np.sin(angle)]) * 5 + (x[-1], y[-1]), style.TEXT
        )

    def _height(self, value: Floats | float) -> Floats:
        low, high, _ = self._scale
        bottom = self._canvas.height - _BOTTOM
        return np.asarray(bottom - (np.asarray(value) - low) / (high - low) * (bottom - _TOP))


def headings(trajectory: Trajectory, canvas: Canvas) -> Curve:
    """Return the curve of where a planner heads, seen from its aim."""
    canvas.rename("2  HEADS FOR")
    decisions = trajectory.decisions
    lean = np.array([off_aim(trajectory, k) for k in range(len(decisions.tick))])

    def words(index: int) -> str:
        name, degrees = aim_name(trajectory, index), round(math.degrees(lean[index]))
        if degrees == 0:
            return f"straight to {name}"
        return f"{abs(degrees)}° {'left' if degrees > 0 else 'right'} of {name}"

    marks = ((math.pi / 2, "left"), (0.0, "goal"), (-math.pi / 2, "right"))
    times = trajectory.ticks.time[decisions.tick]
    return Curve(canvas, times, lean, Scale(-math.pi / 2, math.pi / 2, marks), words)


def clearances(trajectory: Trajectory, canvas: Canvas) -> Curve:
    """Return the curve of how near the nearest thing was."""
    canvas.rename("3  KEEPS CLEAR")
    ticks, tick = trajectory.ticks, trajectory.decisions.tick
    near = ticks.clearance[tick]

    def words(index: int) -> str:
        far = not math.isfinite(near[index])
        return "nothing near" if far else f"{nearest(trajectory)} {metres(near[index])}"

    marks = ((_MOST_ROOM, f"{_MOST_ROOM:g} m"), (_MOST_ROOM / 2, "0.5 m"), (0.0, "touch"))
    return Curve(canvas, ticks.time[tick], near, Scale(0.0, _MOST_ROOM, marks), words)


@register_panel("fuzzification", title="2  JUDGES", place="fuzzification")
def second(trajectory: Trajectory, canvas: Canvas) -> Panel:
    """Return panel 2 for the planner of a run."""
    judges = has_rules(trajectory.decisions)
    return Fuzzification(trajectory, canvas) if judges else headings(trajectory, canvas)


@register_panel("rules", title="3  RULES THAT FIRE", place="rules")
def third(trajectory: Trajectory, canvas: Canvas) -> Panel:
    """Return panel 3 for the planner of a run."""
    ruled = has_rules(trajectory.decisions)
    return Rules(trajectory, canvas) if ruled else clearances(trajectory, canvas)
