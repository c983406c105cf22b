"""How fast a film is made: against the encoder alone, and against real time."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.episode import run
from fuzzyq_bullet.experiments.timing import interleaved
from fuzzyq_bullet.planning import ImprovedFuzzySettings
from fuzzyq_bullet.scenario import Goal, Limits, Random, Scenario, Start
from fuzzyq_bullet.trajectory import Trajectory
from fuzzyq_bullet.video import record
from fuzzyq_bullet.video.compositor import Compositor
from fuzzyq_bullet.video.encoders import Encoder, FrameBuffer
from fuzzyq_bullet.video.record import moments
from fuzzyq_bullet.video.timeline import Timeline

Frames: TypeAlias = NDArray[np.uint8]


@dataclass(frozen=True)
class VideoTimes:
    """Times by the clock on the wall (s), one a round; ffmpeg works in a process of its own.

    Attributes:
        frames: Frames of the video.
        seconds: How long it plays (s).
        pipeline: Making the whole video from a record.
        encoding: Only encoding its frames, which lie ready.
    """

    frames: int
    seconds: float
    pipeline: list[float]
    encoding: list[float]


def compare(rounds: int) -> VideoTimes:
    """Time both over the same run among 125 obstacles, in turn."""
    trajectory = _trajectory()
    with tempfile.TemporaryDirectory(prefix="fuzzyq-") as name:
        folder = Path(name)
        info = record(trajectory, folder / "pipeline.mp4")
        frames = _ready_made(trajectory, folder / "frames.raw", info.frames)
        works: list[Callable[[], object]] = [
            partial(record, trajectory, folder / "pipeline.mp4"),
            partial(_encode, frames, folder / "encoding.mp4"),
        ]
        pipeline, encoding = interleaved(works, rounds, clock=time.perf_counter)
    return VideoTimes(info.frames, info.seconds, pipeline, encoding)


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
