"""The 3-D view: the still world once a shot, and in every frame the robot and what it senses."""

from __future__ import annotations

import math
from contextlib import ExitStack
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike
from PIL import Image, ImageChops, ImageDraw

from fuzzyq_bullet.physics.camera import Lens, Mesh, Picture, RobotCamera
from fuzzyq_bullet.video import paint, style
from fuzzyq_bullet.video.map.footprints import circle, pointer
from fuzzyq_bullet.video.map.trail import Trail
from fuzzyq_bullet.video.marks import cross, diamond, grid_step, reticle
from fuzzyq_bullet.video.paint import DirtyRegion
from fuzzyq_bullet.video.scene import meshes
from fuzzyq_bullet.video.scene.cameras import Camera, FixedCamera
from fuzzyq_bullet.video.scene.shots import SPAN, Shot
from fuzzyq_bullet.video.scene.solid_movers import DETAIL, SolidMovers, lay_pixels, put_back
from fuzzyq_bullet.video.scene.still import photograph
from fuzzyq_bullet.video.scene.viewpoint import extent_of
from fuzzyq_bullet.video.style import SCENE, Rect
from fuzzyq_bullet.video.timeline import Sensed, Steady

if TYPE_CHECKING:
    from fuzzyq_bullet.recording.trajectory import Trajectory
    from fuzzyq_bullet.video.map.footprints import Floats
    from fuzzyq_bullet.video.timeline import Moment

_FILL, _EDGE = 88, 235
_SHADOW = 1.125
"""How many times larger than the robot its shadow is."""
_CAST = (0.06, 0.09)
"""How far the shadow of a moving obstacle lies from it (m)."""
_SMALLEST = 26.0
"""A robot that covers fewer points than this gets a ring around it."""


