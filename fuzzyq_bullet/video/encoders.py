"""Frames in, a file out: H.264 in an MP4 by ffmpeg, or an animated picture (GIF, WebP)."""

from __future__ import annotations

import subprocess
import tempfile
from contextlib import suppress
from itertools import pairwise
from typing import IO, TYPE_CHECKING, Any, TypeAlias

import imageio_ffmpeg
import numpy as np
from PIL import Image

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.filming import FPS
from fuzzyq_bullet.video.paint import DirtyRegion
from fuzzyq_bullet.video.style import HEIGHT, PAGE, WIDTH

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

Size: TypeAlias = tuple[int, int]

_PIPE_BYTES = 1 << 20
"""The most that Linux grants to everyone."""
ANIMATION_ENDINGS = (".gif", ".webp")
_MOST_BYTES = 1_000_000_000
"""What the frames of an animated picture may take in memory."""
_OPTIONS: dict[str, dict[str, Any]] = {
    ".gif": {"optimize": True},
    ".webp": {"quality": 55, "method": 4},
}


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


class FrameBuffer:
    """One frame as the encoder wants it (YUV 4:2:0), changed in place, only where it changed.

    Converting only what changed is an order of magnitude less work than letting ffmpeg convert
    every whole frame from RGB, and the frame is half as many bytes to hand over.

    Args:
        size: Width and height (pixels), both even.

    Attributes:
        planes: Y, then U, then V at half the resolution; uint8, contiguous.
    """

    def __init__(self, size: Size = (WIDTH, HEIGHT)) -> None:
        width, height = size
        self.planes = np.empty(width * height * 3 // 2, dtype=np.uint8)
        luma, chroma = width * height, width * height // 4
        self._y = self.planes[:luma].reshape(height, width)
        self._u = self.planes[luma : luma + chroma].reshape(height // 2, width // 2)
        self._v = self.planes[luma + chroma :].reshape(height // 2, width // 2)
        self.apply([DirtyRegion(0, 0, Image.new("RGB", size, PAGE))])

    def apply(self, changes: Iterable[DirtyRegion]) -> None:
        """Put what changed into the frame."""
        for x, y, image in changes:
            width, height = image.size
            converted = image.convert("RGB", _BT709)
            half = np.asarray(converted.reduce(2))
            rows, columns = slice(y // 2, (y + height) // 2), slice(x // 2, (x + width) // 2)
            self._y[y : y + height, x : x + width] = np.asarray(converted)[..., 0]
            self._u[rows, columns] = half[..., 1]
            self._v[rows, columns] = half[..., 2]


class Encoder:
    """Writes one MP4. Leaving the block in peace finishes it; an exception kills ffmpeg.

    Args:
        path: Where the file is to be written.
        name: What to call it in messages; by default its path.
        size: Width and height of the frames (pixels).
        small: Half as wide and half as high, for a page with many films.
        fps: Frames a second.

    Raises:
        UserError: If ffmpeg is missing, cannot be started, or fails (a full disk, for example).
    """

    def __init__(
        self,
        path: Path,
        name: Path | None = None,
        *,
        size: Size = (WIDTH, HEIGHT),
        small: bool = False,
        fps: int = FPS,
    ) -> None:
        self._path = path
        self._size, self._small, self._fps = size, small, fps
        self._name = name or path

    def __enter__(self) -> Encoder:
        try:
            program = imageio_ffmpeg.get_ffmpeg_exe()
        except RuntimeError as error:
            raise UserError(
                "ffmpeg is missing: install imageio-ffmpeg again, or set IMAGEIO_FFMPEG_EXE"
            ) from error
        # A file, not a pipe: nobody reads it while frames are written, and a full pipe would block.
        self._complaints: IO[bytes] = tempfile.TemporaryFile()
        try:
            self._process = subprocess.Popen(
                [program, *_arguments(self._path, self._size, self._small, self._fps)],
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=self._complaints,
                bufsize=0,
                start_new_session=True,  # Ctrl-C is for us to handle; we end the child ourselves
            )
        except OSError as error:
            self._complaints.close()
            raise UserError(f"ffmpeg cannot be started: {error.strerror or error}") from error
        _widen(self._process.stdin)
        return self

    def write(self, frame: FrameBuffer) -> None:
        """Append the frame that the buffer holds now."""
        assert self._process.stdin is not None
        left = memoryview(frame.planes.data).cast("B")
        try:
            while left:  # a raw pipe may take less than it is given
                left = left[self._process.stdin.write(left) :]
        except OSError as error:
            raise self._failure() from error

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        try:
            if kind is None:
                self._close_input()
                if self._process.wait() != 0:
                    raise self._failure()
        finally:
            if self._process.poll() is None:
                self._process.kill()
            self._close_input()
            self._process.wait()
            self._complaints.close()

    def _close_input(self) -> None:
        assert self._process.stdin is not None
        with suppress(OSError):
            self._process.stdin.close()

    def _failure(self) -> UserError:
        """Return what to tell the user, in ffmpeg's own words."""
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(timeout=2.0)  # it is dying; let it say why
        self._complaints.seek(0)
        said = self._complaints.read()[-4000:].decode(errors="replace").splitlines()
        lines = [line.strip() for line in said if line.strip()]
        telling = [line for line in lines if "space left" in line or "denied" in line.lower()]
        why = (telling or lines or ["it stopped without a word"])[-1]
        return UserError(f"{self._name}: the video cannot be written: ffmpeg: {why}")


class Animation:
    """Writes one animated picture, which plays again and again.

    All frames are held in memory until the end: it is for short runs. Leaving the block in peace
    writes the file. Frames that are alike become one that is shown for longer.

    Args:
        path: Where the file is to be written; its ending chooses the kind.
        name: What to call it in messages.
        size: Width and height of the frames that are handed over (pixels).
        shown: Width and height of the picture (pixels).
        fps: Frames a second.
        count: How many frames there will be.

    Raises:
        UserError: If there would be more than memory has room for.
    """

    def __init__(
        self, path: Path, name: Path, size: Size, shown: Size, fps: int, count: int
    ) -> None:
        self._path, self._name, self._shown = path, name, shown
        self._gif = path.suffix.lower() == ".gif"
        if count * shown[0] * shown[1] * (1 if self._gif else 3) > _MOST_BYTES:
            raise UserError(
                f"{name}: too large for an animated picture: {count} frames of "
                f"{shown[0]}x{shown[1]}; make it smaller, or shorter, or a film (.mp4)"
            )
        # A GIF counts hundredths of a second: each frame ends at the nearest to its time.
        tick = 10 if self._gif else 1
        ends = [round(1000 / tick * number / fps) * tick for number in range(count + 1)]
        self._durations = [end - begin for begin, end in pairwise(ends)]
        self._frame = Image.new("RGB", size, PAGE)
        self._palette: Image.Image | None = None
        self._frames: list[Image.Image] = []

    def __enter__(self) -> Animation:
        return self

    def write(self, changes: Iterable[DirtyRegion]) -> None:
        """Append a frame: the one before, with these parts of it drawn anew."""
        for part in changes:
            self._frame.paste(part.image, (part.x, part.y))
        image = self._frame
        if image.size != self._shown:
            image = image.resize(self._shown, Image.Resampling.LANCZOS)
        if self._gif:
            # One palette for all frames: where nothing changes, they are the same to the bit.
            self._palette = self._palette or image.quantize(
                255, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE
            )
            image = image.quantize(palette=self._palette, dither=Image.Dither.NONE)
        self._frames.append(image if image is not self._frame else image.copy())

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is not None:
            return
        first, *others = self._frames
        try:
            first.save(
                self._path,
                save_all=True,
                append_images=others,
                duration=self._durations,
                loop=0,
                **_OPTIONS[self._path.suffix.lower()],
            )
        except (OSError, ValueError) as error:
            why = getattr(error, "strerror", None) or error
            raise UserError(f"{self._name}: cannot be written: {why}") from error


def _widen(pipe: IO[bytes] | None) -> None:
    """Let a pipe hold most of a frame, where the system can: fewer turns between two programs."""
    with suppress(ImportError, AttributeError, OSError):
        import fcntl

        assert pipe is not None
        fcntl.fcntl(pipe, fcntl.F_SETPIPE_SZ, _PIPE_BYTES)


def _arguments(path: Path, frame: Size, small: bool, fps: int) -> list[str]:
    # The film's colours are those of HDTV. Output tags alone would make ffmpeg convert to them.
    colours = ["-color_range", "tv", "-colorspace", "bt709"]
    colours += ["-color_primaries", "bt709", "-color_trc", "bt709"]
    # An eighth of the bytes: a slower preset for the few pixels, and a little less quality.
    size = ["-vf", f"scale={frame[0] // 2}:{frame[1] // 2}:flags=area"] if small else []
    # Most of a frame stands still: a plainer search for motion takes a third off the encoder's work
    # and adds 6 % to the file.
    swift = ["-preset", "veryfast", "-crf", "20", "-x264-params", "subme=1:me=dia"]
    quality = ["-preset", "slow", "-crf", "25"] if small else swift
    return [
        *("-hide_banner", "-loglevel", "error", "-nostats", "-y"),
        *("-f", "rawvideo", "-pix_fmt", "yuv420p", "-s", f"{frame[0]}x{frame[1]}", "-r", str(fps)),
        *(*colours, "-i", "pipe:0", *size, *colours, "-an", "-map_metadata", "-1"),
        *("-c:v", "libx264", *quality, "-pix_fmt", "yuv420p"),
        # A fixed number of threads: the same bytes on machines of any number of cores.
        *("-threads", "4", "-flags", "+bitexact", "-fflags", "+bitexact"),
        *("-movflags", "+faststart", "-f", "mp4", f"file:{path}"),
    ]
