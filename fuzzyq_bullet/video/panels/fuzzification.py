"""Panel 2: what the distances mean to the fuzzy controller: its sets, and where the values lie."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageDraw

from fuzzyq_bullet.planning.controllers import controller_shown
from fuzzyq_bullet.video import paint, style
from fuzzyq_bullet.video.explanation import aim_name, is_clear
from fuzzyq_bullet.video.panels.base import Canvas
from fuzzyq_bullet.video.style import FUZZIFICATION
from fuzzyq_bullet.video.timeline import NO_DECISION, Moment

if TYPE_CHECKING:
    from fuzzyq_bullet.fuzzy.sets import Variable
    from fuzzyq_bullet.recording.trajectory import Trajectory
    from fuzzyq_bullet.video.map.footprints import Floats

_PLOT_HEIGHT = 46
_LEFT = 14
_WIDTH = FUZZIFICATION.width - 2 * _LEFT
_LEVELS = 24
"""Steps in which a membership lights its set."""
_DIMMED = [[round(v * 0.8 * level / _LEVELS) for v in range(256)] for level in range(_LEVELS + 1)]


class Sets:
    """The sets of one variable as a plot with the current value marked.

    Args:
        variable: Whose sets.
        top: Upper edge in the card (pixels).
        mirrored: Whether greater values are drawn further left: where Df is greater, more room is
            on the left.
    """

    def __init__(self, variable: Variable, top: int, *, mirrored: bool) -> None:
        self._variable = variable
        self._words = [one.meaning for one in variable.sets]
        self._box = (_LEFT, top + 22, _LEFT + _WIDTH, top + 22 + _PLOT_HEIGHT)
        self._top = top
        self._mirrored = mirrored
        x = np.linspace(*variable.domain, 121)
        curves = variable.memberships(x)
        self._areas, self._curves = [], []
        for curve in curves:
            points = np.array(
                [self._at(a, b) for a, b in zip(x.tolist(), curve.tolist(), strict=True)]
            )
            ends = [(points[-1, 0], self._box[3]), (points[0, 0], self._box[3])]
            self._areas.append(_drawn(self._box, np.concatenate([points, ends]), fill=True))
            self._curves.append(_drawn(self._box, points, fill=False))
        self._dot = paint.mask(
            (0, 0, 12, 12), lambda pen, at: pen.ellipse(at.disc((6, 6), 5.0), 255)
        )
        self.top = top
        self._shown: tuple[object, ...] | None = None
        blank = Image.new("RGB", (FUZZIFICATION.width, 88), style.CARD)
        for curve_mask in self._curves:
            blank.paste(style.FAINT, self._inside(*self._box[:2]), curve_mask)
        base = self._box[3] - top
        ImageDraw.Draw(blank).line((self._box[0], base, self._box[2], base), style.FAINT)
        self._blank = blank

    def _inside(self, x: float, y: float) -> tuple[int, int]:
        """Return a point of the card as one of this plot's part of it."""
        return round(x), round(y) - self._top

    def _at(self, value: float, membership: float) -> tuple[float, float]:
        low, high = self._variable.domain
        part = (self._variable.clip(value) - low) / (high - low)
        if self._mirrored:
            part = 1.0 - part
        return (
            self._box[0] + part * (self._box[2] - self._box[0]),
            self._box[3] - 1 - membership * (self._box[3] - self._box[1] - 4),
        )

    def draw(
        self, name: str, value: float, memberships: Floats, said: str = ""
    ) -> Image.Image | None:
        """Return the plot with value and memberships marked, None if it looks as last time.

        Args:
            name: What the variable is called in plain words.
            value: The value.
            memberships: What it belongs to, and how much.
            said: What to call it instead of what it belongs to most.
        """
        known = math.isfinite(value) and bool(np.isfinite(memberships).all())
        # Finer differences cannot be seen.
        levels = [
            round(one * _LEVELS) for one in np.clip(np.nan_to_num(memberships), 0, 1).tolist()
        ]
        x = round(self._at(value, 0.0)[0]) if known else None
        strongest = int(np.argmax(memberships)) if known else -1
        room = _WIDTH - style.text_width(name, 17) - 10
        text, size = style.fitting(
            (said or self._words[strongest]) if known else "–", room, (17, 15), bold=True
        )
        if (name, x, text, *levels) == self._shown:
            return None
        self._shown = (name, x, text, *levels)

        image = self._blank.copy()
        paint.write(image, (_LEFT, 16), name, style.MUTED, 17)
        origin = self._inside(*self._box[:2])
        for area, curve, level in zip(self._areas, self._curves, levels, strict=True):
            if level:
                image.paste(style.HEAT, origin, area.point(_DIMMED[level]))
                image.paste(style.mixed(style.FAINT, style.TEXT, level / _LEVELS), origin, curve)
        paint.write(image, (_LEFT + _WIDTH, 16), text, style.TEXT, size, bold=True, align="r")
        self._write_labels(image, levels, strongest)
        if x is not None:
            top, bottom = self._box[1] - self._top, self._box[3] - self._top
            ImageDraw.Draw(image).line((x, top - 2, x, bottom + 2), style.TEXT, 2)
            for level in levels:
                if level > 1:
                    _, y = self._inside(*self._at(value, level / _LEVELS))
                    image.paste(style.TEXT, (x - 6, y - 6), self._dot)
        return image

    def _write_labels(self, image: Image.Image, levels: list[int], strongest: int) -> None:
        """Write the labels below their sets; where they would overlap, the strongest wins."""
        taken: list[tuple[float, float]] = []
        numbers = sorted(range(len(levels)), key=lambda number: number != strongest)
        for number in numbers:
            one = self._variable.sets[number]
            x, _ = self._at(one.center, 0.0)
            bold = number == strongest
            half = style.text_width(one.label, 15, bold) / 2
            x = min(max(x, self._box[0] + half), self._box[2] - half)
            if any(x - half < right and left < x + half for left, right in taken):
                continue
            taken.append((x - half - 4, x + half + 4))
            colour = style.mixed(style.FAINT, style.TEXT, levels[number] / _LEVELS)
            y = self._box[3] - self._top + 16
            paint.write(image, (x, y), one.label, colour, 15, bold=bold, align="m")


