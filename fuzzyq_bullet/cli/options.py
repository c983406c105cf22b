"""What the commands share: options, each said once, their help, and how they talk to a person."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import typer
from rich.console import Console

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID


def help_of(command: Callable[..., None]) -> str:
    """Return what ``--help`` says about a command: its docstring, less what is for callers."""
    return inspect.cleandoc(command.__doc__ or "").partition("\n\nRaises:")[0]


def _folder(text: str | Path) -> Path:
    if not str(text):  # else it would become ".", as an unset variable in a script does
        raise typer.BadParameter("is empty; give a folder, or . for the current one")
    return Path(text)


def _file(text: str | Path) -> Path:
    if not str(text):
        raise typer.BadParameter("is empty; give a file")
    return Path(text)


FOLDER: dict[str, Any] = {"parser": _folder, "metavar": "<path>"}
"""For ``typer.Option``: a folder, which an empty text is not."""
FILE: dict[str, Any] = {"parser": _file, "metavar": "<file>"}
"""For ``typer.Option``: a file."""


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
ReplaceOption: TypeAlias = Annotated[
    bool, typer.Option("--replace", help="Replace files of another run of that name.")
]
ReplaceOthersOption: TypeAlias = Annotated[
    bool, typer.Option("--replace", help="Replace files that this command did not make.")
]
PlannerOption: TypeAlias = Annotated[
    str | None,
    typer.Option(help="Planner to use instead, with the same settings as far as it has them."),
]
RulesOption: TypeAlias = Annotated[
    str | None,
    typer.Option(
        metavar="RULES",
        help="Table 4 of the paper, corrected or printed; or a .yaml, .fll or .fis file of your "
        "own (docs/how-to/rules.md).",
        show_default="corrected",
    ),
]
Json: TypeAlias = Annotated[bool, typer.Option("--json", help="As JSON on stdout, alone.")]

Jobs: TypeAlias = Annotated[
    int | None, typer.Option(min=1, max=4096, help="Episodes at a time; one a core by default.")
]
"""For sweeps, and whatever else goes over worker processes."""
Backend: TypeAlias = Annotated[str, typer.Option(help="loky (this machine), or dask.")]
Scheduler: TypeAlias = Annotated[
    str | None, typer.Option(metavar="ADDRESS", help="Of the Dask scheduler.")
]

stderr = Console(stderr=True, highlight=False)
"""Everything but results goes there."""


def say(text: str, style: str = "") -> None:
    """Print one line for people; never broken in two, for it may hold a path."""
    stderr.print(text, style=style, markup=False, soft_wrap=True)


@contextmanager
def progress_bar(description: str, total: float | None = None) -> Iterator[tuple[Progress, TaskID]]:
    """Show a progress bar on stderr while the block runs; nothing where stderr is no terminal."""
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.fields[note]}"),
        TimeRemainingColumn(),
    )
    hidden = not stderr.is_terminal
    with Progress(*columns, console=stderr, transient=True, disable=hidden) as progress:
        yield progress, progress.add_task(description, total=total, note="")
