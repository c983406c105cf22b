"""Where everything lies in a frame of any size: one of two arrangements, as large as can be."""

from __future__ import annotations

import math
from dataclasses import dataclass
from operator import itemgetter
from typing import NamedTuple

from fuzzyq_bullet.video import style
from fuzzyq_bullet.video.style import Rect


class _Arrangement(NamedTuple):
    """Cards of a frame of ``width`` × ``height`` points; all of a name have the same content.

    Whatever is higher than the frame needs to be is given to the cards in ``growing``, and moves
    those below them.
    """

    width: int
    height: int
    cards: dict[str, Rect]
    growing: tuple[str, ...]


_WIDE = _Arrangement(
    style.WIDTH,
    style.HEIGHT,
    {
        "header": style.HEADER,
        "scene": style.SCENE,
        "map": style.MAP,
        "story": style.STORY,
        "sensors": style.SENSORS,
        "fuzzification": style.FUZZIFICATION,
        "rules": style.RULES,
        "action": style.ACTION,
    },
    growing=("scene", "map"),
)
_SQUARE = _Arrangement(
    1080,
    1080,
    {
        "header": Rect(10, 0, 1060, 40),
        "scene": Rect(10, 40, 1060, 524),
        "story": Rect(10, 572, 1060, 58),
        "map": Rect(10, 638, 398, 432),
        "sensors": Rect(416, 638, 372, 212),
        "fuzzification": Rect(796, 638, 274, 212),
        "action": Rect(416, 858, 372, 212),
        "rules": Rect(796, 858, 274, 212),
    },
    growing=("scene",),
)
_ADDED_HEIGHT, _GAP, _ROW = 160, 8, 4
"""Panels of a user's own: how high they are, what lies between them, how many share a row."""


@dataclass(frozen=True)
class Layout:
    """Where the cards of a frame lie.

    Attributes:
        size: Width and height of the frame (pixels).
        unit: Pixels a point: letters and lines are so many times as large as at 1280 × 720.
        cards: Each card in points.
        origin: Where in the frame the first point lies (pixels).
    """

    size: tuple[int, int]
    unit: float
    cards: dict[str, Rect]
    origin: tuple[float, float] = (0.0, 0.0)

    @classmethod
    def explaining(cls, size: tuple[int, int], added: int = 0) -> Layout:
        """Return the layout of the film that explains, with so many panels of a user's own."""
        width, height = size
        more = _added_height(added)
        unit, kind = max(
            (
                (min(width / one.width, height / (one.height + more)), one)
                for one in (_WIDE, _SQUARE)
            ),
            key=itemgetter(0),
        )
        needed = kind.height + more
        more = max(int(height / unit - needed) // 2 * 2, 0)
        below = min(kind.cards[name].y for name in kind.growing) + 1
        cards = {
            name: card._replace(height=card.height + more)
            if name in kind.growing
            else card._replace(y=card.y + (more if card.y >= below else 0))
            for name, card in kind.cards.items()
        }
        for number, card in enumerate(_places(kind, kind.height + more, added)):
            cards[f"added {number}"] = card
        origin = ((width - kind.width * unit) / 2, (height - (needed + more) * unit) / 2)
        return cls(size, unit, cards, origin)

    @classmethod
    def plain(cls, size: tuple[int, int]) -> Layout:
        """Return the layout of one picture below the caption, from edge to edge."""
        width, height = size
        unit = math.sqrt(width * height / (style.WIDTH * style.HEIGHT))
        across, down = round(width / unit), round(height / unit)
        top = style.HEADER.bottom
        header = Rect(10, 0, across - 20, top)
        return cls(size, unit, {"header": header, "picture": Rect(0, top, across, down - top)})

    def place(self, name: str) -> Rect:
        """Return where in the frame a card lies (pixels)."""
        return self.pixels(self.cards[name])

    def pixels(self, card: Rect) -> Rect:
        """Return where in the frame a rectangle lies that is given in points."""
        (x, y), unit = self.origin, self.unit
        left, right = (_even(x + edge * unit, self.size[0]) for edge in (card.x, card.right))
        top, bottom = (_even(y + edge * unit, self.size[1]) for edge in (card.y, card.bottom))
        return Rect(left, top, right - left, bottom - top)


def usual_size(added: int = 0) -> tuple[int, int]:
    """Return the size (pixels) of a frame unless another is asked for, with panels of one's own."""
    return style.WIDTH, style.HEIGHT + _added_height(added)


def _added_height(count: int) -> int:
    return math.ceil(count / _ROW) * (_ADDED_HEIGHT + _GAP)


def _places(kind: _Arrangement, height: int, count: int) -> list[Rect]:
    """Return places for ``count`` more panels, in rows below all others."""
    places = []
    room = kind.cards["header"]
    for first in range(0, count, _ROW):
        number = min(count - first, _ROW)
        width = (room.width - (number - 1) * _GAP) // number // 2 * 2
        top = height - 10 + _GAP + first // _ROW * (_ADDED_HEIGHT + _GAP)
        lefts = (room.x + k * (width + _GAP) for k in range(number))
        places += [Rect(left, top, width, _ADDED_HEIGHT) for left in lefts]
    return places


def _even(value: float, most: int) -> int:
    """Return the nearest even number within the frame: H.264 halves its colours."""
    return min(max(round(value / 2) * 2, 0), most)
