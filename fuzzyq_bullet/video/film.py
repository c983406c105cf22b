"""One frame as the encoder wants it (YUV 4:2:0), changed in place, only where it changed.

Converting only what changed is an order of magnitude less work than letting ffmpeg convert every
whole frame from RGB, and the frame is half as many bytes to hand over.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from PIL import Image

from fuzzyq_bullet.video.style import HEIGHT, PAGE, WIDTH

if TYPE_CHECKING:
    from collections.abc import Iterable


class Patch(NamedTuple):
    """A part of the frame that changed; place and size are even.

    Attributes:
        x: Left edge in the frame (pixels).
        y: Top edge.
        image: What is to be seen there now, RGB.
    """

    x: int
    y: int
    image: Image.Image


def _matrix() -> tuple[float, ...]:
    """Return ITU-R BT.709 with limited range, as Pillow wants it: three rows of four."""
    red, blue = 0.2126, 0.0722
    green = 1.0 - red - blue
    y, c = 219 / 255, 224 / 255
    cb, cr = c / 2 / (1 - blue), c / 2 / (1 - red)
    rows = (
        (y * red, y * green, y * blue, 16.0),
        (-cb * red, -cb * green, c / 2, 128.0),
        (c / 2, -cr * green, -cr * blue, 128.0),
    )
    return tuple(value for row in rows for value in row)


_BT709 = _matrix()


class Film:
    """The frame being made.

    Attributes:
        planes: Y, then U, then V at half the resolution; uint8, contiguous.
    """

    def __init__(self) -> None:
        self.planes = np.empty(WIDTH * HEIGHT * 3 // 2, dtype=np.uint8)
        luma, chroma = WIDTH * HEIGHT, WIDTH * HEIGHT // 4
        self._y = self.planes[:luma].reshape(HEIGHT, WIDTH)
        self._u = self.planes[luma : luma + chroma].reshape(HEIGHT // 2, WIDTH // 2)
        self._v = self.planes[luma + chroma :].reshape(HEIGHT // 2, WIDTH // 2)
        self.apply([Patch(0, 0, Image.new("RGB", (WIDTH, HEIGHT), PAGE))])

    def apply(self, patches: Iterable[Patch]) -> None:
        """Put patches into the frame."""
        for x, y, image in patches:
            width, height = image.size
            converted = image.convert("RGB", _BT709)
            half = np.asarray(converted.reduce(2))
            rows, columns = slice(y // 2, (y + height) // 2), slice(x // 2, (x + width) // 2)
            self._y[y : y + height, x : x + width] = np.asarray(converted)[..., 0]
            self._u[rows, columns] = half[..., 1]
            self._v[rows, columns] = half[..., 2]
