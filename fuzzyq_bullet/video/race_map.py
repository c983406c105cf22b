"""The map of a race: who is where, and which way each has come."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fuzzyq_bullet.video import paint, style
from fuzzyq_bullet.video.map.legend import note
from fuzzyq_bullet.video.map.plan import Plan
from fuzzyq_bullet.video.marks import cross
from fuzzyq_bullet.video.movers import Drawn, DrawnMovers, draw_mover
from fuzzyq_bullet.video.paint import DirtyRegion
from fuzzyq_bullet.video.scene.viewpoint import extent_of
from fuzzyq_bullet.video.timeline import Steady

if TYPE_CHECKING:
    from PIL import Image, ImageDraw

    from fuzzyq_bullet.recording.trajectory import Trajectory
    from fuzzyq_bullet.video.map.footprints import Floats
    from fuzzyq_bullet.video.style import Rect
    from fuzzyq_bullet.video.timeline import Moment

COLOURS: tuple[style.Colour, ...] = (style.LEFT, (230, 159, 0), (222, 140, 184), (240, 228, 66))
"""One for each run, which the colour-blind tell apart; its number says the same."""
_WIDTH = 3.0
"""Width of a way (points)."""
_STEP = 1.5
"""A way grows by no less (pixels)."""
_RIM = 2.0
"""Width of the rim about a moving obstacle that only one run has there (points)."""
_LEAST_ROBOT = 9.0
"""A robot is never drawn with a smaller radius (points): its number must be legible."""


class RaceMap:
    """The map of some runs of one field.

    Args:
        runs: The runs.
        rect: Where it lies in the frame (pixels).
        unit: Pixels a point.

    Attributes:
        plan: The field from above; says where points (m) lie in the map.
    """

    def __init__(self, runs: Sequence[Trajectory], rect: Rect, unit: float) -> None:
        self._runs, self._rect, self._unit = runs, rect, unit
        areas = np.array([extent_of(run) for run in runs])
        (x0, y0), (x1, y1) = areas[:, :2].min(axis=0).tolist(), areas[:, 2:].max(axis=0).tolist()
        self.plan = Plan(runs[0].scenario, (x0, y0, x1, y1), rect, unit)
        self._image = paint.card(rect, unit=unit)
        note(self._image, self.plan.field, f"squares of {self.plan.step:g} m", unit)
        self.plan.draw_on(self._image)
        self._radius = [
            max(_LEAST_ROBOT * unit, run.scenario.robot.radius * self.plan.scale) for run in runs
        ]
        self._steady = [Steady(self.plan.scale) for _ in runs]
        self._movers = [DrawnMovers(run, self.plan.corners) for run in runs]
        self._moving: paint.Box | None = None
        self._ticks = [0] * len(runs)
        self._boxes: list[paint.Box | None] = [None] * len(runs)
        self._fresh = True

    def draw(self, moments: Sequence[Moment]) -> list[DirtyRegion]:
        """Return what changed since the last moments, one of each run."""
        dirty: list[paint.Box] = [(0, 0, *self._rect.size)] if self._fresh else []
        for number, moment in enumerate(moments):
            if not self._steady[number].moved(moment) and not self._fresh:
                continue
            grown = self._grow(number, moment.tick)
            margin = self._radius[number] + 3 * self._unit
            spot = self.plan.spot([moment.position])
            now = paint.box_around(spot, margin, self._rect.size)
            hit = self._hit(number, moment)
            if hit is not None:
                around = paint.box_around(hit, 20 * self._unit, self._rect.size)
                now = paint.joined([now, around])
            box = paint.joined([now, self._boxes[number], grown])
            self._boxes[number] = now
            if box is not None and not self._fresh:
                dirty.append(box)
        movers = self._movers_at(moments)
        before, self._moving = self._moving, self._box_of(movers)
        moved = paint.joined([before, self._moving])
        if moved is not None and not self._fresh:
            dirty.append(moved)
        self._fresh = False
        return [self._composed(box, moments, movers) for box in dirty]

    def _movers_at(self, moments: Sequence[Moment]) -> list[tuple[Drawn, style.Colour | None]]:
        """Return the moving obstacles of all runs that go on, or of the last, and their rims.

        They are the same in all runs, but for those that a robot has stopped: these are there once
        for each run, with a rim in its colour.
        """
        going = [number for number, moment in enumerate(moments) if not moment.over]
        last = max(range(len(moments)), key=lambda number: moments[number].time)
        found: list[tuple[Drawn, style.Colour | None]] = []
        drawn = {
            number: self._movers[number].at(moments[number].time, moments[number].tick)
            for number in going or [last]
        }
        for same in zip(*drawn.values(), strict=True):
            places = np.array([one.outline.mean(axis=0) for one in same])
            if np.ptp(places, axis=0).max() * self.plan.scale < 1.0:
                found.append((same[0], None))
            else:
                found += [(one, COLOURS[number]) for number, one in zip(drawn, same, strict=True)]
        return found

    def _box_of(self, movers: Sequence[tuple[Drawn, style.Colour | None]]) -> paint.Box | None:
        """Return the part of the map that moving obstacles cover."""
        size, margin = self._rect.size, (_RIM + 2) * self._unit
        return paint.joined(
            paint.box_around(self.plan.spot(one.outline), margin, size) for one, _ in movers
        )

    def _composed(
        self,
        box: paint.Box,
        moments: Sequence[Moment],
        movers: Sequence[tuple[Drawn, style.Colour | None]],
    ) -> DirtyRegion:
        """Return a part of the map with all that moves, the first robot on top."""
        image = self._image.crop(box)
        for one, rim in movers:
            draw_mover(image, box, one, self.plan.spot)
            if rim is not None:
                self._draw_rim(image, box, self.plan.spot(one.outline), rim)
        for number, moment in reversed(list(enumerate(moments))):
            self._draw_robot(image, box, number, moment)
        return DirtyRegion(self._rect.x + box[0], self._rect.y + box[1], image)

    def _draw_robot(self, image: Image.Image, box: paint.Box, number: int, moment: Moment) -> None:
        spot, radius, unit = self.plan.spot([moment.position])[0], self._radius[number], self._unit
        around = paint.box_around([spot], radius + 3 * unit, self._rect.size)
        if around is None:
            return
        if around[0] < box[2] and around[2] > box[0] and around[1] < box[3] and around[3] > box[1]:
            model = self._runs[number].scenario.robot.spec
            outline = np.array(model.footprint) / model.radius
            narrow = radius * float(np.abs(outline).max(axis=0).min())
            cos, sin = math.cos(moment.heading), math.sin(moment.heading)
            outline = outline @ np.array([(cos, -sin), (-sin, -cos)])  # y points down
            for colour, reach in ((style.PAGE, radius + 1.5 * unit), (COLOURS[number], radius)):
                body = spot + outline * reach

                def draw(pen: ImageDraw.ImageDraw, at: paint.Scaled, body: Floats = body) -> None:
                    pen.polygon(at(body), fill=255)

                paint.stamp(image, box, [spot], reach + 1, colour, draw)
            size = max(round(1.3 * narrow), 1)
            at = (float(spot[0]) - box[0], float(spot[1]) + 0.36 * size - box[1])
            paint.write(image, at, str(number + 1), style.PAGE, size, bold=True, align="m")
        hit = self._hit(number, moment)
        if hit is not None:
            cross(image, box, hit[0], 8.0, unit)

    def _draw_rim(
        self, image: Image.Image, box: paint.Box, outline: Floats, colour: style.Colour
    ) -> None:
        """Draw a line about a moving obstacle."""
        width = _RIM * self._unit

        def draw(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
            paint.polyline(pen, at([*outline, *outline[:2]]), 255, width * at.factor)

        paint.stamp(image, box, outline, width + 1, colour, draw)

    def _hit(self, number: int, moment: Moment) -> Floats | None:
        """Return where a run collided (pixels), shape (1, 2), when that is over."""
        collision = self._runs[number].collision
        return self.plan.spot([collision.point]) if moment.over and collision else None

    def _grow(self, number: int, tick: int) -> paint.Box | None:
        """Draw the way of a run up to a tick and return the box that changed."""
        since, path = self._ticks[number], self._runs[number].ticks.position
        if tick <= since:
            return None
        ends = self.plan.spot(path[[since, tick]])
        if np.abs(ends[1] - ends[0]).max() < _STEP:
            return None
        points = self.plan.spot(path[since : tick + 1])
        self._ticks[number] = tick
        width = _WIDTH * self._unit
        piece = paint.layer(
            points,
            width + 1,
            self._rect.size,
            lambda pen, at: paint.polyline(pen, at(points), 255, width * at.factor),
        )
        if piece is None:
            return None
        piece.lay(self._image, (0, 0, *self._rect.size), COLOURS[number])
        return piece.box
