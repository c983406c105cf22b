"""What the commands share in talking to a person: everything but results goes to stderr."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

from rich.console import Console

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rich.progress import Progress, TaskID

stderr = Console(stderr=True, highlight=False)


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
