"""What stands beside the field on the map: how large its squares are, and what the marks mean."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyq_bullet.video import paint, style
from fuzzyq_bullet.video.marks import began, diamond, left_off, reticle

if TYPE_CHECKING:
    from PIL import Image

_SIZE = 14
_LINE = 18
"""Room that a line of text takes (points)."""
_EDGE = 12
_COLUMN = 92
"""Room that the words take beside the field (points)."""


def note(image: Image.Image, field: paint.Box, text: str, unit: float = 1.0) -> None:
    """Write a line above the field, or beside it; nowhere if there is no room.

    Args:
        image: The map.
        field: The part of it in which the arena is drawn.
        text: The line.
        unit: Pixels a point.
    """
    (size,) = style.scaled((_SIZE,), unit)
    beside = (_EDGE + 4) * unit + style.text_width(text, size)
    if field[1] >= _LINE * unit or field[0] >= beside:
        paint.write(image, (_EDGE * unit, 14 * unit), text, style.MUTED, size)


def legend(
    image: Image.Image, field: paint.Box, *, aims: bool, ways_out: bool, unit: float = 1.0
) -> None:
    """Say what the marks are, in a line below the field, or in a column beside it.

    Args:
        image: The map.
        field: The part of it in which the arena is drawn.
        aims: Whether there are aims.
        ways_out: Whether there are ways out.
        unit: Pixels a point.
    """
    words = ["aim"] if aims else []
    if ways_out:
        words += ["frontier", "breakout", "routine"]
    (size,) = style.scaled((_SIZE,), unit)
    if field[3] <= image.height - _LINE * unit:
        x = _EDGE * unit
        for word in words:
            _entry(image, x, image.height - 6 * unit, word, unit)
            x += 36 * unit + style.text_width(word, size)
    elif field[0] >= _COLUMN * unit:
        for row, word in enumerate(reversed(words)):
            _entry(image, 8 * unit, image.height - (10 + 22 * row) * unit, word, unit)


def _entry(image: Image.Image, x: float, y: float, word: str, unit: float) -> None:
    """Draw a mark with its word; ``x`` is its left edge and ``y`` the word's baseline."""
    at, everywhere = (x + 8 * unit, y - 5 * unit), (0, 0, *image.size)
    (size,) = style.scaled((_SIZE,), unit)
    if word == "frontier":
        diamond(image, everywhere, at, 6.0, unit)
    else:
        if word == "aim":
            layers = reticle(at, image.size, 7.0, unit)
        else:
            layers = (began if word == "breakout" else left_off)(at, image.size, unit)
        for colour, drawn in layers:
            drawn.lay(image, everywhere, colour)
    paint.write(image, (x + 22 * unit, y), word, style.MUTED, size)
