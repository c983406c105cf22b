"""Marks that mean the same in the scene and on the map."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fuzzyq_bullet.video import paint, style

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike
    from PIL import Image, ImageDraw


def diamond(
    image: Image.Image, box: paint.Box, at: ArrayLike, size: float, unit: float = 1.0
) -> None:
    """Mark the planner's temporary target in a part of a picture; ``unit`` is pixels a point."""
    size *= unit
    x, y = np.asarray(at, dtype=np.float64).tolist()
    shape = [(x, y - size), (x + size, y), (x, y + size), (x - size, y)]

    def draw(pen: ImageDraw.ImageDraw, scaled: paint.Scaled) -> None:
        pen.polygon(scaled(shape), fill=90)
        width = round(2 * unit * scaled.factor)
        pen.line(scaled([*shape, shape[0], shape[1]]), 255, width, joint="curve")

    paint.stamp(image, box, shape, 3 * unit, style.TARGET, draw)


def reticle(
    at: ArrayLike, size: tuple[int, int], reach: float = 13.0, unit: float = 1.0
) -> list[paint.Inked]:
    """Return the mark of the aim, in a picture of ``size``: four strokes about an open middle."""
    reach *= unit
    x, y = np.asarray(at, dtype=np.float64).tolist()
    strokes = [
        [(x + dx * part, y + dy * part) for part in (0.42 * reach, reach)]
        for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1))
    ]
    found = []
    for colour, width in ((style.PAGE, 6.0), (style.AIM, 3.0)):

        def draw(pen: ImageDraw.ImageDraw, scaled: paint.Scaled, width: float = width) -> None:
            for stroke in strokes:
                paint.polyline(pen, scaled(stroke), 255, width * unit * scaled.factor)

        drawn = paint.layer([(x, y)], reach + 4 * unit, size, draw)
        if drawn is not None:
            found.append((colour, drawn))
    return found


def began(at: ArrayLike, size: tuple[int, int], unit: float = 1.0) -> list[paint.Inked]:
    """Return the mark of the place where a way out began, in a picture of ``size``: a dot."""
    return _discs(at, size, unit, ((style.PAGE, 6.0, 0.0), (style.TARGET, 4.6, 0.0)))


def passed(at: ArrayLike, size: tuple[int, int], unit: float = 1.0) -> list[paint.Inked]:
    """Return the mark of a via point that was passed: a dot of the goal's colour."""
    return _discs(at, size, unit, ((style.PAGE, 11.0, 0.0), (style.GOAL, 9.6, 0.0)))


def left_off(at: ArrayLike, size: tuple[int, int], unit: float = 1.0) -> list[paint.Inked]:
    """Return the mark of the place where the routine part went on again: a ring."""
    rim = (style.PAGE, 8.4, 5.2)
    return _discs(at, size, unit, (rim, (style.TARGET, 7.2, 2.4)))


def _discs(
    at: ArrayLike,
    size: tuple[int, int],
    unit: float,
    discs: Sequence[tuple[style.Colour, float, float]],
) -> list[paint.Inked]:
    """Return discs as layers: colour, radius, and width of the ring if they are rings."""
    found = []
    for colour, radius, width in discs:

        def draw(
            pen: ImageDraw.ImageDraw,
            scaled: paint.Scaled,
            radius: float = radius * unit,
            width: float = width * unit,
        ) -> None:
            around = scaled.disc(at, radius)
            if width:
                pen.ellipse(around, outline=255, width=round(width * scaled.factor))
            else:
                pen.ellipse(around, fill=255)

        drawn = paint.layer(np.atleast_2d(at), radius * unit + 1, size, draw)
        if drawn is not None:
            found.append((colour, drawn))
    return found


def cross(
    image: Image.Image, box: paint.Box, at: ArrayLike, size: float, unit: float = 1.0
) -> None:
    """Mark the place of a collision in a part of a picture."""
    size *= unit
    centre = np.asarray(at, dtype=np.float64)
    x, y = centre.tolist()
    strokes = (
        [(x - size, y - size), (x + size, y + size)],
        [(x - size, y + size), (x + size, y - size)],
    )
    for colour, width in ((style.PAGE, 10.0), (style.TEXT, 7.5), (style.DANGER, 4.5)):
        width *= unit

        def draw(pen: ImageDraw.ImageDraw, scaled: paint.Scaled, width: float = width) -> None:
            for stroke in strokes:
                paint.polyline(pen, scaled(stroke), 255, width * scaled.factor)

        paint.stamp(image, box, centre, size + width, colour, draw)


def grid_step(span: float) -> float:
    """Return a round distance (m) between lines of which five to twenty fit in ``span`` (m)."""
    power = 10.0 ** math.floor(math.log10(max(span, 1e-3) / 10))
    return next(power * k for k in (1, 2, 5, 10) if power * k * 20 >= span)