class Scene:
    """The 3-D view of one run.

    Args:
        trajectory: The run.
        rect: Where it lies in the frame (pixels).
        unit: Pixels a point; see ``Layout``.
        camera: Films it; by default one that stands still as long as it can.
        framed: Whether it is a card with round corners.

    Attributes:
        lens: What the camera sees in this shot; its picture is ``rect``, or larger.
    """

    def __init__(
        self,
        trajectory: Trajectory,
        rect: Rect = SCENE,
        unit: float = 1.0,
        *,
        camera: Camera | None = None,
        framed: bool = True,
    ) -> None:
        self._trajectory, self._rect, self._unit, self._framed = trajectory, rect, unit, framed
        self._camera = camera or FixedCamera(trajectory, rect.size)
        self._open = ExitStack()
        self._cut_to(0)

    def close(self) -> None:
        """Free the robot's renderer."""
        self._open.close()

    def _cut_to(self, number: int) -> None:
        """Begin a shot: another lens, the still world as it sees it, and the way so far."""
        self._open.close()
        trajectory, self._shot = self._trajectory, number
        self.lens = lens = self._camera.lens(number)
        picture, ground = _still(trajectory, self._camera.shots[number], lens)
        self._depth = picture.depth
        self._ground = ground
        still = _decorated(picture, ground, trajectory, lens, self._unit)
        if self._framed:
            corners = paint.mask((0, 0, *lens.size), paint.rounded(lens.size, 9.0 * self._unit))
            still = Image.composite(still, Image.new("RGB", lens.size, style.PAGE), corners)
        positions = trajectory.ticks.position
        self._trail = Trail(still, positions, self._seen, ground, self._unit)
        self._sensed: Sensed | None = None
        self._aim: tuple[float, float] | None = None
        self._passed = 0
        away = math.dist(lens.eye, lens.target)
        self._steady = Steady(lens.pixels_per_radian() / away)
        self._stains: list[tuple[style.Colour, paint.Layer]] = []
        self._changed: paint.Box | None = (0, 0, *lens.size)
        self._window: paint.Box | None = None
        self._movers = SolidMovers(trajectory, lens)
        with ExitStack() as stack:
            self._robot = stack.enter_context(
                RobotCamera(lens, trajectory.scenario.robot.spec, DETAIL)
            )
            self._open = stack.pop_all()

    def draw(
        self, moment: Moment, sensed: Sensed | None, hit: tuple[float, float] | None = None
    ) -> DirtyRegion | None:
        """Return what changed since the last moment drawn; ``hit`` marks a collision (m)."""
        shot = self._camera.shots.at(moment.tick)
        if shot != self._shot:
            self._cut_to(shot)
        frame = self._camera.window(self.lens, moment)
        moved = self._steady.moved(moment) or frame != self._window or len(self._movers)
        if not moved and sensed is self._sensed:
            return None
        self._window = frame
        unit, size = self._unit, self.lens.size
        grown = paint.joined(
            [
                self._mark_passed(moment.tick),
                self._trail.follow(moment.tick),
                self._point_at(None if sensed is None else sensed.aim),
            ]
        )
        if sensed is not self._sensed:
            self._sensed = sensed
            self._stains = self._stained(sensed)
        shadow = self._stain(self._shadow(moment), edge=0, fill=150)
        target = None
        if sensed is not None and sensed.target is not None:
            target = self._seen([sensed.target])[0]
        window = self._robot.window(moment.position)
        movers = self._movers.at(moment)
        shadows = [self._stain(one.outline + _CAST, edge=0, fill=140) for one in movers]

        parts: list[paint.Box | None] = [layer.box for _, layer in self._stains]
        if shadow is not None:
            parts.append(shadow.box)
        parts += [one.box for one in shadows if one is not None]
        parts += [one.window for one in movers]
        if window is not None:
            parts.append(paint.box_around(np.reshape(window, (2, 2)), 16 * unit, size))
        if target is not None:
            parts.append(paint.box_around(target, 14 * unit, size))
        if hit is not None:
            parts.append(paint.box_around(self._seen([hit]), 20 * unit, size))
        now = paint.joined(parts)
        box = paint.joined([now, self._changed, grown])
        self._changed = now
        if frame != (0, 0, *size):  # a part of the picture, all of which moves
            box = frame
        if box is None:
            return None

        image = self._trail.image.crop(box)
        for colour, layer in self._stains:
            layer.lay(image, box, colour)
        for one in (*shadows, shadow):
            if one is not None:
                one.lay(image, box, style.SHADOW)
        if target is not None:
            diamond(image, box, target, 9.0, unit)
        before = list(self._movers.lay(image, box, movers, self._depth))
        if window is not None:
            self._place_robot(image, box, window, moment)
        put_back(self._depth, before)
        if hit is not None:
            cross(image, box, self._seen([hit])[0], 11.0, unit)
        left, top = box[0] - frame[0], box[1] - frame[1]
        return DirtyRegion(self._rect.x + left, self._rect.y + top, image)

    def height_of(self, position: tuple[float, float]) -> float:
        """Return how far down a point of the ground (m) is seen, as a part of the frame's height.

        Before the first moment is drawn, of all that the lens sees.
        """
        _, top, _, bottom = self._window or (0, 0, *self.lens.size)
        return float(np.nan_to_num(self._seen([position])[0, 1]) - top) / (bottom - top)

    def _mark_passed(self, tick: int) -> paint.Box | None:
        """Fill the rings of the via points that were passed by a tick."""
        before, self._passed = self._passed, int(self._trajectory.via_passed[tick])
        via = self._trajectory.scenario.via[before : self._passed]
        layers = [self._stain(circle(one.position, one.radius), edge=0, fill=110) for one in via]
        filled = [(style.GOAL, layer) for layer in layers if layer is not None]
        return self._trail.lay_above(filled) if filled else None

    def _point_at(self, aim: tuple[float, float] | None) -> paint.Box | None:
        """Mark the aim (m)."""
        if aim == self._aim:
            return None
        self._aim = aim
        if aim is None:
            return self._trail.pin([])
        return self._trail.pin(reticle(self._seen([aim])[0], self.lens.size, unit=self._unit))

    def _seen(self, points: ArrayLike) -> Floats:
        flat = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        return self.lens.project(np.column_stack([flat, np.zeros(len(flat))]))

    def _stained(self, sensed: Sensed | None) -> list[tuple[style.Colour, paint.Layer]]:
        """Return the detection corridors as they lie on the ground, with their colours."""
        if sensed is None:
            return []
        layers = [self._stain(one, edge=_EDGE, fill=_FILL) for one in sensed.corridors]
        coloured = zip(style.LINES, layers, strict=False)
        return [(colour, layer) for colour, layer in coloured if layer is not None]

    def _shadow(self, moment: Moment) -> Floats:
        """Return the outline (m) of the robot's shadow."""
        footprint = np.array(self._trajectory.scenario.robot.spec.footprint) * _SHADOW
        cos, sin = math.cos(moment.heading), math.sin(moment.heading)
        return np.asarray(footprint @ np.array([(cos, sin), (-sin, cos)]) + moment.position)

    def _stain(self, outline: ArrayLike, *, edge: int, fill: int) -> paint.Layer | None:
        """Return a piece of the ground (m) as a layer that covers nothing but ground."""
        seen = self._seen(outline)

        def draw(pen: ImageDraw.ImageDraw, scaled: paint.Scaled) -> None:
            points = scaled(seen)
            if len(points) >= 3:
                pen.polygon(points, fill=fill)
                if edge:
                    pen.line([*points, points[0]], edge, round(1.7 * self._unit * scaled.factor))

        size, margin = self.lens.size, 3 * self._unit
        return paint.layer(seen, margin, size, draw, self._ground, paint.SWIFT)

    def _place_robot(
        self, image: Image.Image, box: paint.Box, window: paint.Box, moment: Moment
    ) -> None:
        """Put the robot into a part of the picture, behind whatever stands in front of it."""
        k = DETAIL
        left, top, right, bottom = window
        robot = self._robot.shoot(window, moment.position, moment.heading)
        behind = self._depth[top * k : bottom * k, left * k : right * k]
        visible = (robot.mask >= 0) & (robot.depth < behind)
        lay_pixels(image, box, window, robot.colour, visible)
        unit = self._unit
        if right - left < _SMALLEST * unit:
            centre = ((left + right) / 2, (top + bottom) / 2)

            def ring(pen: ImageDraw.ImageDraw, scaled: paint.Scaled) -> None:
                outer = scaled.disc(centre, _SMALLEST / 2 * unit)
                pen.ellipse(outer, outline=255, width=round(2 * unit * scaled.factor))

            paint.stamp(image, box, [centre], (_SMALLEST / 2 + 2) * unit, style.ROBOT, ring)


