"""Making the video with a progress bar: what ``run`` and ``replay`` share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, TypeAlias

import typer

from fuzzyq_bullet.cli.console import progress_bar

if TYPE_CHECKING:
    from pathlib import Path

    from fuzzyq_bullet.trajectory import Trajectory

SLOWEST, FASTEST = 0.1, 100.0


def _check_speed(value: float) -> float:
    if not SLOWEST <= value <= FASTEST:
        raise typer.BadParameter(f"must be from {SLOWEST:g} to {FASTEST:g}, got {value:g}")
    return value


SpeedOption: TypeAlias = Annotated[
    float,
    typer.Option(help="Playback speed of the video; 1 is real time.", callback=_check_speed),
]


def film(trajectory: Trajectory, path: Path, speed: float) -> Path:
    """Record the video, showing how far it is, and return its path."""
    from fuzzyq_bullet.video import record

    with progress_bar("filming") as (progress, bar):
        record(
            trajectory,
            path,
            speed=speed,
            progress=lambda done, total: progress.update(
                bar, completed=done, total=total, note=f"{done} of {total} frames"
            ),
        )
    return path
