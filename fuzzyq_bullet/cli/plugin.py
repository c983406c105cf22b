"""The option ``--plugin``: modules of the user's own, such as those that register planners."""

from __future__ import annotations

from typing import Annotated, TypeAlias

import typer


def _load(names: list[str] | None) -> list[str] | None:
    """Import the modules while the command line is read, before anything else is done."""
    from fuzzyq_bullet.plugins import load_plugins

    load_plugins(names or [])
    return names


PluginOption: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(
        metavar="MODULE",
        callback=_load,
        help="Python module or file to import first (repeatable).",
    ),
]
