"""A run as a notebook shows it: what came of it in two lines, and its path from above."""

from __future__ import annotations

import base64
import io
import math
from html import escape

import numpy as np
from matplotlib.figure import Figure

from fuzzyq_bullet.figures.style import GREY, INK
from fuzzyq_bullet.figures.topdown import LEGEND, draw_run
from fuzzyq_bullet.recording.trajectory import Trajectory
from fuzzyq_bullet.video.scene.viewpoint import extent_of

ENDS = {
    "goal": "reached the goal",
    "stuck": "got stuck",
    "timeout": "ran out of time",
    "collision": "touched something",
}
"""What is said of each outcome."""

_SIDE = 4.4
"""Longer side of what is shown (inches)."""


def html_of(trajectory: Trajectory) -> str:
    """Return a run as a piece of HTML, complete in itself: text and a picture.

    Nothing is measured that takes time, such as the shortest path: ``result_of`` tells that.
    """
    scenario, ticks = trajectory.scenario, trajectory.ticks
    driven = float(np.hypot(*np.diff(ticks.position, axis=0).T).sum())
    nearest = float(ticks.clearance.min())
    told = f"{ENDS[trajectory.outcome]} after {ticks.time[-1]:.2f} s; drove {driven:.2f} m"
    if math.isfinite(nearest) and trajectory.collision is None:
        told += f", never nearer than {100 * nearest:.1f} cm to anything"
    how = f"Planner {scenario.planner.name}, drive {scenario.drive}, seed {scenario.seed}"
    words = f"{scenario.name}: {told}"
    picture = base64.b64encode(picture_of(trajectory)).decode("ascii")
    return (
        f"<p><b>{escape(scenario.name)}</b>: {escape(told)}.<br>{escape(how)}.</p>"
        f'<img alt="{escape(words)}" style="max-width: 100%" '
        f'src="data:image/png;base64,{picture}">'
    )


def picture_of(trajectory: Trajectory) -> bytes:
    """Return a run seen from above, with a legend of what it shows, as a PNG."""
    x0, y0, x1, y1 = extent_of(trajectory)
    scale = _SIDE / max(x1 - x0, y1 - y0)
    figure = Figure(figsize=(scale * (x1 - x0), scale * (y1 - y0)), dpi=100)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    shown = draw_run(axes, trajectory)
    axes.set(xlim=(x0, x1), ylim=(y0, y1))
    axes.tick_params(labelsize=8, color=GREY, labelcolor=INK)
    axes.set_xlabel("x (m)", fontsize=8)
    axes.set_ylabel("y (m)", fontsize=8)
    entries = [words for words in LEGEND if words in shown]
    axes.legend(
        [shown[words] for words in entries], entries, loc="upper left",
        bbox_to_anchor=(1.02, 1.0), borderaxespad=0.0, frameon=False, fontsize=8,
    )  # fmt: skip
    file = io.BytesIO()
    figure.savefig(file, format="png", bbox_inches="tight")
    return file.getvalue()