class Fuzzification:
    """Panel 2 of one run."""

    def __init__(self, trajectory: Trajectory, canvas: Canvas) -> None:
        self._canvas = canvas
        self._trajectory, self._decisions = trajectory, trajectory.decisions
        base = controller_shown(trajectory.scenario.planner).base
        self._near = Sets(base.row, 28, mirrored=False)
        self._side = Sets(base.column, 120, mirrored=True)
        self._blank = np.full(len(base.row.sets), np.nan), np.full(len(base.column.sets), np.nan)
        self._decision: int | None = None

    def draw(self, moment: Moment) -> None:
        """Mark where the values of the decision shown lie."""
        decision = moment.shown
        if decision == self._decision:
            return
        self._decision = decision
        d = self._decisions
        if decision == NO_DECISION:
            near = self._near.draw("to the goal:", math.nan, self._blank[0])
            side = self._side.draw("sides:", math.nan, self._blank[1])
        else:
            # With a clear way to its aim the planner takes Df as 0, whatever it measures aside.
            said = ("way is clear", "taken as alike") if is_clear(d, decision) else ("", "")
            name, df = aim_name(self._trajectory, decision), float(d.difference[decision])
            name = name.partition(" of ")[0]  # of via points the number alone; there is no room
            near = self._near.draw(
                f"to {name}:", float(d.distance[decision]), d.near[decision], said[0]
            )
            side = self._side.draw("sides:", df, d.side[decision], said[1])
        for plot, image in ((self._near, near), (self._side, side)):
            if image is not None:
                self._canvas.paste(image, (0, plot.top))


def _drawn(box: paint.Box, points: Floats, *, fill: bool) -> Image.Image:
    def draw(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
        if fill:
            pen.polygon(at(points), fill=255)
        else:
            pen.line(at(points), 255, round(1.6 * at.factor), joint="curve")

    return paint.mask(box, draw)
