"""``fuzzyq export``: a record in forms that other programs read."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from fuzzyq_bullet.cli.options import FOLDER, PluginOption, ReplaceOption
from fuzzyq_bullet.errors import UserError

GROUPS: tuple[Literal["ticks", "decisions"], ...] = ("ticks", "decisions")


def export(
    trajectory: Annotated[
        Path, typer.Argument(metavar="TRAJECTORY", help="A record (.npz) written by a run.")
    ],
    *,
    csv: Annotated[
        bool, typer.Option("--csv", help="NAME-ticks.csv and NAME-decisions.csv.")
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(help="Folder to write into; by default that of the record.", **FOLDER),
    ] = None,
    plugin: PluginOption = None,
    replace: ReplaceOption = False,
) -> None:
    """Write a record as CSV: what the robot did at every tick, and every decision.

    The unit of a column stands in brackets in its heading. What the columns mean: docs/record.md.

    Raises:
        UserError: If no form is asked for, the record cannot be read, or a file cannot be written.
    """
    if not csv:
        raise UserError("nothing to export: --csv says in which form")
    from fuzzyq_bullet.files import refuse_inputs, writable_files, write_text
    from fuzzyq_bullet.outputs import plugin_inputs, refuse_other_run
    from fuzzyq_bullet.trajectory import Trajectory

    record = Trajectory.load(trajectory)
    folder = out or trajectory.parent
    paths = writable_files(folder, [f"{trajectory.stem}-{group}.csv" for group in GROUPS])
    refuse_inputs(paths, [trajectory, *plugin_inputs(plugin or [])])
    if not replace and not folder.samefile(trajectory.parent):
        refuse_other_run(folder / f"{trajectory.stem}.npz", paths, record.scenario)
    for path, group in zip(paths, GROUPS, strict=True):
        write_text(path, record.csv(group, units=True))
        typer.echo(path)
