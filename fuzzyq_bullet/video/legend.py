"""What stands beside the field on the map: how large its squares are, and what the marks mean."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyq_bullet.video import paint, style
from fuzzyq_bullet.video.marks import began, diamond, left_off, reticle
from fuzzyq_bullet.video.style import MAP

if TYPE_CHECKING:
    from PIL import Image

_SIZE = 14
_LINE = 18
"""Room that a line of text takes (pixels)."""
_EDGE = 12
_COLUMN = 92
"""Room that the words take beside the field (pixels)."""
_ALL = (0, 0, *MAP.size)


def note(image: Image.Image, field: paint.Box, text: str) -> None:
    """Write a line above the field, or beside it; nowhere if there is no room.

    Args:
        image: The map.
        field: The part of it in which the arena is drawn.
        text: The line.
    """
    if field[1] >= _LINE or field[0] >= _EDGE + style.text_width(text, _SIZE) + 4:
        paint.write(image, (_EDGE, 14), text, style.MUTED, _SIZE)


def legend(image: Image.Image, field: paint.Box, *, aims: bool, ways_out: bool) -> None:
    """Say what the marks are, in a line below the field, or in a column beside it.

    Args:
        image: The map.
        field: The part of it in which the arena is drawn.
        aims: Whether there are aims.
        ways_out: Whether there are ways out.
    """
    words = ["aim"] if aims else []
    if ways_out:
        words += ["frontier", "breakout", "routine"]
    if field[3] <= MAP.height - _LINE:
        x = float(_EDGE)
        for word in words:
            _entry(image, x, MAP.height - 6, word)
            x += 22 + style.text_width(word, _SIZE) + 14
    elif field[0] >= _COLUMN:
        for row, word in enumerate(reversed(words)):
            _entry(image, 8, MAP.height - 10 - 22 * row, word)


def _entry(image: Image.Image, x: float, y: float, word: str) -> None:
    """Draw a mark with its word; ``x`` is its left edge and ``y`` the word's baseline."""
    at = (x + 8, y - 5)
    if word == "frontier":
        diamond(image, _ALL, at, 6.0)
    else:
        if word == "aim":
            layers = reticle(at, MAP.size, 7.0)
        else:
            layers = began(at, MAP.size) if word == "breakout" else left_off(at, MAP.size)
        for colour, drawn in layers:
            drawn.lay(image, _ALL, colour)
    paint.write(image, (x + 22, y), word, style.MUTED, _SIZE)
