"""Making the video with a progress bar: what ``run`` and ``replay`` share about it."""

from __future__ import annotations

import re
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

ReplaceOption: TypeAlias = Annotated[
    bool, typer.Option("--replace", help="Replace files of another run of that name.")
]


def film_name(name: str, speed: float) -> str:
    """Return ``NAME.mp4``, or ``NAME-4x.mp4``: a film at another speed replaces no other."""
    factor = f"{speed:g}"
    return f"{name}.mp4" if factor == "1" else f"{name}-{factor}x.mp4"


def films_of(folder: Path, name: str) -> list[Path]:
    """Return the films in a folder that ``film_name`` gives this name, at whatever speed."""
    films = re.compile(rf"{re.escape(name)}(-[0-9.]+x)?\.mp4")
    try:
        return sorted(path for path in folder.iterdir() if films.fullmatch(path.name))
    except OSError:  # a folder that may be written to, and not be looked into
        return []


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
