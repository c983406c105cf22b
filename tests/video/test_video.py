"""A record becomes an MP4 that anything plays, and never half of one."""

from __future__ import annotations

import re
import subprocess
import tracemalloc
from typing import TYPE_CHECKING, Any

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image

import fuzzyq_bullet
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.video import encoders as encoder_module
from fuzzyq_bullet.video import frame, record, style
from fuzzyq_bullet.video.encoders import Encoder, FrameBuffer
from fuzzyq_bullet.video.paint import DirtyRegion
from fuzzyq_bullet.video.scene import scene
from fuzzyq_bullet.video.scene.still import photograph
from tests.helpers.synthetic import drive, scenario, standing

if TYPE_CHECKING:
    from pathlib import Path

    from fuzzyq_bullet.recording.trajectory import Trajectory


pytestmark = pytest.mark.usefixtures("still_once")


def ffmpeg() -> str:
    return str(imageio_ffmpeg.get_ffmpeg_exe())


def decoded(path: Path) -> np.ndarray[Any, np.dtype[np.uint8]]:
    """Return all frames of a video, shape (N, 720, 1280, 3)."""
    raw = subprocess.run(
        [
            ffmpeg(),
            "-loglevel",
            "error",
            "-i",
            str(path),
            "-f",
            "rawvideo",
            "-pix_fmt",
            "rgb24",
            "-",
        ],
        capture_output=True,
        check=True,
    ).stdout
    return np.frombuffer(raw, dtype=np.uint8).reshape(-1, 720, 1280, 3)


@pytest.fixture(scope="module")
def short() -> Trajectory:
    # A part of a large arena: ground fills the scene, and no flat colour most of the frame.
    return drive(scenario(size=(20.0, 20.0)), seconds=1.5, outcome="timeout")


