"""The field from straight above, with all that never moves: obstacles, walls, start and goal."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from fuzzyq_bullet.video import paint, style
from fuzzyq_bullet.video.map.footprints import Floats, clipped, corners_for, pointer
from fuzzyq_bullet.video.marks import grid_step
from fuzzyq_bullet.video.style import MAP

if TYPE_CHECKING:
    from PIL import Image, ImageDraw

    from fuzzyq_bullet.scenario.models import Scenario
    from fuzzyq_bullet.shapes import Shape
    from fuzzyq_bullet.video.style import Rect

_PADDING = 12
"""Room left free about the field (points)."""


class Plan:
    """A part of an arena, as large as a card has room for.

    Args:
        scenario: Whose arena it is.
        area: The part of it that is shown: x0, y0, x1, y1 (m).
        rect: The card.
        unit: Pixels a point.

    Attributes:
        scale: Size of a metre (pixels).
        step: Side of a square of the grid (m).
        field: Where in the card the part of the arena lies.
    """

    def __init__(
        self, scenario: Scenario, area: tuple[float, float, float, float], rect: Rect, unit: float
    ) -> None:
        self._scenario, self._rect, self._unit, self._area = scenario, rect, unit, area
        x0, y0, x1, y1 = area
        across, down = (side - 2 * _PADDING * unit for side in rect.size)
        self.scale = min(across / (x1 - x0), down / (y1 - y0))
        self._middle = ((x0 + x1) / 2, (y0 + y1) / 2)
        self._fine = 2 if rect.height > MAP.height else 1  # large corners would be seen
        self.step = grid_step(max(x1 - x0, y1 - y0))
        field = paint.box_around(self.spot([(x0, y1), (x1, y0)]), 0, rect.size)
        assert field is not None
        self.field = field

    def spot(self, points: ArrayLike) -> Floats:
        """Return where points (m), shape (N, 2), lie in the card (pixels)."""
        p = (np.asarray(points, dtype=np.float64).reshape(-1, 2) - self._middle) * self.scale
        return np.asarray(p * (1.0, -1.0) + (self._rect.width / 2, self._rect.height / 2))

    def outline(self, obstacle: Shape) -> Floats:
        """Return the outline (pixels) of what is seen of an obstacle, shape (N, 2)."""
        x0, y0, x1, y1 = self._area
        seen = np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
        outline = obstacle.outline(self.corners(obstacle))
        return self.spot(clipped(outline, seen))

    def corners(self, obstacle: Shape) -> int:
        """Return how many corners make something round look so."""
        return self._fine * corners_for(obstacle.extent() * self.scale)

    def draw_on(self, image: Image.Image) -> None:
        """Draw the field on the card."""
        unit, scenario, step, field = self._unit, self._scenario, self.step, self.field
        x0, y0, x1, y1 = self._area
        low, high = self.spot([(x0, y1)])[0], self.spot([(x1, y0)])[0]

        def ground(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
            pen.rectangle(at([low, high]), fill=255)

        def grid(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
            for x in np.arange(math.ceil(x0 / step), x1 / step) * step:
                pen.line(at(self.spot([(x, y0), (x, y1)])), 255, round(unit * at.factor))
            for y in np.arange(math.ceil(y0 / step), y1 / step) * step:
                pen.line(at(self.spot([(x0, y), (x1, y)])), 255, round(unit * at.factor))

        def obstacles(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
            for obstacle in scenario.standing:
                x, y = obstacle.position
                r = obstacle.extent()
                if x + r > x0 and x - r < x1 and y + r > y0 and y - r < y1:
                    pen.polygon(at(self.outline(obstacle)), fill=255)

        def walls(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
            pen.rectangle(at([low, high]), outline=255, width=round(2 * unit * at.factor))

        def start(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
            centre = self.spot([scenario.start.position])[0]
            body = scenario.robot.spec.footprint_at(
                *scenario.start.position, scenario.start_heading()
            )
            larger = max(1.0, 5.0 * unit / (scenario.robot.radius * self.scale))
            rim = centre + larger * (self.spot([*body, body[0]]) - centre)
            pen.line(at(rim), 255, round(2 * unit * at.factor), joint="curve")

        def via(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
            for number, one in enumerate(scenario.via, 1):
                centre = self.spot([one.position])[0]
                radius = max(7.0 * unit, one.radius * self.scale)
                width = round(2 * unit * at.factor)
                pen.ellipse(at.disc(centre, radius), outline=255, width=width)
                font = style.font(round(14 * unit * at.factor), bold=True)
                # Beside the ring, towards the middle: the reticle may stand in the ring.
                towards = np.where(centre > (self._rect.width / 2, self._rect.height / 2), -1, 1)
                beside = centre + 0.71 * (radius + 10 * unit) * towards
                pen.text(at([beside])[0], str(number), 255, font, anchor="mm")

        def facing(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
            long = 2.5 * max(scenario.goal.radius, 7.0 * unit / self.scale)
            for part in pointer(scenario.goal.position, scenario.goal.heading or 0.0, long):
                pen.polygon(at(self.spot(part)), fill=255)

        goal_at = self.spot([scenario.goal.position])[0]
        goal_radius = max(7.0 * unit, scenario.goal.radius * self.scale)

        def goal(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
            width = round(2 * unit * at.factor)
            pen.ellipse(at.disc(goal_at, goal_radius), fill=100, outline=255, width=width)

        def flag(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
            x, y = goal_at
            pen.line(at([(x, y), (x, y - 21 * unit)]), 255, round(2 * unit * at.factor))
            tip = (x + 14 * unit, y - 16 * unit)
            pen.polygon(at([(x, y - 22 * unit), tip, (x, y - 10 * unit)]), fill=255)

        layers = [(ground, style.GROUND), (grid, style.GRID), (obstacles, style.OBSTACLE)]
        if scenario.arena.walls:
            layers.append((walls, style.WALL))
        if scenario.via:
            layers.append((via, style.GOAL))
        if scenario.goal.heading is not None:
            layers.append((facing, style.GOAL))
        for draw, colour in [*layers, (start, style.FAINT), (goal, style.GOAL), (flag, style.GOAL)]:
            layer = paint.mask(field, draw)
            image.paste(colour, (field[0], field[1]), layer)
