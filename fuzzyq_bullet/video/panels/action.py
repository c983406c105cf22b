"""Panel 4: what the robot is asked for, and what it does: speed, room around, weights in force."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageDraw

from fuzzyq_bullet.video import paint, style
from fuzzyq_bullet.video.asked import asks, metres, nearest, turning
from fuzzyq_bullet.video.explanation import aim_name, off_aim, target_of
from fuzzyq_bullet.video.panels.base import Canvas, register_panel
from fuzzyq_bullet.video.style import ACTION
from fuzzyq_bullet.video.timeline import NO_DECISION, Moment, jumps

if TYPE_CHECKING:
    from fuzzyq_bullet.recording.trajectory import Trajectory

_DIAL = (108, 108)
_RADIUS = 72
_FACTS = 226
_ROW = 44
_DECIDED: paint.Box = (6, 26, _FACTS - 4, ACTION.height - 6)
_ASKED = (182, 202)
"""Baselines of the two lines that say what is asked for (pixels)."""
_WEIGHTS = ("ω1", "ω2", "c_f")
_SIZES = (24, 22, 20, 18, 16)
_WEIGHT_AT = (0, 46, 102)
"""Where the columns of the weights begin (pixels)."""
_WIDEST = math.radians(100.0)
"""A turn beyond this leaves the dial's needle at its end."""


@register_panel("action", title="4  ACTS", place="action")
class Action:
    """Panel 4 of one run."""

    def __init__(self, trajectory: Trajectory, canvas: Canvas) -> None:
        self._canvas = canvas
        self._trajectory = trajectory
        self._decisions = trajectory.decisions
        self._weighted = bool(np.isfinite(trajectory.decisions.weights).any())
        self._goal = trajectory.scenario.goal.position
        card = canvas.image
        card.paste(style.LINE, mask=paint.mask((0, 0, *ACTION.size), _dial_face))
        self._jumps = jumps(trajectory)
        last = "" if self._weighted else ("turned" if self._jumps else "turning")
        far = "to next target" if trajectory.scenario.via else "distance to goal"
        names = ("last step" if self._jumps else "speed", far, nearest(trajectory), last)
        for row, name in enumerate(names):
            paint.write(card, (_FACTS, 40 + _ROW * row), name, style.MUTED, 16)
        if self._weighted:
            for x, name in zip(_WEIGHT_AT, _WEIGHTS, strict=True):
                paint.write(card, (_FACTS + x, 40 + _ROW * 3), name, style.MUTED, 16)
        self._undecided = card.crop(_DECIDED)
        self._shown: list[object] = [None] * 5

    def draw(self, moment: Moment) -> None:
        """Draw what is, and what the decision shown wants."""
        index = moment.shown
        turn = math.nan
        asked: tuple[tuple[str, str], ...] = ()
        name = ""
        if index != NO_DECISION:
            asked = asks(self._trajectory, index)
            turn = math.radians(round(math.degrees(off_aim(self._trajectory, index))))
            name = aim_name(self._trajectory, index)
        target = self._goal if index == NO_DECISION else target_of(self._trajectory, index)[1]
        away = math.dist(moment.position, target)
        facts = (
            self._driven(moment),
            f"{away:.2f} m" if away < 100 else f"{away:.0f} m",
            metres(moment.clearance) if math.isfinite(moment.clearance) else "far away",
            self._last_row(index, moment.tick),
        )
        if moment.over and self._trajectory.outcome == "goal":
            name, asked = "", ()
        decided = (turn, asked, name) if math.isfinite(turn) else None
        before, self._shown = self._shown, [*facts, decided]
        for row, (fact, old) in enumerate(zip(facts, before, strict=False)):
            if fact != old:
                self._draw_fact(row, fact)
        if decided is not None and decided != before[-1]:
            image = self._undecided.copy()
            _draw_turn(image, _DECIDED, turn, name)
            _write_asked(image, _DECIDED, asked)
            self._canvas.paste(image, _DECIDED[:2])

    def _driven(self, moment: Moment) -> str:
        """Return how fast the robot drives; of one that jumps, how far it last jumped."""
        if not self._jumps:
            return f"{abs(moment.speed):.2f} m/s"
        positions = self._trajectory.ticks.position
        return metres(math.dist(positions[max(moment.tick - 1, 0)], positions[moment.tick]))

    def _last_row(self, index: int, tick: int) -> str | tuple[str, ...]:
        """Return the weights in force and c_f; without weights, how the robot turns."""
        if not self._weighted and self._jumps:
            now, before = self._trajectory.ticks.heading[[tick, max(tick - 1, 0)]].tolist()
            return _turned(math.remainder(now - before, math.tau), "straight on")
        if not self._weighted:
            return turning(float(self._trajectory.ticks.turn_rate[tick]))
        if index == NO_DECISION:
            return ("–",) * 3
        d = self._decisions
        numbers = (*d.weights[index].tolist(), float(d.breakout_at[index]))
        return tuple(map(_weight, numbers))

    def _draw_fact(self, row: int, fact: str | tuple[str, ...]) -> None:
        top = 46 + _ROW * row
        image = Image.new("RGB", (ACTION.width - _FACTS - 4, 22), style.CARD)
        parts = [(0, image.width, fact)] if isinstance(fact, str) else _columns(fact, image.width)
        size = min(style.fitting(one, width, _SIZES, bold=True)[1] for _, width, one in parts)
        for x, width, part in parts:
            text, _ = style.fitting(part, width, (size,), bold=True)
            paint.write(image, (x, 64 + _ROW * row - top), text, style.TEXT, size, bold=True)
        self._canvas.paste(image, (_FACTS, top))


