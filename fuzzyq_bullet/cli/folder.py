"""The option ``--out``: a folder or a file, which an empty text is not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import typer


def _folder(text: str | Path) -> Path:
    if not str(text):  # else it would become ".", as an unset variable in a script does
        raise typer.BadParameter("is empty; give a folder, or . for the current one")
    return Path(text)


FOLDER: dict[str, Any] = {"parser": _folder, "metavar": "<path>"}
"""For ``typer.Option``."""


def _file(text: str | Path) -> Path:
    if not str(text):
        raise typer.BadParameter("is empty; give a file")
    return Path(text)


FILE: dict[str, Any] = {"parser": _file, "metavar": "<file>"}
"""For ``typer.Option``."""
