"""``fuzzyq import``: a foreign map made into a scenario file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fuzzyq_bullet.cli.options import FILE, PluginOption


def import_map(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="A map; its suffix chooses the importer.")
    ],
    *,
    out: Annotated[
        Path | None,
        typer.Option(help="Scenario file to write; by default FILE as .yaml, here.", **FILE),
    ] = None,
    plugin: PluginOption = None,
    replace: Annotated[
        bool, typer.Option("--replace", help="Replace a file that is there already.")
    ] = False,
) -> None:
    """Make a scenario file from a map, and print its path.

    Raises:
        UserError: If there is no importer for the map, it is wrong, or the file cannot be written.
    """
    from fuzzyq_bullet.errors import UserError
    from fuzzyq_bullet.files import refuse_inputs, writable_files
    from fuzzyq_bullet.outputs import plugin_inputs
    from fuzzyq_bullet.scenario import save_scenario
    from fuzzyq_bullet.scenario.importers import import_map

    scenario = import_map(file)
    target = out or Path(f"{file.stem}.yaml")
    writable_files(target.parent, [target.name])
    refuse_inputs([target], [file, *plugin_inputs(plugin or [])])
    if target.exists() and not replace:
        raise UserError(f"{target}: is there already; --replace replaces it, --out names another")
    save_scenario(scenario, target)
    typer.echo(target)
