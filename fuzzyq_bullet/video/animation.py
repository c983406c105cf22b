"""Frames in, an animated picture out: GIF or WebP, for pages that play no films."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import imageio.v3 as iio
import numpy as np
from PIL import Image

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.video.style import HEIGHT, PAGE, WIDTH

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from fuzzyq_bullet.video.film import Patch

FPS = 10
"""Frames a second: a third of a film's, for pictures that are many times as large."""
SIZE = (WIDTH // 2, HEIGHT // 2)
"""Width and height (pixels)."""
ENDINGS = (".gif", ".webp")
_OPTIONS: dict[str, dict[str, Any]] = {
    ".gif": {"optimize": True},
    ".webp": {"quality": 55, "method": 4},
}


class Animation:
    """Writes one animated picture, which plays again and again.

    All frames are held in memory until the end, 0.7 MB each: it is for short runs. Leaving the
    block in peace writes the file.

    Args:
        path: Where the file is to be written; its ending chooses the kind.
        name: What to call it in messages.
    """

    def __init__(self, path: Path, name: Path) -> None:
        self._path, self._name = path, name
        self._canvas = Image.new("RGB", (WIDTH, HEIGHT), PAGE)
        self._palette: Image.Image | None = None
        self._frames: list[np.ndarray[Any, np.dtype[np.uint8]]] = []

    def __enter__(self) -> Animation:
        return self

    def write(self, patches: Iterable[Patch]) -> None:
        """Append a frame: the one before, with these parts of it drawn anew."""
        for patch in patches:
            self._canvas.paste(patch.image, (patch.x, patch.y))
        small = self._canvas.resize(SIZE, Image.Resampling.LANCZOS)
        if self._path.suffix.lower() == ".gif":
            # One palette for all frames: where nothing changes, they are the same to the bit.
            self._palette = self._palette or small.quantize(
                255, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE
            )
            small = small.quantize(palette=self._palette, dither=Image.Dither.NONE).convert("RGB")
        self._frames.append(np.asarray(small))

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is not None:
            return
        ending = self._path.suffix.lower()
        try:
            iio.imwrite(
                self._path,
                np.stack(self._frames),
                plugin="pillow",
                extension=ending,
                duration=1000 // FPS,
                loop=0,
                **_OPTIONS[ending],
            )
        except (OSError, ValueError) as error:
            why = getattr(error, "strerror", None) or error
            raise UserError(f"{self._name}: cannot be written: {why}") from error
