"""Raw frames in, H.264 in an MP4 out: ffmpeg as a child process that is never left behind."""

from __future__ import annotations

import subprocess
import tempfile
from contextlib import suppress
from typing import IO, TYPE_CHECKING

import imageio_ffmpeg

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.video.style import FPS, HEIGHT, WIDTH

if TYPE_CHECKING:
    from pathlib import Path

    from fuzzyq_bullet.video.film import Film

_PIPE_BYTES = 1 << 20
"""The most that Linux grants to everyone."""


class Encoder:
    """Writes one MP4. Leaving the block in peace finishes it; an exception kills ffmpeg.

    Args:
        path: Where the file is to be written.
        name: What to call it in messages; by default its path.
        small: Half as wide and half as high, for a page with many films.

    Raises:
        UserError: If ffmpeg is missing, cannot be started, or fails (a full disk, for example).
    """

    def __init__(self, path: Path, name: Path | None = None, *, small: bool = False) -> None:
        self._path = path
        self._small = small
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
                [program, *_arguments(self._path, self._small)],
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

    def write(self, film: Film) -> None:
        """Append the frame that the film holds now."""
        assert self._process.stdin is not None
        left = memoryview(film.planes.data).cast("B")
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


def _widen(pipe: IO[bytes] | None) -> None:
    """Let a pipe hold most of a frame, where the system can: fewer turns between two programs."""
    with suppress(ImportError, AttributeError, OSError):
        import fcntl

        assert pipe is not None
        fcntl.fcntl(pipe, fcntl.F_SETPIPE_SZ, _PIPE_BYTES)


def _arguments(path: Path, small: bool) -> list[str]:
    # The film's colours are those of HDTV. Output tags alone would make ffmpeg convert to them.
    colours = ["-color_range", "tv", "-colorspace", "bt709"]
    colours += ["-color_primaries", "bt709", "-color_trc", "bt709"]
    # An eighth of the bytes: a slower preset for the few pixels, and a little less quality.
    size = ["-vf", f"scale={WIDTH // 2}:{HEIGHT // 2}:flags=area"] if small else []
    quality = ["-preset", "slow", "-crf", "25"] if small else ["-preset", "veryfast", "-crf", "20"]
    return [
        *("-hide_banner", "-loglevel", "error", "-nostats", "-y"),
        *("-f", "rawvideo", "-pix_fmt", "yuv420p", "-s", f"{WIDTH}x{HEIGHT}", "-r", str(FPS)),
        *(*colours, "-i", "pipe:0", *size, *colours, "-an", "-map_metadata", "-1"),
        *("-c:v", "libx264", *quality, "-pix_fmt", "yuv420p"),
        # A fixed number of threads: the same bytes on machines of any number of cores.
        *("-threads", "4", "-flags", "+bitexact", "-fflags", "+bitexact"),
        *("-movflags", "+faststart", "-f", "mp4", f"file:{path}"),
    ]
