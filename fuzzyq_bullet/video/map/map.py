"""The map: everything from straight above, with the way so far and the detection lines."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fuzzyq_bullet.recording.rules_turn import has_rules
from fuzzyq_bullet.video import paint, style
from fuzzyq_bullet.video.map.avoidance import Avoidance
from fuzzyq_bullet.video.map.footprints import Floats, arrow
from fuzzyq_bullet.video.map.legend import legend, note
from fuzzyq_bullet.video.map.plan import Plan
from fuzzyq_bullet.video.map.trail import Trail
from fuzzyq_bullet.video.marks import began, cross, diamond, left_off, passed, reticle
from fuzzyq_bullet.video.movers import DrawnMovers, draw_mover
from fuzzyq_bullet.video.paint import DirtyRegion
from fuzzyq_bullet.video.scene.viewpoint import extent_of
from fuzzyq_bullet.video.style import MAP, Rect
from fuzzyq_bullet.video.timeline import Sensed, Steady

if TYPE_CHECKING:
    from PIL import Image, ImageDraw

    from fuzzyq_bullet.recording.trajectory import Trajectory
    from fuzzyq_bullet.video.timeline import Moment

_LINE = 3.6
"""Width of a detection line (points)."""
_OUTLINE = 2.4
"""Width of the line about what the robot goes round (points)."""
_COVERS = 14.0
"""Nothing is marked nearer to the robot (points); the scene is larger, and shows it."""
_LEAST_ROBOT = 6.0
"""The robot is never drawn with a smaller radius (points)."""


class Map:
    """The map of one run.

    Args:
        trajectory: The run.
        rect: Where it lies in the frame (pixels).
        unit: Pixels a point; see ``Layout``.

    Attributes:
        spot: Returns where points (m), shape (N, 2), lie in the card (pixels).
    """

    def __init__(self, trajectory: Trajectory, rect: Rect = MAP, unit: float = 1.0) -> None:
        self._rect, self._unit = rect, unit
        self._plan = plan = Plan(trajectory.scenario, extent_of(trajectory), rect, unit)
        self._scale, self.spot = plan.scale, plan.spot
        self._radius = trajectory.scenario.robot.radius
        model = trajectory.scenario.robot.spec
        self._footprint = None if model.is_disc else np.array(model.footprint) / model.radius
        positions = trajectory.ticks.position
        self._avoidance = Avoidance(trajectory)
        ruled, targets = has_rules(trajectory.decisions), trajectory.decisions.target
        still = paint.card(rect, unit=unit)
        note(still, plan.field, f"squares of {plan.step:g} m", unit)
        legend(
            still,
            plan.field,
            aims=bool(np.isfinite(trajectory.decisions.aim).any()),
            begins=any(mark.begins for mark in self._avoidance.marks),
            ends=any(not mark.begins for mark in self._avoidance.marks),
            targets=bool(self._avoidance.marks) and (ruled or bool(np.isfinite(targets).any())),
            ruled=ruled,
            unit=unit,
        )
        plan.draw_on(still)
        self._trail = Trail(still, positions, self.spot, unit=unit)
        self._movers = DrawnMovers(trajectory, plan.corners)
        self._struck = self._outline_struck(trajectory)
        self._avoided: int | None = None
        self._marked = 0
        self._via, self._via_passed = trajectory.scenario.via, trajectory.via_passed
        self._passed = 0
        self._aim: tuple[float, float] | None = None
        self._steady = Steady(self._scale)
        self._sensed: Sensed | None = None
        self._changed: paint.Box | None = (0, 0, *rect.size)

    def draw(
        self, moment: Moment, sensed: Sensed | None, hit: tuple[float, float] | None = None
    ) -> DirtyRegion | None:
        """Return what changed since the last moment drawn; ``hit`` marks a collision (m)."""
        moved = self._steady.moved(moment) or len(self._movers)
        if not moved and sensed is self._sensed:
            return None
        self._sensed = sensed
        grown = paint.joined(
            [
                self._trail.follow(moment.tick),
                self._decorate(moment.decision),
                self._mark_passed(moment.tick),
                self._point_at(None if sensed is None else self._apart(sensed, sensed.aim)),
            ]
        )
        unit, size = self._unit, self._rect.size
        centre = self.spot([moment.position])[0]
        radius = max(_LEAST_ROBOT * unit, self._radius * self._scale)
        strokes = [] if sensed is None else [self._line(sensed, *line) for line in sensed.lines]
        parts = [
            paint.box_around(
                np.stack([centre, *np.reshape(strokes, (-1, 2))]), radius + 3 * unit, size
            )
        ]
        movers = self._movers.at(moment.time, moment.tick)
        parts += [paint.box_around(self.spot(one.outline), 3 * unit, size) for one in movers]
        target = None
        if sensed is not None and (to := self._apart(sensed, sensed.target)) is not None:
            target = self.spot([to])[0]
            parts.append(paint.box_around(target, 12 * unit, size))
        if hit is not None:
            parts.append(paint.box_around(self.spot([hit]), 20 * unit, size))
            if len(self._struck):
                parts.append(paint.box_around(self._struck, 6 * unit, size))
        now = paint.joined(parts)
        box = paint.joined([now, self._changed, grown])
        self._changed = now
        if box is None:
            return None

        image = self._trail.image.crop(box)
        for one in movers:
            draw_mover(image, box, one, self.spot)
        for stroke, colour in zip(strokes, style.LINES, strict=False):
            _draw_line(image, box, stroke, colour, unit)
        if target is not None:
            diamond(image, box, target, 8.0, unit)
        draw_robot(image, box, centre, -moment.heading, radius, footprint=self._footprint)
        if hit is not None:
            if len(self._struck):
                _draw_ring(image, box, self._struck, unit)
            cross(image, box, self.spot([hit])[0], 10.0, unit)
        return DirtyRegion(self._rect.x + box[0], self._rect.y + box[1], image)

    def _decorate(self, decision: int) -> paint.Box | None:
        """Mark where ways out began and ended so far, and outline what the robot goes round now."""
        avoidance, changed = self._avoidance, []
        while self._marked < len(avoidance.marks):
            mark = avoidance.marks[self._marked]
            if mark.decision > decision:
                break
            self._marked += 1
            draw = began if mark.begins else left_off
            shapes = draw(self.spot([mark.point])[0], self._rect.size, self._unit)
            changed.append(self._trail.lay_above(shapes))
        avoided = avoidance.group_at(decision)
        if avoided != self._avoided:
            self._avoided = avoided
            outline = None if avoided is None else self._outline(avoided)
            changed.append(self._trail.lay_below(outline))
        return paint.joined(changed)

    def _mark_passed(self, tick: int) -> paint.Box | None:
        """Mark the via points that were passed by a tick."""
        before, self._passed = self._passed, int(self._via_passed[tick])
        return paint.joined(
            self._trail.lay_above(passed(self.spot([one.position])[0], self._rect.size, self._unit))
            for one in self._via[before : self._passed]
        )

    def _apart(
        self, sensed: Sensed, point: tuple[float, float] | None
    ) -> tuple[float, float] | None:
        """Return a point (m) to be marked, unless its mark would cover the robot."""
        if point is None:
            return None
        away = math.dist(point, sensed.origin) * self._scale
        return None if away < _COVERS * self._unit else point

    def _point_at(self, aim: tuple[float, float] | None) -> paint.Box | None:
        """Mark the aim (m)."""
        if aim == self._aim:
            return None
        self._aim = aim
        if aim is None:
            return self._trail.pin([])
        return self._trail.pin(reticle(self.spot([aim])[0], self._rect.size, unit=self._unit))

    def _outline(self, group: int) -> paint.Inked | None:
        """Return a line about a group of obstacles, or along a wall, as far as they are seen."""
        wall = self._avoidance.wall(group)
        parts = [self._plan.outline(one) for one in self._avoidance.members(group)]

        def draw(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
            width = _OUTLINE * self._unit * at.factor
            if wall is not None:
                paint.polyline(pen, at(self.spot(wall)), 255, 1.4 * width)
            for part in parts:
                paint.polyline(pen, at([*part, *part[:2]]), 255, 2 * width)
            for part in parts:  # only the outside half stays, and nothing where two overlap
                if len(part) >= 3:
                    pen.polygon(at(part), fill=0)

        points = np.concatenate([*parts, np.empty((0, 2)) if wall is None else self.spot(wall)])
        drawn = paint.layer(points, (_OUTLINE + 2) * self._unit, self._rect.size, draw)
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
        if hit.obstacle in trajectory.scenario.movers:
            last = len(trajectory.ticks.time) - 1
            drawn = self._movers.at(float(trajectory.ticks.time[-1]), last)
            return self.spot(next(one.outline for one in drawn if one.number == hit.obstacle))
        return self._plan.outline(trajectory.scenario.obstacles[hit.obstacle])


def _draw_line(
    image: Image.Image, box: paint.Box, stroke: Floats, colour: style.Colour, unit: float
) -> None:
    def draw(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
        paint.polyline(pen, at(stroke), 255, _LINE * unit * at.factor)

    paint.stamp(image, box, stroke, _LINE * unit, colour, draw)


def _draw_ring(image: Image.Image, box: paint.Box, outline: Floats, unit: float) -> None:
    """Mark the obstacle that was hit."""

    def draw(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
        paint.polyline(pen, at([*outline, outline[0]]), 255, 3.0 * unit * at.factor)

    paint.stamp(image, box, outline, 4 * unit, style.DANGER, draw)


def draw_robot(
    image: Image.Image,
    box: paint.Box,
    centre: Floats,
    heading: float,
    radius: float,
    colour: style.Colour = style.ROBOT,
    footprint: Floats | None = None,
) -> None:
    """Draw the robot; ``heading`` is clockwise, as the picture's y points down.

    Args:
        image: The part of the map that is drawn on.
        box: Where it lies in the map (pixels).
        centre: The robot's place (pixels).
        heading: Where it faces (rad).
        radius: Radius of its disc (pixels).
        colour: Its colour.
        footprint: Outline of a body that is no disc, in radii, shape (N, 2); its own frame.
    """
    size = radius * (1.5 if footprint is None else 0.75)
    nose = arrow((float(centre[0]), float(centre[1])), heading, size)
    outline = None
    if footprint is not None:
        cos, sin = math.cos(heading), math.sin(heading)
        ahead, aside = radius * footprint[:, 0], -radius * footprint[:, 1]
        outline = centre + np.column_stack([ahead * cos - aside * sin, ahead * sin + aside * cos])

    def body(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
        if outline is None:
            pen.ellipse(at.disc(centre, radius), fill=255)
        else:
            pen.polygon(at(outline), fill=255)

    def mark(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
        pen.polygon(at(nose), fill=255)

    paint.stamp(image, box, [centre], radius + 1, colour, body)
    paint.stamp(image, box, [centre], radius + 1, style.PAGE, mark)
