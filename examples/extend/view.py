"""A view of the film: how far the robot is from the goal, in large figures, and a bar.

fuzzyq run mixed --plugin examples/extend/view.py --view countdown
"""

from __future__ import annotations

import math
from collections.abc import Iterable

from fuzzyq_bullet import Trajectory
from fuzzyq_bullet.video import DirtyRegion, Moment, Stage, View, register_view

GREEN, GREY = (20, 184, 138), (58, 67, 80)


@register_view("countdown")
class Countdown(View):
    """The way to go, which becomes nothing in the goal."""

    def __init__(self, trajectory: Trajectory, stage: Stage) -> None:
        """Ask for the whole frame as a canvas: 1280 x 720 points in a film of the usual shape."""
        self._canvas = stage.canvas("THE WAY TO GO")
        self._goal = trajectory.scenario.goal.position
        self._whole = math.dist(trajectory.scenario.start.position, self._goal)

    def draw(self, moment: Moment) -> Iterable[DirtyRegion]:
        """Draw the frame anew and return what changed: all of it."""
        canvas, away = self._canvas, math.dist(moment.position, self._goal)
        middle, width = canvas.width / 2, 0.8 * canvas.width
        canvas.wipe()
        canvas.write((middle, 0.5 * canvas.height), f"{away:.2f} m", size=120, bold=True, align="m")
        left, level = middle - width / 2, 0.7 * canvas.height
        done = left + width * min(max(1.0 - away / self._whole, 0.0), 1.0)
        canvas.line([(left, level), (left + width, level)], GREY, 24.0)
        canvas.line([(left, level), (done, level)], GREEN, 24.0)
        return canvas.take_changes()
