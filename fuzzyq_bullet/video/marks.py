"""Marks that mean the same in the scene and on the map."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fuzzyq_bullet.video import paint, style

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from PIL import Image, ImageDraw


def diamond(image: Image.Image, box: paint.Box, at: ArrayLike, size: float) -> None:
    """Mark the planner's temporary target in a part of a picture."""
    x, y = np.asarray(at, dtype=np.float64).tolist()
    shape = [(x, y - size), (x + size, y), (x, y + size), (x - size, y)]

    def draw(pen: ImageDraw.ImageDraw, scaled: paint.Scaled) -> None:
        pen.polygon(scaled(shape), fill=90)
        pen.line(scaled([*shape, shape[0], shape[1]]), 255, 2 * scaled.factor, joint="curve")

    paint.stamp(image, box, shape, 3, style.TARGET, draw)


def cross(image: Image.Image, box: paint.Box, at: ArrayLike, size: float) -> None:
    """Mark the place of a collision in a part of a picture."""
    centre = np.asarray(at, dtype=np.float64)
    x, y = centre.tolist()
    strokes = (
        [(x - size, y - size), (x + size, y + size)],
        [(x - size, y + size), (x + size, y - size)],
    )
    for colour, width in ((style.PAGE, 10.0), (style.TEXT, 7.5), (style.DANGER, 4.5)):

        def draw(pen: ImageDraw.ImageDraw, scaled: paint.Scaled, width: float = width) -> None:
            for stroke in strokes:
                paint.polyline(pen, scaled(stroke), 255, width * scaled.factor)

        paint.stamp(image, box, centre, size + width, colour, draw)


def grid_step(span: float) -> float:
    """Return a round distance (m) between lines of which five to twenty fit in ``span`` (m)."""
    power = 10.0 ** math.floor(math.log10(max(span, 1e-3) / 10))
    return next(power * k for k in (1, 2, 5, 10) if power * k * 20 >= span)
