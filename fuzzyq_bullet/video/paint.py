"""Smooth drawing with Pillow, which knows no smooth edges: draw larger, then shrink."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image, ImageChops, ImageDraw

from fuzzyq_bullet.video import style

if TYPE_CHECKING:
    from fuzzyq_bullet.video.style import Colour, Rect

Floats: TypeAlias = NDArray[np.float64]
Box: TypeAlias = tuple[int, int, int, int]
"""Left, top, right, bottom in pixels; right and bottom lie outside."""
Draw: TypeAlias = Callable[[ImageDraw.ImageDraw, "Scaled"], None]

SMOOTH = 3
"""How many times larger shapes are drawn that stay."""
SWIFT = 2
"""The same for those that move: good enough to the eye, and half the work."""
_SUPPORT = 6
"""How far a pixel reaches where a picture is enlarged (pixels)."""
_FAR = 20_000.0
"""Pillow draws nothing sensible beyond some tens of thousands of pixels."""


class DirtyRegion(NamedTuple):
    """A part of the frame that changed; place and size are even.

    Attributes:
        x: Left edge in the frame (pixels).
        y: Top edge.
        image: What is to be seen there now, RGB.
    """

    x: int
    y: int
    image: Image.Image


class Scaled:
    """Turns points of a picture into those of an enlarged part of it."""

    def __init__(self, left: float, top: float, factor: int) -> None:
        self._offset = np.array((left, top))
        self.factor = factor

    def __call__(self, points: ArrayLike) -> list[tuple[float, float]]:
        """Return points, shape (N, 2), as Pillow wants them; without those that are NaN."""
        moved = (np.asarray(points, dtype=np.float64).reshape(-1, 2) - self._offset) * self.factor
        # Pillow's pixel centres lie on whole numbers, ours in between.
        pairs = [(x - 0.5, y - 0.5) for x, y in moved.tolist()]
        if all(-_FAR < x < _FAR and -_FAR < y < _FAR for x, y in pairs):
            return pairs
        known = [(x, y) for x, y in pairs if math.isfinite(x + y)]
        return [(min(max(x, -_FAR), _FAR), min(max(y, -_FAR), _FAR)) for x, y in known]

    def disc(self, centre: ArrayLike, radius: float) -> list[tuple[float, float]]:
        """Return the box about a disc."""
        x, y = np.asarray(centre, dtype=np.float64).tolist()
        return self([(x - radius, y - radius), (x + radius, y + radius)])


class Layer(NamedTuple):
    """A shape drawn once, to be laid over a picture as often as need be.

    Attributes:
        box: Where in the picture.
        cover: How much of each pixel it covers (mode L).
    """

    box: Box
    cover: Image.Image

    def lay(self, image: Image.Image, box: Box, colour: Colour) -> None:
        """Put it in one colour into ``image``, which is the part ``box`` of the picture."""
        image.paste(colour, (self.box[0] - box[0], self.box[1] - box[1]), self.cover)


Inked: TypeAlias = "tuple[Colour, Layer]"
"""A layer and its colour."""


def layer(
    extent: ArrayLike,
    margin: float,
    size: tuple[int, int],
    draw: Draw,
    allowed: Image.Image | None = None,
    factor: int = SMOOTH,
) -> Layer | None:
    """Return a shape as a layer, None when it lies outside of the picture.

    Args:
        extent: Points of the picture that the shape lies between, shape (N, 2).
        margin: By how much it may reach beyond them (pixels).
        size: Size of the picture (pixels).
        draw: Draws it.
        allowed: Where in the picture it may be seen, as coverage (mode L); None for everywhere.
        factor: How many times larger it is drawn.
    """
    box = box_around(extent, margin, size)
    if box is None:
        return None
    cover = mask(box, draw, factor)
    if allowed is not None:
        cover = ImageChops.multiply(cover, allowed.crop(box))
    return Layer(box, cover)


def mask(box: Box, draw: Draw, factor: int = SMOOTH) -> Image.Image:
    """Return what ``draw`` draws within ``box`` of a picture, as smooth coverage (mode L)."""
    left, top, right, bottom = box
    image = Image.new("L", ((right - left) * factor, (bottom - top) * factor), 0)
    draw(ImageDraw.Draw(image), Scaled(left, top, factor))
    return image.reduce(factor)


def stamp(
    image: Image.Image,
    box: Box,
    extent: ArrayLike,
    margin: float,
    colour: Colour,
    draw: Draw,
) -> None:
    """Draw a shape that changes in every frame into ``image``, the part ``box`` of a picture.

    Args:
        image: What to draw into.
        box: Which part of the picture it is; nothing beyond its right and bottom is drawn.
        extent: Points of the picture that the shape lies between, shape (N, 2).
        margin: By how much it may reach beyond them (pixels).
        colour: Its colour.
        draw: Draws it.
    """
    drawn = layer(extent, margin, (box[2], box[3]), draw, factor=SWIFT)
    if drawn is not None:
        drawn.lay(image, box, colour)


def rounded(size: tuple[int, int], radius: float = 9.0) -> Draw:
    """Return what draws a rectangle of ``size`` pixels with round corners."""

    def draw(pen: ImageDraw.ImageDraw, at: Scaled) -> None:
        corner = (size[0] * at.factor - 1, size[1] * at.factor - 1)
        pen.rounded_rectangle([(0, 0), corner], radius * at.factor, 255)

    return draw


@lru_cache(maxsize=2048)
def _text_mask(text: str, size: int, bold: bool) -> tuple[Image.Image, tuple[int, int]]:
    """Return a text as coverage and where its left baseline end lies in it."""
    font = style.font(size, bold)
    left, top, right, bottom = font.getbbox(text, anchor="ls")
    width, height = math.ceil(right) - math.floor(left), math.ceil(bottom) - math.floor(top)
    image = Image.new("L", (max(width, 1), max(height, 1)), 0)
    origin = (-math.floor(left), -math.floor(top))
    ImageDraw.Draw(image).text(origin, text, 255, font, anchor="ls")
    return image, origin


def write(
    image: Image.Image,
    at: tuple[float, float],
    text: str,
    colour: Colour,
    size: int,
    *,
    bold: bool = False,
    align: str = "l",
) -> None:
    """Write a line of text; most lines recur, so their shapes are kept.

    Args:
        image: What to write on.
        at: The baseline's left end, middle or right end (pixels).
        text: The line.
        colour: Its colour.
        size: Its size (pixels).
        bold: Whether it is bold.
        align: Which of the three ``at`` is: l, m or r.
    """
    if not text:
        return
    shape, origin = _text_mask(text, size, bold)
    advance = style.text_width(text, size, bold)
    x = at[0] - {"l": 0.0, "m": advance / 2, "r": advance}[align]
    image.paste(colour, (round(x) - origin[0], round(at[1]) - origin[1]), shape)


def polyline(
    pen: ImageDraw.ImageDraw, points: Sequence[tuple[float, float]], fill: int, width: float
) -> None:
    """Draw a line with round joints and ends."""
    if not points:
        return
    thick = max(1, round(width))
    if len(points) > 1:
        pen.line(list(points), fill=fill, width=thick, joint="curve")
    radius = (thick - 1) / 2  # Pillow's outlines include their last pixel
    for x, y in (points[0], points[-1]):
        pen.ellipse((x - radius, y - radius, x + radius, y + radius), fill=fill)


def box_around(points: ArrayLike, margin: float, size: tuple[int, int]) -> Box | None:
    """Return the box with even edges about points, within a picture of ``size``; None if empty."""
    p = np.asarray(points, dtype=np.float64).reshape(-1, 2)
    if not len(p):
        return None
    x0, y0 = p.min(axis=0).tolist()
    x1, y1 = p.max(axis=0).tolist()
    if not math.isfinite(x0 + y0 + x1 + y1):
        return box_around(p[np.isfinite(p).all(axis=1)], margin, size)
    left, top = (int(max(edge - margin, 0.0) // 2) * 2 for edge in (x0, y0))
    right = math.ceil(min(x1 + margin, size[0]) / 2) * 2
    bottom = math.ceil(min(y1 + margin, size[1]) / 2) * 2
    return (left, top, right, bottom) if right > left and bottom > top else None


def joined(boxes: Iterable[Box | None]) -> Box | None:
    """Return the box about boxes."""
    known = [box for box in boxes if box is not None]
    if not known:
        return None
    left, top, right, bottom = zip(*known, strict=True)
    return min(left), min(top), max(right), max(bottom)


def card(rect: Rect, title: str = "", unit: float = 1.0) -> Image.Image:
    """Return the picture of an empty card with its title; ``unit`` is pixels a point."""
    image = Image.new("RGB", rect.size, style.PAGE)
    image.paste(style.CARD, mask=mask((0, 0, *rect.size), rounded(rect.size, 9.0 * unit)))
    (size,) = style.scaled((16,), unit)
    write(image, (12 * unit, 20 * unit), title, style.MUTED, size, bold=True)
    return image


def region_of(place: Rect, image: Image.Image, box: Box) -> DirtyRegion:
    """Return the part ``box`` of a picture as one of the frame, in which the picture is ``place``.

    A picture of another size is enlarged or reduced.
    """
    if image.size == place.size:
        return DirtyRegion(place.x + box[0], place.y + box[1], image.crop(box))
    factors = place.width / image.width, place.height / image.height
    edges = np.reshape(box, (2, 2)) * factors
    near = box_around(edges, _SUPPORT, place.size)
    wide = box_around(edges, 2 * _SUPPORT, place.size)
    assert near is not None
    assert wide is not None
    (x0, y0), (x1, y1) = (np.reshape(wide, (2, 2)) / factors).tolist()
    size = (wide[2] - wide[0], wide[3] - wide[1])
    resampled = image.resize(size, Image.Resampling.LANCZOS, box=(x0, y0, x1, y1))
    left, top = near[0] - wide[0], near[1] - wide[1]
    part = resampled.crop((left, top, left + near[2] - near[0], top + near[3] - near[1]))
    return DirtyRegion(place.x + near[0], place.y + near[1], part)
