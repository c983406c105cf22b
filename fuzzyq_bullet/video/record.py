"""From a record to a video, frame by frame, or to one picture of it."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import written_beside
from fuzzyq_bullet.video.compositor import Compositor, closing
from fuzzyq_bullet.video.encoders import (
    ANIMATION_ENDINGS,
    ANIMATION_FPS,
    Animation,
    Encoder,
    FrameBuffer,
)
from fuzzyq_bullet.video.panels import frame_size
from fuzzyq_bullet.video.style import FPS, PAGE
from fuzzyq_bullet.video.timeline import Moment, Timeline

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from fuzzyq_bullet.trajectory import Trajectory

CLOSING = 1.0
"""How long the outcome is shown at the end (s)."""
SLOWEST, FASTEST = 0.1, 100.0
_ROUNDING = 1e-9


class VideoInfo(NamedTuple):
    """What was written.

    Attributes:
        frames: Number of frames.
        seconds: How long the video plays (s).
        size: Width and height (pixels).
    """

    frames: int
    seconds: float
    size: tuple[int, int]

    @classmethod
    def of(cls, frames: int, fps: int, *, small: bool) -> VideoInfo:
        """Return what so many frames make."""
        width, height = frame_size()
        return cls(frames, frames / fps, (width // 2, height // 2) if small else (width, height))


def record(
    trajectory: Trajectory,
    path: Path | str,
    *,
    speed: float = 1.0,
    small: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> VideoInfo:
    """Write a run as an MP4: H.264, 1280 × 720, 30 frames a second.

    A path that ends in ``.gif`` or ``.webp`` makes an animated picture instead: 640 × 360, 10
    frames a second, for pages that play no films.

    The same run gives the same bytes. Frames are handed on one by one; whatever interrupts the
    work, no unfinished file takes the place of ``path``.

    Args:
        trajectory: The run.
        path: The file to write.
        speed: Seconds of the run in one second of video, 0.1 to 100.
        small: 640 × 360 instead, in an eighth of the bytes or so; an animated picture always is.
        progress: Called after each frame with the number of frames done and in total.

    Raises:
        UserError: If the speed is out of range, the path ends otherwise, ffmpeg is missing or
            fails, or the file cannot be written.
    """
    path = Path(path)
    ending = path.suffix.lower()
    if ending not in (".mp4", *ANIMATION_ENDINGS):
        raise UserError(
            f"{path}: a film ends in .mp4, an animated picture in {' or '.join(ANIMATION_ENDINGS)}"
        )
    if not (isinstance(speed, (int, float)) and SLOWEST <= speed <= FASTEST):
        raise UserError(f"speed {speed!r}: the speed of a video is {SLOWEST:g} to {FASTEST:g}")
    timeline = Timeline(trajectory)
    if ending == ".mp4":
        info = VideoInfo.of(frame_count(timeline, speed), FPS, small=small)
    else:
        info = VideoInfo.of(frame_count(timeline, speed, ANIMATION_FPS), ANIMATION_FPS, small=True)
    told = progress or (lambda done, total: None)
    with written_beside(path) as part, Compositor(trajectory, speed) as compositor:
        if ending == ".mp4":
            buffer = FrameBuffer(frame_size())
            with Encoder(part, path, size=frame_size(), small=small) as encoder:
                for number, moment in enumerate(moments(timeline, speed), start=1):
                    buffer.apply(compositor.changes(moment))
                    encoder.write(buffer)
                    told(number, info.frames)
        else:
            with Animation(part, path, frame_size()) as picture:
                for number, moment in enumerate(moments(timeline, speed, ANIMATION_FPS), start=1):
                    picture.write(compositor.changes(moment))
                    told(number, info.frames)
    return info


def frame(trajectory: Trajectory, time: float) -> NDArray[np.uint8]:
    """Return the frame of a run at a time (s) as a picture; after its end, the one that closes it.

    It is the picture that a film of the run has at that time, for a notebook for example::

        from PIL import Image

        Image.fromarray(frame(trajectory, 5.0))

    Args:
        trajectory: The run.
        time: Seconds since its start; before its start, the first frame.

    Returns:
        Red, green and blue from 0 to 255, shape (height, width, 3): (720, 1280, 3).

    Raises:
        UserError: If the time is not a number.
    """
    if math.isnan(time):
        raise UserError("the time of a frame must be a number of seconds")
    timeline = Timeline(trajectory)
    moment = timeline.at(time)
    image = Image.new("RGB", frame_size(), PAGE)
    with Compositor(trajectory) as compositor:
        if time > timeline.end:
            moment = closing(moment)
        for region in compositor.changes(moment):
            image.paste(region.image, (region.x, region.y))
    return np.array(image)


def moments(timeline: Timeline, speed: float, fps: int = FPS) -> Iterator[Moment]:
    """Yield the moment of each frame: the run, then its end for as long as the outcome is shown."""
    for k in range(_running(timeline, speed, fps)):
        yield timeline.at(timeline.start + k * speed / fps)
    last = closing(timeline.at(timeline.end))
    for _ in range(round(CLOSING * fps)):
        yield last


def frame_count(timeline: Timeline, speed: float, fps: int = FPS) -> int:
    """Return the number of frames of a video."""
    return _running(timeline, speed, fps) + round(CLOSING * fps)


def _running(timeline: Timeline, speed: float, fps: int) -> int:
    return math.floor((timeline.end - timeline.start) * fps / speed + _ROUNDING) + 1
