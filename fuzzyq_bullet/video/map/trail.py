"""A picture over which the robot's way grows, with what is marked below and above it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike
from PIL import Image, ImageChops

from fuzzyq_bullet.video import paint, style

if TYPE_CHECKING:
    from fuzzyq_bullet.video.map.footprints import Floats

_WIDTH = 2.4
"""Width of the way (points)."""
_STEP = 1.5
"""The way grows by no less (pixels)."""


class Trail:
    """A picture over which the robot's way grows; it looks the same in however many pieces.

    Args:
        background: The picture without it.
        positions: All points of the way (m), shape (T, 2).
        project: Turns points (m), shape (N, 2), into pixels of the picture.
        allowed: Where it may be seen, as coverage (mode L); None for everywhere.
        unit: Pixels a point, which its width is given in.

    Attributes:
        image: The picture with the way so far.
    """

    def __init__(
        self,
        background: Image.Image,
        positions: Floats,
        project: Callable[[ArrayLike], Floats],
        allowed: Image.Image | None = None,
        unit: float = 1.0,
    ) -> None:
        self.image = background.copy()
        self._width = _WIDTH * unit
        self._background = background
        self._positions = positions
        self._project = project
        self._allowed = allowed
        self._line = Image.new("L", background.size, 0)
        self._tick = 0
        self._below: paint.Inked | None = None
        self._above: list[paint.Inked] = []
        self._pinned: list[paint.Inked] = []

    def lay_below(self, shape: paint.Inked | None) -> paint.Box | None:
        """Show one shape beneath the way, in place of the last; return the box that changed."""
        boxes = [one[1].box for one in (self._below, shape) if one is not None]
        self._below = shape
        for box in boxes:
            self._compose(box)
        return paint.joined(boxes)

    def lay_above(self, shapes: Sequence[paint.Inked]) -> paint.Box | None:
        """Show further shapes on top of the way for good; return the box that changed."""
        self._above += shapes
        for _, drawn in shapes:
            self._compose(drawn.box)
        return paint.joined(drawn.box for _, drawn in shapes)

    def pin(self, shapes: Sequence[paint.Inked]) -> paint.Box | None:
        """Show shapes on top of all, in place of the last pinned; return the box that changed."""
        boxes = [drawn.box for _, drawn in (*self._pinned, *shapes)]
        self._pinned = list(shapes)
        for box in boxes:
            self._compose(box)
        return paint.joined(boxes)

    def follow(self, tick: int) -> paint.Box | None:
        """Draw the way up to a tick and return the box that changed.

        Its last pixels, which the robot covers, wait until there are a few.
        """
        if tick <= self._tick:
            return None
        points = self._project(self._positions[self._tick : tick + 1])
        if np.abs(points - points[0]).max() < _STEP:  # all of it: it may have come back
            return None
        self._tick = tick
        piece = paint.layer(
            points,
            self._width + 1,
            self.image.size,
            lambda pen, at: paint.polyline(pen, at(points), 255, self._width * at.factor),
            self._allowed,
        )
        if piece is None:
            return None
        # The greater of the two, not the sum: overlapping ends must not show.
        line = ImageChops.lighter(piece.cover, self._line.crop(piece.box))
        self._line.paste(line, piece.box)
        self._compose(piece.box)
        return piece.box

    def _compose(self, box: paint.Box) -> None:
        patch = self._background.crop(box)
        if self._below is not None:
            self._below[1].lay(patch, box, self._below[0])
        patch.paste(style.PATH, mask=self._line.crop(box))
        for colour, drawn in (*self._above, *self._pinned):
            drawn.lay(patch, box, colour)
        self.image.paste(patch, box)
