"""From a record to a video, frame by frame, or to one picture of it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import imageio.v3 as iio
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import written_beside
from fuzzyq_bullet.filming import ANIMATION_FPS, EXPLAIN, FPS, MOST_ANIMATION_FPS, Filming
from fuzzyq_bullet.recording.trajectory import Trajectory
from fuzzyq_bullet.video.compositor import Compositor, closing
from fuzzyq_bullet.video.encoders import ANIMATION_ENDINGS, Animation, Encoder, FrameBuffer
from fuzzyq_bullet.video.race import Race
from fuzzyq_bullet.video.style import PAGE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from fuzzyq_bullet.video.timeline import Moment, Timeline


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


def record(
    trajectory: Trajectory | Sequence[Trajectory],
    path: Path | str,
    *,
    speed: float = 1.0,
    small: bool = False,
    size: tuple[int, int] | None = None,
    fps: int | None = None,
    start: float | None = None,
    end: float | None = None,
    view: str = EXPLAIN,
    names: Sequence[str] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> VideoInfo:
    """Write a run as an MP4: H.264, 1280 × 720, 30 frames a second.

    A path that ends in ``.gif`` or ``.webp`` makes an animated picture instead: 640 × 360, 10
    frames a second, for pages that play no films.

    The same run gives the same bytes. Frames are handed on one by one; whatever interrupts the
    work, no unfinished file takes the place of ``path``.

    Args:
        trajectory: The run. Two to four of them make one film, in step: a race.
        path: The file to write.
        speed: Seconds of the run in one second of video, 0.1 to 100.
        small: Half as wide and high, in an eighth of the bytes or so; an animated picture is so
            unless it is given a size.
        size: Width and height (pixels), even, each from 240 to 3840.
        fps: Frames a second, at most 120; of an animated picture at most 50.
        start: Time of the run at which the film begins (s).
        end: Time of the run at which it ends (s): it has ``(end - start) · fps / speed`` frames.
            Without, or if the run ends before, it closes with the outcome for a second.
        view: What is shown: ``explain``, ``scene``, ``follow``, ``map``, or one of your own
            (``register_view``).
        names: What the runs of a race are called; by default their planners' names.
        progress: Called after each frame with the number of frames done and in total.

    Raises:
        UserError: If an argument is out of range, the path ends otherwise, ffmpeg is missing or
            fails, or the file cannot be written.
    """
    path = Path(path)
    ending = path.suffix.lower()
    film = Filming(view, size, fps, speed, start, end)
    check_ending(path)
    rate = fps or (FPS if ending == ".mp4" else ANIMATION_FPS)
    if ending != ".mp4" and rate > MOST_ANIMATION_FPS:
        raise UserError(f"{path}: an animated picture has at most {MOST_ANIMATION_FPS} fps")
    runs = [trajectory] if isinstance(trajectory, Trajectory) else trajectory
    film.check_begins(max((float(run.ticks.time[-1]) for run in runs), default=math.inf))
    half = small or (ending != ".mp4" and size is None)
    told = progress or (lambda done, total: None)
    with (
        written_beside(path) as part,
        _compositor(trajectory, speed, view, size, names) as compositor,
    ):
        wide, high = compositor.size
        count = film.count(compositor.start, compositor.end, rate)
        shown = (wide // 2, high // 2) if half else (wide, high)
        frames = enumerate(film.times(compositor.start, compositor.end, rate), start=1)
        if ending == ".mp4":
            buffer = FrameBuffer(compositor.size)
            with Encoder(part, path, size=compositor.size, small=half, fps=rate) as encoder:
                for number, time in frames:
                    buffer.apply(compositor.at(time))
                    encoder.write(buffer)
                    told(number, count)
        else:
            with Animation(part, path, compositor.size, shown, rate, count) as picture:
                for number, time in frames:
                    picture.write(compositor.at(time))
                    told(number, count)
    return VideoInfo(count, count / rate, shown)


def frame(
    trajectory: Trajectory | Sequence[Trajectory],
    time: float,
    *,
    size: tuple[int, int] | None = None,
    view: str = EXPLAIN,
    names: Sequence[str] | None = None,
) -> NDArray[np.uint8]:
    """Return the frame of a run at a time (s) as a picture; after its end, the one that closes it.

    It is the picture that a film of the run has at that time, for a notebook for example::

        from PIL import Image

        Image.fromarray(frame(trajectory, 5.0))

    Args:
        trajectory: The run, or those of a race.
        time: Seconds since its start; before its start, the first frame.
        size: Width and height (pixels), even, each from 240 to 3840; 1280 × 720 by default.
        view: What is shown; see ``record``.
        names: What the runs of a race are called.

    Returns:
        Red, green and blue from 0 to 255, shape (height, width, 3).

    Raises:
        UserError: If the time is not a number, or another argument is out of range.
    """
    if math.isnan(time):
        raise UserError("the time of a frame must be a number of seconds")
    Filming(view, size)
    with _compositor(trajectory, 1.0, view, size, names) as compositor:
        image = Image.new("RGB", compositor.size, PAGE)
        for region in compositor.at(time):
            image.paste(region.image, (region.x, region.y))
    return np.array(image)


def write_still(
    trajectory: Trajectory | Sequence[Trajectory],
    path: Path,
    time: float,
    *,
    size: tuple[int, int] | None = None,
    view: str = EXPLAIN,
    names: Sequence[str] | None = None,
) -> None:
    """Write the frame at a time (s) as a picture (PNG); see ``frame``.

    Raises:
        UserError: If it cannot be made, or written.
    """
    picture = frame(trajectory, time, size=size, view=view, names=names)
    with written_beside(path) as part:
        iio.imwrite(part, picture, extension=".png")


def moments(timeline: Timeline, speed: float, fps: int = FPS) -> Iterator[Moment]:
    """Yield the moment of each frame: the run, then its end for as long as the outcome is shown."""
    for time in Filming(speed=speed).times(timeline.start, timeline.end, fps):
        moment = timeline.at(time)
        yield closing(moment) if time > timeline.end else moment


def check_ending(path: Path) -> None:
    """Check that a film can have this name.

    Raises:
        UserError: If it does not end as films and animated pictures do.
    """
    if path.suffix.lower() not in (".mp4", *ANIMATION_ENDINGS):
        raise UserError(
            f"{path}: a film ends in .mp4, an animated picture in {' or '.join(ANIMATION_ENDINGS)}"
        )


def _compositor(
    trajectory: Trajectory | Sequence[Trajectory],
    speed: float,
    view: str,
    size: tuple[int, int] | None,
    names: Sequence[str] | None,
) -> Compositor | Race:
    if isinstance(trajectory, Trajectory):
        return Compositor(trajectory, speed, view, size)
    return Race(trajectory, speed, view, size, names)