def _write_asked(image: Image.Image, box: paint.Box, asked: tuple[tuple[str, str], ...]) -> None:
    for (name, value), y in zip(asked, _ASKED, strict=False):
        paint.write(image, (12 - box[0], y - box[1]), name, style.MUTED, 16)
        room = _FACTS - 30 - style.text_width(name, 16)
        text, size = style.fitting(value, room, (19, 17, 15), bold=True)
        right = (_FACTS - 12 - box[0], y - box[1])
        paint.write(image, right, text, style.TEXT, size, bold=True, align="r")


def _weight(number: float) -> str:
    """Return a weight in at most four signs: those of rules that fire a little have many digits."""
    if not math.isfinite(number):
        return "–"
    return f"{round(number, 1 if number >= 10.0 else 2):g}"


def _columns(facts: tuple[str, ...], width: int) -> list[tuple[int, int, str]]:
    """Return where each of the weights begins (pixels), how wide it may be, and what it says."""
    rights = (*(x - 4 for x in _WEIGHT_AT[1:]), width)
    return [(x, right - x, fact) for x, right, fact in zip(_WEIGHT_AT, rights, facts, strict=True)]


def _draw_turn(image: Image.Image, box: paint.Box, turn: float, name: str) -> None:
    """Draw the needle; without the name of an aim the robot has arrived, and there is none."""
    shown = min(max(turn, -_WIDEST), _WIDEST)
    x, y = _DIAL
    if not name:
        at = (x - box[0], 142 - box[1])
        paint.write(image, at, "in the goal", style.TEXT, 24, bold=True, align="m")
        return
    around = [(x - _RADIUS, y - _RADIUS), (x + _RADIUS, y + 12)]

    def sweep(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
        up, end = -90.0, -90.0 - math.degrees(shown)
        corners = at.disc(_DIAL, _RADIUS)
        pen.arc(corners[0] + corners[1], min(up, end), max(up, end), 255, 9 * at.factor)

    def needle(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
        way = np.array((-math.sin(shown), -math.cos(shown)))
        aside = np.array((way[1], -way[0]))
        tip = _DIAL + way * (_RADIUS - 14)
        pen.polygon(at(np.stack([tip, _DIAL + aside * 5, _DIAL - aside * 5])), fill=255)
        pen.ellipse(at.disc(_DIAL, 8), fill=255)

    paint.stamp(image, box, around, 4, style.LEFT if turn > 0 else style.RIGHT, sweep)
    paint.stamp(image, box, around, 4, style.TEXT, needle)
    text = _turned(turn, "straight")
    paint.write(image, (x - box[0], 142 - box[1]), text, style.TEXT, 24, bold=True, align="m")
    below, of = (x - box[0], 161 - box[1]), "to" if text == "straight" else "of"
    paint.write(image, below, f"{of} {name}", style.MUTED, 16, align="m")


def _turned(turn: float, straight: str) -> str:
    """Return an angle (rad) in words, ``straight`` if it is none."""
    degrees = round(math.degrees(abs(turn)))
    return straight if degrees < 1 else f"{degrees}° {'left' if turn > 0 else 'right'}"


def _dial_face(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
    corners = at.disc(_DIAL, _RADIUS)
    pen.arc(corners[0] + corners[1], 180, 360, 255, 9 * at.factor)
    for degrees in (-90, -45, 0, 45, 90):
        way = np.array((math.sin(math.radians(degrees)), -math.cos(math.radians(degrees))))
        ends = np.stack([_DIAL + way * (_RADIUS - 16), _DIAL + way * (_RADIUS - 11)])
        pen.line(at(ends), 255, 2 * at.factor)