@pytest.fixture(scope="module")
def made(short: Trajectory, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("video") / "run.mp4"
    info = record(short, path)
    assert info == (46 + 30, pytest.approx(76 / 30), (1280, 720))
    return path


@pytest.fixture(scope="module")
def shown(made: Path) -> np.ndarray[Any, np.dtype[np.uint8]]:
    return decoded(made)


@pytest.mark.slow
def test_decoded_video_has_the_promised_frames_size_and_duration(
    made: Path, shown: np.ndarray[Any, Any]
) -> None:
    assert shown.shape == (76, 720, 1280, 3)
    told = subprocess.run([ffmpeg(), "-i", str(made)], capture_output=True, text=True).stderr
    assert re.search(r"Video: h264 .*yuv420p\(tv, bt709.*1280x720.* 30 fps", told)
    assert "Duration: 00:00:02.53" in told
    assert told.count("Stream #") == 1


def test_a_browser_can_start_before_the_download_ends(made: Path) -> None:
    head = made.read_bytes()
    assert head.index(b"moov") < head.index(b"mdat")


@pytest.mark.slow
def test_the_same_run_gives_the_same_bytes(
    short: Trajectory, made: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(scene, "photograph", photograph)  # anew
    record(short, tmp_path / "again.mp4")
    assert (tmp_path / "again.mp4").read_bytes() == made.read_bytes()


def test_decoded_colours_are_those_that_were_drawn(
    short: Trajectory, shown: np.ndarray[Any, Any]
) -> None:
    drawn = np.asarray(frame(short, 1.0), dtype=int)
    shown = shown[30].astype(int)
    # The compression is lossy; a wrong colour matrix or range would shift everything.
    assert np.abs(shown.mean(axis=(0, 1)) - drawn.mean(axis=(0, 1))).max() < 2.5
    assert np.abs(shown - drawn).mean() < 2.0


def test_a_frame_is_an_array_that_belongs_to_the_caller(short: Trajectory) -> None:
    first = fuzzyq_bullet.frame(short, 0.5)
    assert (first.shape, first.dtype) == ((720, 1280, 3), np.uint8)
    again = frame(short, 0.5)
    assert (first == again).all()
    first[:] = 0
    assert again.any()


def test_every_colour_comes_out_as_it_went_in(tmp_path: Path) -> None:
    colours = [*style.LINES, style.GOAL, style.GROUND, style.TEXT, (0, 0, 0), (255, 255, 255)]
    buffer = FrameBuffer()
    buffer.apply(
        DirtyRegion(100 * number, 0, Image.new("RGB", (100, 720), colour))
        for number, colour in enumerate(colours)
    )
    with Encoder(tmp_path / "x.mp4") as encoder:
        for _ in range(3):
            encoder.write(buffer)
    shown = decoded(tmp_path / "x.mp4")[1]
    for number, colour in enumerate(colours):
        assert shown[300, 100 * number + 50] == pytest.approx(colour, abs=4)


def test_it_closes_on_the_outcome_for_a_second(shown: np.ndarray[Any, Any]) -> None:
    card = np.s_[60:190, 300:600]
    before = shown[45][card].astype(int)
    closing = [image[card].astype(int) for image in shown[46:]]
    assert len(closing) == 30
    assert all(np.abs(image - before).mean() > 10 for image in closing)


@pytest.mark.slow
@pytest.mark.parametrize(("speed", "frames"), [(0.5, 91), (10.0, 5), (100.0, 1)])
def test_speed_scales_time(short: Trajectory, tmp_path: Path, speed: float, frames: int) -> None:
    assert record(short, tmp_path / "x.mp4", speed=speed).frames == frames + 30


@pytest.mark.parametrize("speed", [0.0, -1.0, 0.05, 101.0, float("nan"), float("inf")])
def test_absurd_speeds_are_the_users_mistake(
    short: Trajectory, tmp_path: Path, speed: float
) -> None:
    with pytest.raises(UserError, match="speed"):
        record(short, tmp_path / "x.mp4", speed=speed)


def test_progress_counts_every_frame(short: Trajectory, tmp_path: Path) -> None:
    seen: list[tuple[int, int]] = []
    record(short, tmp_path / "x.mp4", speed=2.0, progress=lambda *args: seen.append(args))
    assert seen == [(number, 53) for number in range(1, 54)]


class Spy:
    """Remembers the processes that the encoder started."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.started: list[subprocess.Popen[bytes]] = []
        real = subprocess.Popen

        def popen(*args: Any, **kwargs: Any) -> subprocess.Popen[bytes]:
            self.started.append(real(*args, **kwargs))
            return self.started[-1]

        monkeypatch.setattr(encoder_module.subprocess, "Popen", popen)

    def all_ended(self) -> bool:
        return bool(self.started) and all(one.returncode is not None for one in self.started)


@pytest.mark.parametrize("trouble", [KeyboardInterrupt, RuntimeError])
def test_an_interrupted_recording_leaves_the_old_file_and_nothing_else(
    short: Trajectory,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    trouble: type[BaseException],
) -> None:
    spy = Spy(monkeypatch)
    path = tmp_path / "run.mp4"
    path.write_bytes(b"a good one")

    def stop(done: int, _: int) -> None:
        if done == 20:
            raise trouble

    with pytest.raises(trouble):
        record(short, path, progress=stop)
    assert path.read_bytes() == b"a good one"
    assert [entry.name for entry in tmp_path.iterdir()] == ["run.mp4"]
    assert spy.all_ended()


def _false_ffmpeg(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, script: str) -> None:
    program = tmp_path / "ffmpeg"
    program.write_text(f"#!/bin/sh\n{script}\n")
    program.chmod(0o755)
    monkeypatch.setattr(imageio_ffmpeg, "get_ffmpeg_exe", lambda: str(program))


@pytest.mark.parametrize("when", ["at once", "at the end"])
def test_a_full_disk_is_one_line(
    short: Trajectory, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, when: str
) -> None:
    wait = "head -c 100 > /dev/null" if when == "at once" else "cat > /dev/null"
    say = "echo 'Error writing trailer: No space left on device' >&2"
    _false_ffmpeg(tmp_path, monkeypatch, f"{wait}; {say}; echo 'Conversion failed!' >&2; exit 1")
    spy = Spy(monkeypatch)
    out = tmp_path / "out"
    out.mkdir()
    with pytest.raises(UserError, match="No space left on device") as caught:
        record(short, out / "run.mp4")
    assert len(caught.value.problems) == 1
    assert "\n" not in str(caught.value)
    assert str(out / "run.mp4") in str(caught.value)
    assert list(out.iterdir()) == []
    assert spy.all_ended()


def test_without_ffmpeg_the_user_is_told_what_to_install(
    short: Trajectory, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing() -> str:
        raise RuntimeError("No ffmpeg exe could be found.")

    monkeypatch.setattr(imageio_ffmpeg, "get_ffmpeg_exe", missing)
    with pytest.raises(UserError, match="install imageio-ffmpeg"):
        record(short, tmp_path / "run.mp4")
    monkeypatch.setattr(imageio_ffmpeg, "get_ffmpeg_exe", lambda: str(tmp_path / "none"))
    with pytest.raises(UserError, match="cannot be started"):
        record(short, tmp_path / "run.mp4")
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_is_not_there_is_one_line(short: Trajectory, tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"no/run\.mp4"):
        record(short, tmp_path / "no" / "run.mp4")


def test_names_that_look_like_options_or_patterns_are_names(
    short: Trajectory, tmp_path: Path
) -> None:
    record(short, tmp_path / "-i pipe:%03d.mp4", speed=100.0)
    assert (tmp_path / "-i pipe:%03d.mp4").stat().st_size > 1000


@pytest.mark.slow
def test_memory_does_not_grow_with_the_run(tmp_path: Path) -> None:
    world = scenario(5, 0)

    def peak(run: Trajectory) -> int:
        record(run, tmp_path / "x.mp4")  # fonts and other things kept once
        tracemalloc.start()
        try:
            record(run, tmp_path / "x.mp4")
            return tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()

    brief, long = peak(standing(0.1, world)), peak(standing(0.5, world))
    assert long < brief + 700_000  # 12 frames more, of which a single one is 1.4 MB


def test_the_encoder_writes_every_byte_of_every_frame(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    _false_ffmpeg(tmp_path, monkeypatch, f"wc -c > {tmp_path}/count")
    with Encoder(tmp_path / "x.mp4") as encoder:
        for _ in range(7):
            encoder.write(FrameBuffer())
    assert int(re.findall(r"\d+", (tmp_path / "count").read_text())[0]) == 7 * 1280 * 720 * 3 // 2
