"""``fuzzyq figure``: draw one of the paper's figures again, from this project's own code."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fuzzyq_bullet.cli.options import FOLDER, PluginOption, ReplaceOthersOption
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.experiments.figures import FIGURES, MARK, drawing


def figure(
    number: Annotated[
        int, typer.Argument(metavar="NUMBER", help="Number of the figure in the paper.")
    ],
    out: Annotated[Path, typer.Option(help="Folder to write into.", **FOLDER)] = Path("out"),
    plugin: PluginOption = None,
    replace: ReplaceOthersOption = False,
) -> None:
    """Draw a figure of the paper and print the files written.

    Raises:
        UserError: If no figure has this number, or the file cannot be written, or is there and no
            figure of this command's.
    """
    from fuzzyq_bullet.files import refuse_inputs
    from fuzzyq_bullet.outputs import plugin_inputs, refuse_others_file

    if number not in FIGURES:
        known = "; ".join(f"{key} ({entry.shows})" for key, entry in sorted(FIGURES.items()))
        raise UserError(f"NUMBER: no figure {number}; there are: {known}")
    target = out / f"figure{number}.png"
    refuse_inputs([target], plugin_inputs(plugin or []))
    if not replace:
        refuse_others_file(target, MARK)
    for path in drawing(number)(out):
        typer.echo(path)
