"""``fuzzyq export``: a record in forms that other programs read."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from fuzzyq_bullet.cli.options import FOLDER, PluginOption, ReplaceOption
from fuzzyq_bullet.errors import UserError

if TYPE_CHECKING:
    from fuzzyq_bullet.recording.trajectory import Trajectory

GROUPS: tuple[Literal["ticks", "decisions"], ...] = ("ticks", "decisions")


def export(
    trajectory: Annotated[
        Path, typer.Argument(metavar="TRAJECTORY", help="A record (.npz) written by a run.")
    ],
    *,
    csv: Annotated[
        bool,
        typer.Option("--csv", help="NAME-ticks.csv, NAME-decisions.csv; NAME-movers.csv if any."),
    ] = False,
    mcap: Annotated[
        bool, typer.Option("--mcap", help="NAME.mcap, for Foxglove (extra mcap).")
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(help="Folder to write into; by default that of the record.", **FOLDER),
    ] = None,
    plugin: PluginOption = None,
    replace: ReplaceOption = False,
) -> None:
    """Write a record as CSV, as MCAP, or both.

    CSV: what the robot did at every tick, every decision, and where moving obstacles were, if
    there are any; the unit of a column stands in brackets in its heading. MCAP: scene, robot,
    detection lines, ticks, decisions and events over simulated time, to be played in Foxglove.
    What all of it means: docs/reference/record.md.

    Raises:
        UserError: If no form is asked for, its extra is missing, the record cannot be read, or a
            file cannot be written.
    """
    if not (csv or mcap):
        raise UserError("nothing to export: --csv or --mcap says in which form")
    from fuzzyq_bullet.files import refuse_inputs, writable_files, written_beside
    from fuzzyq_bullet.outputs import plugin_inputs, refuse_other_run
    from fuzzyq_bullet.recording.moving import movers_csv
    from fuzzyq_bullet.recording.trajectory import Trajectory

    record = Trajectory.load(trajectory)
    has_movers = csv and bool(record.movers.size)
    name, folder = trajectory.stem, out or trajectory.parent
    names = [f"{name}-{group}.csv" for group in GROUPS if csv]
    names += [f"{name}-movers.csv"] * has_movers + [f"{name}.mcap"] * mcap
    paths = writable_files(folder, names)
    refuse_inputs(paths, [trajectory, *plugin_inputs(plugin or [])])
    if not replace and not folder.samefile(trajectory.parent):
        refuse_other_run(folder / f"{name}.npz", paths, record.scenario)
    contents = [record.csv(group, units=True).encode() for group in GROUPS if csv]
    if has_movers:
        contents.append(movers_csv(record, units=True).encode())
    if mcap:
        contents.append(_mcap(record))
    for path, content in zip(paths, contents, strict=True):
        with written_beside(path) as part:
            part.write_bytes(content)
        typer.echo(path)


def _mcap(record: Trajectory) -> bytes:
    try:
        from fuzzyq_bullet.export.mcap import mcap_of
    except ImportError as error:
        raise UserError(
            "--mcap: foxglove-sdk is not installed: pip install 'fuzzyq_bullet[mcap]'"
        ) from error
    return mcap_of(record)
