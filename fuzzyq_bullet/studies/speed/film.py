"""How fast a film is made: against the encoder alone, real time, and with the run before it."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from statistics import median
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.episode import run
from fuzzyq_bullet.planning import ImprovedFuzzySettings
from fuzzyq_bullet.recording.trajectory import Trajectory
from fuzzyq_bullet.scenario import Goal, Limits, Random, Scenario, Start
from fuzzyq_bullet.studies.speed import Row, interleaved, median_ratio
from fuzzyq_bullet.video import record
from fuzzyq_bullet.video.compositor import Compositor
from fuzzyq_bullet.video.encoders import Encoder, FrameBuffer
from fuzzyq_bullet.video.record import moments
from fuzzyq_bullet.video.timeline import Timeline

_LARGE = (1920, 1080)
Frames: TypeAlias = NDArray[np.uint8]


def film(rounds: int, rate: int) -> list[Row]:
    """Return how fast a film is made of a run among 125 obstacles.

    By the clock on the wall: ffmpeg works in a process of its own.
    """
    trajectory = _trajectory()
    with tempfile.TemporaryDirectory(prefix="fuzzyq-") as name:
        folder = Path(name)
        info = record(trajectory, folder / "pipeline.mp4")
        frames = _ready_made(trajectory, folder / "frames.raw", info.frames)
        works: list[Callable[[], object]] = [
            partial(record, trajectory, folder / "pipeline.mp4"),
            partial(_encode, frames, folder / "encoding.mp4"),
            partial(record, trajectory, folder / "large.mp4", size=_LARGE),
        ]
        pipeline, encoding, large = interleaved(works, rounds, clock=time.perf_counter)
    return [
        Row(
            "film against encoding ready-made frames",
            median_ratio(encoding, pipeline),
            0.7,
            "at least",
            f"{info.frames / median(pipeline):.0f} frames/s against "
            f"{info.frames / median(encoding):.0f}",
        ),
        Row(
            "film against real time, 720p",
            info.seconds / median(pipeline),
            6.0,
            "at least",
            f"{info.seconds:.1f} s of film in {median(pipeline):.1f} s",
        ),
        Row(
            "film against real time, 1080p",
            info.seconds / median(large),
            2.5,
            "at least",
            f"{info.seconds:.1f} s of film in {median(large):.1f} s, "
            f"{median_ratio(large, pipeline):.2f} times as long as at 720p",
        ),
    ]


def whole_run(rounds: int, rate: int) -> list[Row]:
    """Return how long a person waits for ``fuzzyq run``."""
    taken = []
    with tempfile.TemporaryDirectory(prefix="fuzzyq-") as name:
        words = ["-m", "fuzzyq_bullet", "run", "mixed", "--replace", "--out", name]
        for _ in range(min(rounds, 3)):
            start = time.perf_counter()
            subprocess.run([sys.executable, *words], capture_output=True, check=True)
            taken.append(time.perf_counter() - start)
        seconds = record(
            Trajectory.load(Path(name) / "mixed.npz"), Path(name) / "again.mp4"
        ).seconds
    return [
        Row(
            "fuzzyq run mixed, start to finished film, against the film's length",
            seconds / median(taken),
            5.0,
            "at least",
            f"{seconds:.1f} s of film in {median(taken):.1f} s",
        )
    ]


def _trajectory() -> Trajectory:
    return run(
        Scenario(
            name="video-speed",
            seed=4,
            start=Start(position=(1.0, 1.0)),
            goal=Goal(position=(9.0, 9.0)),
            planner=ImprovedFuzzySettings(weights=(1.0, 1.0)),
            random=Random(count=125),
            limits=Limits(time=30.0),
        )
    )


def _ready_made(trajectory: Trajectory, path: Path, count: int) -> Frames:
    buffer = FrameBuffer()
    frames: Frames = np.memmap(path, dtype=np.uint8, mode="w+", shape=(count, buffer.planes.size))
    with Compositor(trajectory) as compositor:
        for k, moment in enumerate(moments(Timeline(trajectory), 1.0)):
            buffer.apply(compositor.changes(moment))
            frames[k] = buffer.planes
    return frames


def _encode(frames: Frames, path: Path) -> None:
    buffer = FrameBuffer()
    with Encoder(path) as encoder:
        for planes in frames:
            buffer.planes = planes
            encoder.write(buffer)
