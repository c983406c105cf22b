"""How a run is to be filmed: view, size, speed and part of it; checked before anything is made.

Imports nothing heavy, so that the command line can refuse what is wrong at once.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass

from fuzzyq_bullet.errors import UserError

FPS = 30
ANIMATION_FPS = 10
"""Frames a second of an animated picture: a third of a film's, as it is many times as large."""
USUAL_SIZE, ANIMATION_SIZE = (1280, 720), (640, 360)
"""Width and height (pixels) of a film and of an animated picture; panels of one's own add rows."""
MOST_FPS, MOST_ANIMATION_FPS = 120, 50
SLOWEST, FASTEST = 0.1, 100.0
"""Playback speeds of a video."""
LEAST_SIDE, MOST_SIDE, MOST_PIXELS = 240, 3840, 3840 * 2160
CLOSING = 1.0
"""How long the outcome is shown at the end (s)."""
FORMATS = ("mp4", "gif")
EXPLAIN = "explain"
"""The usual view."""
VIEWS = (EXPLAIN, "scene", "follow", "map")
"""Those of the package, which races have too."""
_ROUNDING = 1e-9
_SIZE = re.compile(r"(\d{1,6})x(\d{1,6})")


@dataclass(frozen=True)
class Filming:
    """What is asked of a film.

    Attributes:
        view: Name of what is shown.
        size: Width and height (pixels); None for the usual size.
        fps: Frames a second; None for as many as is usual.
        speed: Seconds of the run in one second of video.
        start: Time of the run at which it begins (s); None for the start.
        end: Time of the run at which it ends (s); None for the end, and how the run ended.

    Raises:
        UserError: If one of them is out of range.
    """

    view: str = EXPLAIN
    size: tuple[int, int] | None = None
    fps: int | None = None
    speed: float = 1.0
    start: float | None = None
    end: float | None = None

    def __post_init__(self) -> None:
        """Check each, and that it ends after it begins."""
        name = "speed"
        try:
            check_speed(self.speed)
            name = "size"
            check_size(self.size)
            name = "fps"
            check_fps(self.fps)
            name = "start"
            check_time(self.start)
            name = "end"
            check_time(self.end)
        except ValueError as error:
            raise UserError(f"{name}: {error}") from error
        if self.end is not None and self.end <= (self.start or 0.0):
            raise UserError(
                f"end: must be later than start ({self.start or 0:g} s); got {self.end:g}"
            )

    def times(self, start: float, end: float, fps: int) -> Iterator[float]:
        """Yield the time of each frame (s) of a run; infinity for those that show how it ended.

        Args:
            start: Time at which the run starts (s).
            end: Time at which it ends (s).
            fps: Frames a second.
        """
        first, running, closing = self._frames(start, end, fps)
        for number in range(running):
            yield first + number * self.speed / fps
        for _ in range(closing):
            yield math.inf

    def count(self, start: float, end: float, fps: int) -> int:
        """Return the number of frames of a run; see ``times``."""
        _, running, closing = self._frames(start, end, fps)
        return running + closing

    def check_begins(self, end: float) -> None:
        """Check that it begins before a run ends (s).

        Raises:
            UserError: If it does not.
        """
        if self.start is not None and self.start > end:
            raise UserError(f"start: {self.start:g} s is after the end of the run, {end:.2f} s")

    def _frames(self, start: float, end: float, fps: int) -> tuple[float, int, int]:
        first = start if self.start is None else self.start
        if self.end is not None and self.end <= end:
            return first, max(round((self.end - first) * fps / self.speed), 1), 0
        running = math.floor((end - first) * fps / self.speed + _ROUNDING) + 1
        return first, running, round(CLOSING * fps)


def size_of(text: str) -> tuple[int, int]:
    """Return a size that is written as ``1920x1080``.

    Raises:
        ValueError: If it is written otherwise, or no film has it.
    """
    found = _SIZE.fullmatch(text.strip().lower().replace("×", "x"))
    if not found:
        raise ValueError(f"must be WIDTHxHEIGHT, such as 1920x1080; got {text!r}")
    size = int(found[1]), int(found[2])
    check_size(size)
    return size


def check_size(size: tuple[int, int] | None) -> None:
    """Check width and height (pixels) of a frame.

    Raises:
        ValueError: If no film has this size.
    """
    if size is None:
        return
    try:
        width, height = size
        whole = all(side == int(side) for side in (width, height))
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"must be width and height, such as (1920, 1080); got {size!r}") from None
    said = f"{width}x{height}"
    if not whole or width % 2 or height % 2:
        raise ValueError(f"width and height must be even numbers; got {said}")
    if not all(LEAST_SIDE <= side <= MOST_SIDE for side in size) or width * height > MOST_PIXELS:
        raise ValueError(
            f"must be from {LEAST_SIDE}x{LEAST_SIDE} to 3840x2160 or 2160x3840; got {said}"
        )


def check_fps(fps: int | None) -> None:
    """Check a number of frames a second.

    Raises:
        ValueError: If no film has it.
    """
    if fps is not None and not (1 <= fps <= MOST_FPS and fps == int(fps)):
        raise ValueError(f"must be a whole number from 1 to {MOST_FPS}; got {fps!r}")


def check_speed(speed: float) -> None:
    """Check a playback speed.

    Raises:
        ValueError: If it is too slow or too fast.
    """
    number = isinstance(speed, (int, float))
    if not (number and SLOWEST <= speed <= FASTEST):
        said = f"{speed:g}" if number else repr(speed)
        raise ValueError(f"must be from {SLOWEST:g} to {FASTEST:g}, got {said}")


def check_time(time: float | None) -> None:
    """Check a time of a run (s).

    Raises:
        ValueError: If it is none.
    """
    if time is not None and not (math.isfinite(time) and time >= 0.0):
        raise ValueError(f"must be a number of seconds from 0 on; got {time:g}")
