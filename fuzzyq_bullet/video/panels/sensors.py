"""Panel 1: what the robot senses. A close-up in which its nose points up, so left is left."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageDraw

from fuzzyq_bullet.video import paint, style
from fuzzyq_bullet.video.asked import metres
from fuzzyq_bullet.video.explanation import aim_name, is_clear
from fuzzyq_bullet.video.map.footprints import Floats, arrow, circle, clipped, corners_for, corridor
from fuzzyq_bullet.video.movers import DrawnMovers
from fuzzyq_bullet.video.panels.base import Canvas, register_panel
from fuzzyq_bullet.video.scene.meshes import walls_of
from fuzzyq_bullet.video.timeline import NO_DECISION, Moment, Sensed, sensed_at, sensor_range

if TYPE_CHECKING:
    from collections.abc import Callable

    from fuzzyq_bullet.recording.trajectory import Trajectory

_LENS: paint.Box = (8, 28, 182, 202)
_DIAMETER = _LENS[2] - _LENS[0]
_FACTOR = 2
_COLUMN: paint.Box = (192, 26, 314, 208)
_ROW = 38
_NO_LINES = ("This planner", "casts no", "detection lines.")
_MOST = 400
"""Obstacles drawn in the close-up at most: the nearest."""
_LARGE = 50.0
"""An outline that reaches farther (m) is cut before it is drawn: Pillow has its limits."""


@register_panel("sensors", title="1  SENSES", place="sensors")
class Sensors:
    """Panel 1 of one run."""

    def __init__(self, trajectory: Trajectory, canvas: Canvas) -> None:
        self._canvas = canvas
        self._trajectory = trajectory
        self._decisions = trajectory.decisions
        self._radius = trajectory.scenario.robot.radius
        self._range = sensor_range(trajectory)
        self._view = self._range + self._radius + 0.1
        self._scale = _DIAMETER * _FACTOR / 2 / self._view
        scenario = trajectory.scenario
        self._obstacles = scenario.standing
        self._outlines: dict[int, Floats] = {}
        self._centres = np.array([o.position for o in self._obstacles]).reshape(-1, 2)
        self._extents = np.array([o.extent() for o in self._obstacles])
        self._movers = DrawnMovers(trajectory, lambda one: corners_for(one.extent() * self._scale))
        everywhere = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]) * 1e4
        self._walls = walls_of(scenario, everywhere)
        self._round = paint.mask(
            (0, 0, _DIAMETER, _DIAMETER),
            lambda pen, at: pen.ellipse((0, 0, _DIAMETER * at.factor, _DIAMETER * at.factor), 255),
        )
        self._decision: int | None = None

    def draw(self, moment: Moment) -> None:
        """Draw the instant of the decision shown: what its numbers were measured at."""
        decision = moment.shown
        if decision == self._decision:
            return
        self._decision = decision
        column = self._canvas.blank(_COLUMN)
        self._write_numbers(column, decision)
        self._canvas.paste(column, _COLUMN[:2])
        view = Image.new("RGB", (_DIAMETER, _DIAMETER), style.CARD)
        view.paste(self._close_up(decision).reduce(_FACTOR), mask=self._round)
        self._canvas.paste(view, _LENS[:2])

    def _close_up(self, decision: int) -> Image.Image:
        sensed: Sensed | None = sensed_at(self._trajectory, decision)
        tick = 0 if decision == NO_DECISION else int(self._decisions.tick[decision])
        here = self._trajectory.ticks.position[tick]
        facing = float(self._trajectory.ticks.heading[tick])
        side = _DIAMETER * _FACTOR
        image = Image.new("RGB", (side, side), style.GROUND)
        pen = ImageDraw.Draw(image, "RGBA")
        # The robot's nose, its x axis, points up in the picture, its left to the left.
        cos, sin = math.cos(facing), math.sin(facing)
        turn = np.array([(sin, -cos), (-cos, -sin)]) * self._scale

        def at(points: Floats) -> list[tuple[float, float]]:
            moved = (points - here) @ turn.T + side / 2
            return [(x, y) for x, y in moved.tolist()]

        corner = self._view * 1.5
        near = here + np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * corner
        gaps = np.hypot(*(self._centres - here).T) - self._extents
        seen = np.flatnonzero(gaps < self._view)
        if len(seen) > _MOST:
            seen = seen[np.argsort(gaps[seen])[:_MOST]]
        for index in seen.tolist():
            _fill(pen, at, self._outline(index), near, style.OBSTACLE)
        for mover in self._movers.at(float(self._trajectory.ticks.time[tick]), tick):
            _fill(pen, at, mover.outline, near, style.MOVER)
        for wall in self._walls:
            _fill(pen, at, wall, near, style.WALL)

        if sensed is not None and not sensed.lines:
            seen_to = circle((float(here[0]), float(here[1])), self._radius + self._range)
            pen.line(at(np.asarray(seen_to)), style.FAINT, 2 * _FACTOR)
        if sensed is not None:
            for (heading, length), colour in zip(sensed.lines, style.LINES, strict=False):
                if length < self._range:  # as far as it could see, were nothing there
                    whole = corridor(sensed.origin, heading, self._range, sensed.radius)
                    pen.line(at(whole), (*colour, 90), 2)
            for free, colour in zip(sensed.corridors, style.LINES, strict=False):
                outline = at(free)
                pen.polygon(outline, fill=(*colour, 90))
                pen.line(outline, colour, 3 * _FACTOR // 2)
            way = np.array((math.cos(sensed.heading), math.sin(sensed.heading)))
            tip = here + way * (self._radius + 0.32)
            pen.line(at(np.stack([here, tip])), style.TEXT, 3 * _FACTOR)
            pen.polygon(at(arrow((tip[0], tip[1]), sensed.heading, 0.2)), fill=style.TEXT)
            if sensed.aim is not None:
                _mark_aim(pen, np.reshape(at(np.array([sensed.aim])), 2), side / 2)
        model = self._trajectory.scenario.robot.spec
        x, y = here.tolist()
        pen.polygon(at(np.array(model.footprint_at(x, y, facing))), fill=style.ROBOT)
        size = self._radius * self._scale * (1.5 if model.is_disc else 0.75)
        nose = arrow((side / 2, side / 2), -math.pi / 2, size)
        pen.polygon([(x, y) for x, y in nose.tolist()], fill=style.PAGE)
        return image

    def _outline(self, index: int) -> Floats:
        if index not in self._outlines:
            corners = corners_for(float(self._extents[index]) * self._scale)
            self._outlines[index] = self._obstacles[index].outline(corners)
        return self._outlines[index]

    def _write_numbers(self, image: Image.Image, index: int) -> None:
        if not np.isfinite(self._decisions.lengths).any():
            self._write_heading(image, index)
            return
        lengths = (
            [math.nan] * 3 if index == NO_DECISION else self._decisions.lengths[index].tolist()
        )
        pen = ImageDraw.Draw(image)
        towards = "the goal" if index == NO_DECISION else aim_name(self._trajectory, index)
        towards = towards.partition(" of ")[0]  # of via points the number alone; there is no room
        names = ("left", f"to {towards}", "right")
        for row, (name, colour, length) in enumerate(zip(names, style.LINES, lengths, strict=True)):
            top = 2 + _ROW * row
            pen.rectangle((0, top, 5, top + 33), colour)
            label, size = style.fitting(name, image.width - 16, (16, 15, 14))
            paint.write(image, (14, top + 12), label, style.MUTED, size)
            free = math.isfinite(length) and length >= self._range - 1e-9
            value = f"{'> ' if free else ''}{length:.2f} m" if math.isfinite(length) else "–"
            value, size = style.fitting(value, image.width - 16, (22, 21, 20), bold=True)
            paint.write(image, (14, top + 33), value, style.TEXT, size, bold=True)
        top = 2 + _ROW * 3
        paint.write(image, (14, top + 12), "left − right", style.MUTED, 16)
        difference = math.nan if index == NO_DECISION else float(self._decisions.difference[index])
        value, told = "–", ""
        if math.isfinite(lengths[0] - lengths[2]):
            value = f"{lengths[0] - lengths[2] + 0.0:+.2f} m"
        if math.isfinite(difference):
            # A planner with a clear way takes Df as 0, whatever it measures at its sides.
            clear = is_clear(self._decisions, index)
            told = "taken as 0" if clear else f"Df {difference + 0.0:+.1f}"
        for down, text, size in ((34, value, 21), (57, told, 21)):
            text, size = style.fitting(text.replace("-", "−"), 108, (size, 19, 17), bold=True)
            paint.write(image, (14, top + down), text, style.TEXT, size, bold=True)

    def _write_heading(self, image: Image.Image, index: int) -> None:
        """Write where a planner without lines heads, seen from its nose, and how far it sees."""
        rows = [("sees up to", metres(self._range))]
        if index != NO_DECISION:
            tick = int(self._decisions.tick[index])
            facing = float(self._trajectory.ticks.heading[tick])
            turn = math.remainder(float(self._decisions.heading[index]) - facing, math.tau)
            degrees = round(math.degrees(abs(turn)))
            told = "ahead" if degrees < 1 else f"{degrees}° {'left' if turn > 0 else 'right'}"
            rows.insert(0, ("arrow: heading", told))
        for row, (name, value) in enumerate(rows):
            top = 10 + 48 * row
            name, size = style.fitting(name, image.width - 6, (16, 15, 14))
            paint.write(image, (4, top + 12), name, style.MUTED, size)
            value, size = style.fitting(value, image.width - 6, (22, 20, 18), bold=True)
            paint.write(image, (4, top + 35), value, style.TEXT, size, bold=True)
        for row, words in enumerate(_NO_LINES):
            words, size = style.fitting(words, image.width - 6, (15, 14, 13))
            paint.write(image, (4, 128 + 20 * row), words, style.MUTED, size)


def _mark_aim(pen: ImageDraw.ImageDraw, aim: Floats, middle: float) -> None:
    """Mark the aim, at the rim in its direction if it lies beyond; pixels of the close-up."""
    away = aim - middle
    length, most = float(np.hypot(*away)), middle - 10 * _FACTOR
    x, y = (middle + away * min(1.0, most / max(length, 1e-9))).tolist()
    for colour, width in ((style.PAGE, 5 * _FACTOR), (style.AIM, 3 * _FACTOR)):
        for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            near, far = 3 * _FACTOR, 7 * _FACTOR
            ends = (x + dx * near, y + dy * near, x + dx * far, y + dy * far)
            pen.line(ends, colour, width)


def _fill(
    pen: ImageDraw.ImageDraw,
    at: Callable[[Floats], list[tuple[float, float]]],
    outline: Floats,
    near: Floats,
    colour: style.Colour,
) -> None:
    if np.abs(outline - near[0]).max() > _LARGE:
        outline = clipped(outline, near)
    if len(outline) >= 3:
        pen.polygon(at(outline), fill=colour)
