"""A screen that nobody sees: an X server with OpenGL, and a look at what it shows."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

needs_screen = pytest.mark.skipif(shutil.which("Xvfb") is None, reason="needs the program Xvfb")


class Screen(NamedTuple):
    """An X server: what a program needs to open windows on it, and the file with its picture."""

    environment: dict[str, str]
    file: Path

    def picture(self) -> NDArray[np.uint8]:
        """Return what it shows now, shape (h, w, 3): red, green and blue, 0 to 255."""
        data = self.file.read_bytes()
        head = np.frombuffer(data[:100], dtype=">u4").astype(int)  # an XWD file
        length, width, height, row, colours = head[0], head[4], head[5], head[12], head[19]
        pixels = np.frombuffer(data, np.uint8, row * height, length + 12 * colours)
        return pixels.reshape(height, -1)[:, : 4 * width].reshape(height, width, 4)[..., 2::-1]

    def shows(self, colour: tuple[int, int, int], within: int = 3) -> int:
        """Return how many pixels have about this colour."""
        return int((np.abs(self.picture().astype(int) - colour).max(axis=-1) <= within).sum())


@contextmanager
def screen(folder: Path, *options: str) -> Iterator[Screen]:
    """Start an X server for the block."""
    reading, writing = os.pipe()
    command = ["Xvfb", "-displayfd", str(writing), "-fbdir", str(folder), "-nolisten", "tcp"]
    server = subprocess.Popen(
        [*command, "-screen", "0", "1280x800x24", *options],
        pass_fds=[writing],
        stderr=subprocess.DEVNULL,
    )
    os.close(writing)
    try:
        with os.fdopen(reading) as told:
            number = told.readline().strip()
        yield Screen({**os.environ, "DISPLAY": f":{number}"}, folder / "Xvfb_screen0")
    finally:
        server.terminate()
        server.wait()
