"""``fuzzyq replay``: the video of a record, made again."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fuzzyq_bullet.cli.film import SpeedOption, film, film_name
from fuzzyq_bullet.cli.folder import FOLDER
from fuzzyq_bullet.cli.plugin import PluginOption


def replay(
    trajectory: Annotated[
        Path, typer.Argument(metavar="TRAJECTORY", help="A record (.npz) written by a run.")
    ],
    *,
    out: Annotated[
        Path | None,
        typer.Option(help="Folder to write into; by default that of the record.", **FOLDER),
    ] = None,
    speed: SpeedOption = 1.0,
    plugin: PluginOption = None,
) -> None:
    """Make the video NAME.mp4 from a record, without running anything again.

    At a speed other than 1 it is called by that: NAME-4x.mp4.

    Raises:
        UserError: If the record cannot be read, or the video cannot be written.
    """
    from fuzzyq_bullet.checks.plugins import load_plugins
    from fuzzyq_bullet.errors import UserError
    from fuzzyq_bullet.files import writable_files
    from fuzzyq_bullet.trajectory import Trajectory

    load_plugins(plugin or [])
    record = Trajectory.load(trajectory)
    (video,) = writable_files(out or trajectory.parent, [film_name(trajectory.stem, speed)])
    if video == trajectory:
        raise UserError(f"{trajectory}: its own video would replace it; call it NAME.npz")
    typer.echo(film(record, video, speed))
