"""``fuzzyq replay``: the video of a record, made again."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fuzzyq_bullet.cli.film import ReplaceOption, SpeedOption, film, film_name
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
    replace: ReplaceOption = False,
) -> None:
    """Make the video NAME.mp4 from a record, without running anything again.

    At a speed other than 1 it is called by that: NAME-4x.mp4.

    Raises:
        UserError: If the record cannot be read, or the video cannot be written.
    """
    from fuzzyq_bullet.files import refuse_inputs, writable_files
    from fuzzyq_bullet.outputs import plugin_inputs, refuse_other_run
    from fuzzyq_bullet.trajectory import Trajectory

    record = Trajectory.load(trajectory)
    folder = out or trajectory.parent
    (video,) = writable_files(folder, [film_name(trajectory.stem, speed)])
    refuse_inputs([video], [trajectory, *plugin_inputs(plugin or [])])
    if not replace and not folder.samefile(trajectory.parent):
        refuse_other_run(folder / f"{trajectory.stem}.npz", [video], record.scenario)
    typer.echo(film(record, video, speed))
