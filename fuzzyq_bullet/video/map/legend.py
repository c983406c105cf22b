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
_RULED = {"aim": "aim", "target": "frontier", "begins": "breakout", "ends": "routine"}
_OTHERS = {"aim": "aim", "target": "target", "begins": "blocked", "ends": "free again"}
"""What each mark is called, for planners with fuzzy rules and for others."""


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
    image: Image.Image,
    field: paint.Box,
    *,
    aims: bool,
    targets: bool,
    begins: bool,
    ends: bool,
    ruled: bool,
    unit: float = 1.0,
) -> None:
    """Say what the marks are, in a line below the field, or in a column beside it.

    Args:
        image: The map.
        field: The part of it in which the arena is drawn.
        aims: Whether there are aims.
        targets: Whether there are temporary goals.
        begins: Whether ways out begin.
        ends: Whether ways out end.
        ruled: Whether the planner has fuzzy rules: the names of its modes are the paper's.
        unit: Pixels a point.
    """
    names = _RULED if ruled else _OTHERS
    there = (aims, targets, begins, ends)
    entries = [(mark, names[mark]) for mark, shown in zip(names, there, strict=True) if shown]
    (size,) = style.scaled((_SIZE,), unit)
    if field[3] <= image.height - _LINE * unit:
        x = _EDGE * unit
        for mark, word in entries:
            _entry(image, x, image.height - 6 * unit, mark, word, unit)
            x += 36 * unit + style.text_width(word, size)
    elif field[0] >= _COLUMN * unit:
        for row, (mark, word) in enumerate(reversed(entries)):
            _entry(image, 8 * unit, image.height - (10 + 22 * row) * unit, mark, word, unit)


def _entry(image: Image.Image, x: float, y: float, mark: str, word: str, unit: float) -> None:
    """Draw a mark with its word; ``x`` is its left edge and ``y`` the word's baseline."""
    at, everywhere = (x + 8 * unit, y - 5 * unit), (0, 0, *image.size)
    (size,) = style.scaled((_SIZE,), unit)
    if mark == "target":
        diamond(image, everywhere, at, 6.0, unit)
    else:
        if mark == "aim":
            layers = reticle(at, image.size, 7.0, unit)
        else:
            layers = (began if mark == "begins" else left_off)(at, image.size, unit)
        for colour, drawn in layers:
            drawn.lay(image, everywhere, colour)
    paint.write(image, (x + 22 * unit, y), word, style.MUTED, size)
