"""Moving obstacles as they are drawn: outlines and arrows at any moment of a run."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fuzzyq_bullet.recording.moving import headings_of, poses_at
from fuzzyq_bullet.shapes.motion import placed
from fuzzyq_bullet.video import paint, style
from fuzzyq_bullet.video.map.footprints import Floats, arrow
from fuzzyq_bullet.video.timeline import jumps

if TYPE_CHECKING:
    from collections.abc import Callable

    from PIL import Image, ImageDraw

    from fuzzyq_bullet.recording.trajectory import Trajectory
    from fuzzyq_bullet.shapes import Shape

_NOSE = 1.1
"""Size of the arrow, in the radius of the largest circle about the centre that it should fill."""


class Drawn(NamedTuple):
    """One moving obstacle at a moment.

    Attributes:
        number: Which of the scenario's obstacles.
        outline: What it looks like from above (m), shape (N, 2).
        pieces: The same as convex polygons (m).
        nose: An arrow (m) that points where it goes, shape (4, 2); None if it goes nowhere.
    """

    number: int
    outline: Floats
    pieces: list[Floats]
    nose: Floats | None


class DrawnMovers:
    """The moving obstacles of one run.

    Args:
        trajectory: The run.
        corners: Returns how many corners the outline of an obstacle gets.
    """

    def __init__(self, trajectory: Trajectory, corners: Callable[[Shape], int]) -> None:
        self._trajectory = trajectory
        self._headings = headings_of(trajectory)
        self._solids = []
        for index in trajectory.scenario.movers if trajectory.movers.size else ():
            shape = trajectory.scenario.obstacles[index]
            count = corners(shape)
            self._solids.append((index, shape, shape.outline(count), shape.pieces(count)))

    def __len__(self) -> int:
        return len(self._solids)

    def at(self, time: float, tick: int) -> list[Drawn]:
        """Return all of them at a time (s), whose last tick is given.

        Beside a robot that jumps they are where they were at that tick, as the robot is.
        """
        if jumps(self._trajectory):
            time = float(self._trajectory.ticks.time[tick])
        poses = poses_at(self._trajectory, time).tolist()
        drawn = []
        for k, (index, shape, outline, pieces) in enumerate(self._solids):
            heading = float(self._headings[tick, k])
            x, y, _ = pose = poses[k]
            nose = None if math.isnan(heading) else arrow((x, y), heading, nose_size(shape))
            parts = [placed(one, shape.position, pose) for one in pieces]
            drawn.append(Drawn(index, placed(outline, shape.position, pose), parts, nose))
        return drawn


def nose_size(shape: Shape) -> float:
    """Return the size (m) of the arrow on an obstacle."""
    return _NOSE * min(shape.extent(), shape.thickness(), 0.5)


def points_of(drawn: list[Drawn]) -> Floats:
    """Return all points of outlines (m), shape (N, 2)."""
    return np.concatenate([np.empty((0, 2)), *(one.outline for one in drawn)])


def draw_mover(
    image: Image.Image, box: paint.Box, one: Drawn, spot: Callable[[Floats], Floats]
) -> None:
    """Draw an obstacle that moves on a map, with an arrow that shows where it goes.

    Args:
        image: The part of the map that is drawn on.
        box: Where it lies in the map (pixels).
        one: The obstacle.
        spot: Returns where points (m) lie in the map (pixels).
    """
    for points, colour in ((one.outline, style.MOVER), (one.nose, style.GROUND)):
        if points is not None:
            outline = spot(points)

            def draw(pen: ImageDraw.ImageDraw, at: paint.Scaled, outline: Floats = outline) -> None:
                pen.polygon(at(outline), fill=255)

            paint.stamp(image, box, outline, 1.0, colour, draw)
