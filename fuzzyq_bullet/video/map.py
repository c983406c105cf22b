"""The map: everything from straight above, with the way so far and the detection lines."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from fuzzyq_bullet.video import paint, style
from fuzzyq_bullet.video.avoidance import Avoidance
from fuzzyq_bullet.video.footprints import Floats, arrow, clipped, corners_for
from fuzzyq_bullet.video.legend import legend, note
from fuzzyq_bullet.video.marks import began, cross, diamond, grid_step, left_off, reticle
from fuzzyq_bullet.video.paint import DirtyRegion
from fuzzyq_bullet.video.style import MAP
from fuzzyq_bullet.video.timeline import Sensed, Steady
from fuzzyq_bullet.video.viewpoint import extent_of

if TYPE_CHECKING:
    from PIL import Image, ImageDraw

    from fuzzyq_bullet.trajectory import Trajectory
    from fuzzyq_bullet.video.timeline import Moment

_PADDING = 12
_LINE = 3.6
"""Width of a detection line (pixels)."""
_OUTLINE = 2.4
"""Width of the line about what the robot goes round (pixels)."""
_COVERS = 14.0
"""Nothing is marked nearer to the robot (pixels); the scene is larger, and shows it."""
_LEAST_ROBOT = 6.0
"""The robot is never drawn with a smaller radius (pixels)."""


class Map:
    """The map of one run."""

    def __init__(self, trajectory: Trajectory) -> None:
        x0, y0, x1, y1 = extent_of(trajectory)
        width, height = MAP.size
        self._scale = min((width - 2 * _PADDING) / (x1 - x0), (height - 2 * _PADDING) / (y1 - y0))
        self._radius = trajectory.scenario.robot.radius
        self._middle = ((x0 + x1) / 2, (y0 + y1) / 2)
        self._area = (x0, y0, x1, y1)
        positions = trajectory.ticks.position
        self._avoidance = Avoidance(trajectory)
        self._trail = paint.Trail(self._background(trajectory), positions, self.spot)
        self._struck = self._outline_struck(trajectory)
        self._avoided: int | None = None
        self._marked = 0
        self._aim: tuple[float, float] | None = None
        self._steady = Steady(self._scale)
        self._sensed: Sensed | None = None
        self._changed: paint.Box | None = (0, 0, *MAP.size)

    def spot(self, points: ArrayLike) -> Floats:
        """Return where points (m), shape (N, 2), lie in the card (pixels)."""
        p = (np.asarray(points, dtype=np.float64).reshape(-1, 2) - self._middle) * self._scale
        return np.asarray(p * (1.0, -1.0) + (MAP.width / 2, MAP.height / 2))

    def draw(
        self, moment: Moment, sensed: Sensed | None, hit: tuple[float, float] | None = None
    ) -> DirtyRegion | None:
        """Return what changed since the last moment drawn; ``hit`` marks a collision (m)."""
        if not self._steady.moved(moment) and sensed is self._sensed:
            return None
        self._sensed = sensed
        grown = paint.joined(
            [
                self._trail.follow(moment.tick),
                self._decorate(moment.decision),
                self._point_at(None if sensed is None else self._apart(sensed, sensed.aim)),
            ]
        )
        centre = self.spot([moment.position])[0]
        radius = max(_LEAST_ROBOT, self._radius * self._scale)
        strokes = [] if sensed is None else [self._line(sensed, *line) for line in sensed.lines]
        parts = [
            paint.box_around(
                np.stack([centre, *np.reshape(strokes, (-1, 2))]), radius + 3, MAP.size
            )
        ]
        target = None
        if sensed is not None and (to := self._apart(sensed, sensed.target)) is not None:
            target = self.spot([to])[0]
            parts.append(paint.box_around(target, 12, MAP.size))
        if hit is not None:
            parts.append(paint.box_around(self.spot([hit]), 20, MAP.size))
            if len(self._struck):
                parts.append(paint.box_around(self._struck, 6, MAP.size))
        now = paint.joined(parts)
        box = paint.joined([now, self._changed, grown])
        self._changed = now
        if box is None:
            return None

        image = self._trail.image.crop(box)
        for stroke, colour in zip(strokes, style.LINES, strict=False):
            _draw_line(image, box, stroke, colour)
        if target is not None:
            diamond(image, box, target, 8.0)
        _robot(image, box, centre, -moment.heading, radius)
        if hit is not None:
            if len(self._struck):
                _draw_ring(image, box, self._struck)
            cross(image, box, self.spot([hit])[0], 10.0)
        return DirtyRegion(MAP.x + box[0], MAP.y + box[1], image)

    def _decorate(self, decision: int) -> paint.Box | None:
        """Mark where ways out began and ended so far, and outline what the robot goes round now."""
        avoidance, changed = self._avoidance, []
        while self._marked < len(avoidance.marks):
            mark = avoidance.marks[self._marked]
            if mark.decision > decision:
                break
            self._marked += 1
            draw = began if mark.begins else left_off
            changed.append(self._trail.lay_above(draw(self.spot([mark.point])[0], MAP.size)))
        avoided = avoidance.group_at(decision)
        if avoided != self._avoided:
            self._avoided = avoided
            outline = None if avoided is None else self._outline(avoided)
            changed.append(self._trail.lay_below(outline))
        return paint.joined(changed)

    def _apart(
        self, sensed: Sensed, point: tuple[float, float] | None
    ) -> tuple[float, float] | None:
        """Return a point (m) to be marked, unless its mark would cover the robot."""
        if point is None or math.dist(point, sensed.origin) * self._scale < _COVERS:
            return None
        return point

    def _point_at(self, aim: tuple[float, float] | None) -> paint.Box | None:
        """Mark the aim (m)."""
        if aim == self._aim:
            return None
        self._aim = aim
        return self._trail.pin([] if aim is None else reticle(self.spot([aim])[0], MAP.size))

    def _outline(self, group: int) -> paint.Inked | None:
        """Return a line about a group of obstacles, or along a wall, as far as they are seen."""
        x0, y0, x1, y1 = self._area
        seen = np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
        wall = self._avoidance.wall(group)
        parts = [
            self.spot(clipped(one.outline(corners_for(one.extent() * self._scale)), seen))
            for one in self._avoidance.members(group)
        ]

        def draw(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
            width = _OUTLINE * at.factor
            if wall is not None:
                paint.polyline(pen, at(self.spot(wall)), 255, 1.4 * width)
            for part in parts:
                paint.polyline(pen, at([*part, *part[:2]]), 255, 2 * width)
            for part in parts:  # only the outside half stays, and nothing where two overlap
                if len(part) >= 3:
                    pen.polygon(at(part), fill=0)

        points = np.concatenate([*parts, np.empty((0, 2)) if wall is None else self.spot(wall)])
        drawn = paint.layer(points, _OUTLINE + 2, MAP.size, draw)
        return None if drawn is None else (style.TARGET, drawn)

    def _line(self, sensed: Sensed, heading: float, length: float) -> Floats:
        """Return a detection line from the robot's rim to where the robot would touch something."""
        way = np.array((math.cos(heading), math.sin(heading)))
        ends = [sensed.origin + way * sensed.radius, sensed.origin + way * (sensed.radius + length)]
        return self.spot(ends)

    def _outline_struck(self, trajectory: Trajectory) -> Floats:
        """Return the outline (pixels) of the obstacle that the robot collided with, if any."""
        hit = trajectory.collision
        if hit is None or hit.obstacle < 0:
            return np.empty((0, 2))
        obstacle = trajectory.scenario.obstacles[hit.obstacle]
        x0, y0, x1, y1 = self._area
        seen = np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
        outline = obstacle.outline(corners_for(obstacle.extent() * self._scale))
        return self.spot(clipped(outline, seen))

    def _background(self, trajectory: Trajectory) -> Image.Image:
        image = paint.card(MAP)
        scenario = trajectory.scenario
        x0, y0, x1, y1 = self._area
        low, high = self.spot([(x0, y1)])[0], self.spot([(x1, y0)])[0]
        field = paint.box_around([low, high], 0, MAP.size)
        assert field is not None
        step = grid_step(max(x1 - x0, y1 - y0))
        seen = np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
        note(image, field, f"squares of {step:g} m")
        decisions = trajectory.decisions
        legend(
            image,
            field,
            aims=bool(np.isfinite(decisions.aim).any()),
            ways_out=bool(self._avoidance.marks),
        )

        def ground(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
            pen.rectangle(at([low, high]), fill=255)

        def grid(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
            for x in np.arange(math.ceil(x0 / step), x1 / step) * step:
                pen.line(at(self.spot([(x, y0), (x, y1)])), 255, at.factor)
            for y in np.arange(math.ceil(y0 / step), y1 / step) * step:
                pen.line(at(self.spot([(x0, y), (x1, y)])), 255, at.factor)

        def obstacles(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
            for obstacle in scenario.obstacles:
                x, y = obstacle.position
                r = obstacle.extent()
                if x + r > x0 and x - r < x1 and y + r > y0 and y - r < y1:
                    outline = obstacle.outline(corners_for(r * self._scale))
                    pen.polygon(at(self.spot(clipped(outline, seen))), fill=255)

        def walls(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
            pen.rectangle(at([low, high]), outline=255, width=2 * at.factor)

        def start(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
            centre = self.spot([scenario.start.position])[0]
            radius = max(5.0, scenario.robot.radius * self._scale)
            pen.ellipse(at.disc(centre, radius), outline=255, width=2 * at.factor)

        goal_at = self.spot([scenario.goal.position])[0]
        goal_radius = max(7.0, scenario.goal.radius * self._scale)

        def goal(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
            pen.ellipse(at.disc(goal_at, goal_radius), fill=100, outline=255, width=2 * at.factor)

        def flag(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
            x, y = goal_at
            pen.line(at([(x, y), (x, y - 21)]), 255, 2 * at.factor)
            pen.polygon(at([(x, y - 22), (x + 14, y - 16), (x, y - 10)]), fill=255)

        layers = [(ground, style.GROUND), (grid, style.GRID), (obstacles, style.OBSTACLE)]
        if scenario.arena.walls:
            layers.append((walls, style.WALL))
        for draw, colour in [*layers, (start, style.FAINT), (goal, style.GOAL), (flag, style.GOAL)]:
            layer = paint.mask(field, draw)
            image.paste(colour, (field[0], field[1]), layer)
        return image


def _draw_line(image: Image.Image, box: paint.Box, stroke: Floats, colour: style.Colour) -> None:
    def draw(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
        paint.polyline(pen, at(stroke), 255, _LINE * at.factor)

    paint.stamp(image, box, stroke, _LINE, colour, draw)


def _draw_ring(image: Image.Image, box: paint.Box, outline: Floats) -> None:
    """Mark the obstacle that was hit."""

    def draw(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
        paint.polyline(pen, at([*outline, outline[0]]), 255, 3.0 * at.factor)

    paint.stamp(image, box, outline, 4, style.DANGER, draw)


def _robot(
    image: Image.Image, box: paint.Box, centre: Floats, heading: float, radius: float
) -> None:
    """Draw the robot's disc; ``heading`` is clockwise, as the picture's y points down."""
    nose = arrow((float(centre[0]), float(centre[1])), heading, radius * 1.5)

    def body(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
        pen.ellipse(at.disc(centre, radius), fill=255)

    def mark(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
        pen.polygon(at(nose), fill=255)

    paint.stamp(image, box, [centre], radius + 1, style.ROBOT, body)
    paint.stamp(image, box, [centre], radius + 1, style.PAGE, mark)
