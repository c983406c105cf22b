"""The option ``--plugin``: modules of the user's own, such as those that register planners."""

from __future__ import annotations

from typing import Annotated, TypeAlias

import typer

PluginOption: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(metavar="MODULE", help="Python module or file to import first (repeatable)."),
]
