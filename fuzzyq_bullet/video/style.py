"""How the video looks: layout, colours, fonts. Nothing else decides a size or a colour."""

from __future__ import annotations

import importlib.util
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple, TypeAlias

from PIL import ImageFont

Colour: TypeAlias = tuple[int, int, int]
Font: TypeAlias = ImageFont.FreeTypeFont | ImageFont.ImageFont

WIDTH, HEIGHT = 1280, 720


class Rect(NamedTuple):
    """A rectangle of the frame in pixels; all numbers even, as H.264 halves its colours."""

    x: int
    y: int
    width: int
    height: int

    @property
    def size(self) -> tuple[int, int]:
        """Width and height."""
        return self.width, self.height

    @property
    def right(self) -> int:
        """First column to the right of it."""
        return self.x + self.width

    @property
    def bottom(self) -> int:
        """First row below it."""
        return self.y + self.height


# Two rows of one grid: where the robot is above, why it turns below, the reason in words between.
HEADER = Rect(10, 0, 1260, 40)
SCENE = Rect(10, 40, 880, 384)
MAP = Rect(898, 40, 372, 384)
STORY = Rect(10, 432, 1260, 58)
SENSORS = Rect(10, 498, 316, 212)
FUZZIFICATION = Rect(334, 498, 274, 212)
RULES = Rect(616, 498, 274, 212)
ACTION = Rect(898, 498, 372, 212)

PAGE: Colour = (13, 16, 21)
CARD: Colour = (24, 29, 37)
LINE: Colour = (58, 67, 80)
FAINT: Colour = (112, 124, 140)
MUTED: Colour = (160, 171, 186)
TEXT: Colour = (240, 244, 248)

# Okabe and Ito's palette, which the colour-blind tell apart; place and shape say the same again.
LEFT: Colour = (86, 180, 233)
MIDDLE: Colour = (240, 228, 66)
RIGHT: Colour = (230, 110, 30)
LINES = (LEFT, MIDDLE, RIGHT)
GOAL: Colour = (20, 184, 138)
AIM: Colour = MIDDLE
"""The middle line points at the aim."""
TARGET: Colour = (222, 140, 184)
DANGER: Colour = (240, 110, 40)
ROBOT: Colour = (250, 250, 252)
PATH: Colour = (235, 240, 246)
HEAT: Colour = (240, 228, 66)

GROUND: Colour = (50, 58, 69)
GRID: Colour = (61, 70, 82)
OBSTACLE: Colour = (139, 152, 169)
MOVER: Colour = (196, 178, 148)
"""What moves by itself; an arrow on it says where it goes."""
WALL: Colour = (92, 104, 120)
SHADOW: Colour = (30, 35, 43)


@lru_cache(maxsize=64)
def font(size: int, bold: bool = False) -> Font:
    """Return the font of all text at a size in pixels; the same everywhere, for it comes along."""
    spec = importlib.util.find_spec("matplotlib")
    if spec is not None and spec.origin is not None:
        folder = Path(spec.origin).parent / "mpl-data" / "fonts" / "ttf"
        path = folder / ("DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf")
        if path.is_file():
            return ImageFont.truetype(str(path), size, layout_engine=ImageFont.Layout.BASIC)
    return ImageFont.load_default(size)


@lru_cache(maxsize=2048)
def text_width(text: str, size: int, bold: bool = False) -> float:
    """Return how wide a text is (pixels)."""
    return font(size, bold).getlength(text)


def fitting(text: str, width: float, sizes: tuple[int, ...], bold: bool = False) -> tuple[str, int]:
    """Return the text and the largest of ``sizes`` at which it fits; shortened if none does."""
    for size in sizes:
        if text_width(text, size, bold) <= width:
            return text, size
    size = sizes[-1]
    while text and text_width(text + "…", size, bold) > width:
        text = text[:-1]
    return text.rstrip() + "…", size


def scaled(sizes: tuple[int, ...], unit: float) -> tuple[int, ...]:
    """Return sizes of letters in points as pixels."""
    return tuple(max(round(size * unit), 1) for size in sizes)


def mixed(a: Colour, b: Colour, part: float) -> Colour:
    """Return the colour that lies ``part`` of the way from ``a`` to ``b``."""
    red, green, blue = (round(p + (q - p) * part) for p, q in zip(a, b, strict=True))
    return red, green, blue
