"""A panel of the film: the robot's speed over time.

fuzzyq run mixed --plugin examples/extend/panel.py
"""

from __future__ import annotations

import numpy as np

from fuzzyq_bullet import Trajectory
from fuzzyq_bullet.video import Canvas, Moment, register_panel

LEFT, TOP, BOTTOM = 70, 36, 24
"""Pixels left free about the plot, for the title and the numbers on its axes."""
WAY, NOW, INK = (112, 124, 140), (240, 228, 66), (160, 171, 186)


@register_panel("speed", title="SPEED (m/s) OVER TIME")
class Speed:
    """All of the run in grey, and what has been driven so far in yellow."""

    def __init__(self, trajectory: Trajectory, canvas: Canvas) -> None:
        """Draw at once what stays: the axes, and the speed of the whole run."""
        self._canvas = canvas
        ticks, top = trajectory.ticks, trajectory.scenario.robot.max_speed
        right, bottom = canvas.width - 20, canvas.height - BOTTOM
        x = LEFT + (right - LEFT) * ticks.time / max(float(ticks.time[-1]), 1e-9)
        y = bottom - (bottom - TOP) * np.abs(ticks.speed) / top
        self._curve = np.column_stack([x, y])
        self._drawn = 0
        canvas.write((LEFT - 8, TOP + 6), f"{top:g}", INK, 15, align="r")
        canvas.write((LEFT - 8, bottom + 6), "0", INK, 15, align="r")
        canvas.write((right, bottom + 19), f"{ticks.time[-1]:.1f} s", INK, 15, align="r")
        canvas.line([(LEFT, TOP), (LEFT, bottom), (right, bottom)], INK, 1.0)
        canvas.line(self._curve, WAY, 1.5)

    def draw(self, moment: Moment) -> None:
        """Draw the piece that was driven since the last frame."""
        if moment.tick > self._drawn:
            self._canvas.line(self._curve[self._drawn : moment.tick + 1], NOW, 2.5)
            self._drawn = moment.tick
