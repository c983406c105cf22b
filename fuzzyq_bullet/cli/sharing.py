"""Options that several commands have, each said once."""

from __future__ import annotations

from typing import Annotated, TypeAlias

import typer

Jobs: TypeAlias = Annotated[
    int | None, typer.Option(min=1, max=4096, help="Episodes at a time; one a core by default.")
]
"""For sweeps, and whatever else goes over worker processes."""
Backend: TypeAlias = Annotated[str, typer.Option(help="loky (this machine), or dask.")]
Scheduler: TypeAlias = Annotated[
    str | None, typer.Option(metavar="ADDRESS", help="Of the Dask scheduler.")
]
Json: TypeAlias = Annotated[bool, typer.Option("--json", help="As JSON on stdout, alone.")]