def still_meshes(trajectory: Trajectory, shot: Shot, lens: Lens) -> tuple[list[Mesh], bool]:
    """Return the surfaces of all that never moves, and whether the first of them is ground."""
    seen = meshes.ground_seen(lens)
    scenario = trajectory.scenario
    ground = meshes.ground_of(scenario, seen)
    low_x, low_y, high_x, high_y = extent_of(trajectory)
    span = max(high_x - low_x, high_y - low_y) if shot.whole else SPAN
    tall = max(min(0.9, 0.25 * span), 0.05 * span)
    return meshes.solids(
        ground,
        meshes.obstacles_seen(scenario, lens, seen),
        meshes.walls_of(scenario, seen),
        meshes.flag(scenario.goal.position, lens, tall),
    ), len(ground) >= 3


def _still(trajectory: Trajectory, shot: Shot, lens: Lens) -> tuple[Picture, Image.Image]:
    """Return the picture of all that never moves, and where it shows ground (mode L)."""
    surfaces, grounded = still_meshes(trajectory, shot, lens)
    picture = photograph(surfaces, lens, DETAIL)
    bare = (picture.mask == 0) & grounded
    return picture, Image.fromarray(np.where(bare, 255, 0).astype(np.uint8)).reduce(DETAIL)


def _decorated(
    picture: Picture, ground: Image.Image, trajectory: Trajectory, lens: Lens, unit: float
) -> Image.Image:
    """Return the still picture with what is painted on the ground: grid, shadows, start, goal."""
    colour = picture.colour.copy()
    colour[picture.mask < 0] = style.CARD
    image = Image.fromarray(colour).reduce(DETAIL)
    box = (0, 0, *lens.size)
    scenario = trajectory.scenario

    def seen(points: ArrayLike) -> Floats:
        flat = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        return lens.project(np.column_stack([flat, np.zeros(len(flat))]))

    def ring(centre: tuple[float, float], radius: float) -> Floats:
        return seen(circle(centre, radius))

    area = meshes.ground_seen(lens)
    floor = meshes.ground_of(scenario, area)
    floor = floor if len(floor) else area
    low, high = floor.min(axis=0), floor.max(axis=0)
    step = grid_step(float((high - low).max()))

    def grid(pen: ImageDraw.ImageDraw, scaled: paint.Scaled) -> None:
        for x in np.arange(np.ceil(low[0] / step), high[0] / step) * step:
            pen.line(scaled(seen([(x, low[1]), (x, high[1])])), 255, round(unit * scaled.factor))
        for y in np.arange(np.ceil(low[1] / step), high[1] / step) * step:
            pen.line(scaled(seen([(low[0], y), (high[0], y)])), 255, round(unit * scaled.factor))

    def shadows(pen: ImageDraw.ImageDraw, scaled: paint.Scaled) -> None:
        for outline in meshes.obstacles_seen(scenario, lens, area):
            for part in np.linspace(0.0, 1.0, 4):
                pen.polygon(scaled(seen(outline + np.array((0.10, 0.14)) * part)), fill=140)

    def via(pen: ImageDraw.ImageDraw, scaled: paint.Scaled) -> None:
        for number, one in enumerate(scenario.via, 1):
            around = ring(one.position, one.radius)
            pen.line(scaled(around), 255, round(2 * unit * scaled.factor), joint="curve")
            font = style.font(round(15 * unit * scaled.factor), bold=True)
            low, high = around.min(axis=0), around.max(axis=0)  # the reticle may stand in it
            beside = (low + high) / 2 + 0.71 * ((high - low) / 2 + 11 * unit) * (1.0, -1.0)
            pen.text(scaled(beside)[0], str(number), 255, font, anchor="mm")

    def goal(pen: ImageDraw.ImageDraw, scaled: paint.Scaled) -> None:
        around = scaled(ring(scenario.goal.position, scenario.goal.radius))
        pen.polygon(around, fill=110)
        pen.line(around, 255, round(2 * unit * scaled.factor), joint="curve")
        if scenario.goal.heading is not None:
            long = 2.5 * scenario.goal.radius
            for part in pointer(scenario.goal.position, scenario.goal.heading, long):
                pen.polygon(scaled(seen(part)), fill=255)

    def start(pen: ImageDraw.ImageDraw, scaled: paint.Scaled) -> None:
        pose = (*scenario.start.position, scenario.start_heading())
        body = scenario.robot.spec.footprint_at(*pose)
        around = scaled(seen([*body, body[0]]))
        pen.line(around, 200, round(1.5 * unit * scaled.factor), joint="curve")

    for draw, tint in (
        (grid, style.GRID),
        (shadows, style.SHADOW),
        (start, style.FAINT),
        (via, style.GOAL),
        (goal, style.GOAL),
    ):
        image.paste(tint, mask=ImageChops.multiply(paint.mask(box, draw), ground))
    return image
