"""The sweeps below a folder, read back from what they wrote, finished or not."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.experiments.report.settings import Settings
from fuzzyq_bullet.experiments.sweep.folder import MAX_SETTINGS
from fuzzyq_bullet.experiments.sweep.journal import MAX_BYTES, rows_in
from fuzzyq_bullet.experiments.sweep.rows import Row, from_csv
from fuzzyq_bullet.files import read_bytes

_SETTINGS: TypeAdapter[Settings] = TypeAdapter(Settings)
_KNOWN = ("success", "steps steps", "steps grid", "learning grid", "learning comparison", "escape")
_DEPTH = 3
"""Folders below the one given that are looked into: room for ``paper/steps/table`` in ``out``."""


@dataclass(frozen=True)
class Found:
    """A sweep.

    Attributes:
        folder: Where it lies.
        settings: What it was made with.
        rows: Its rows so far, sorted.
    """

    folder: Path
    settings: Settings
    rows: tuple[Row, ...]

    @property
    def files(self) -> tuple[Path, ...]:
        """The files that it was read from."""
        names = ("settings.json", "journal.jsonl", self.settings.table)
        return tuple(self.folder / name for name in names)

    @property
    def finished(self) -> bool:
        """Whether all of its episodes have a row."""
        return len(self.rows) == self.settings.total


def sweeps_below(folder: Path) -> list[Found]:
    """Return all sweeps in a folder, which may be that of one sweep itself, by their paths.

    Raises:
        UserError: If there is none, or one is damaged or cannot be read.
    """
    try:
        if not folder.is_dir():
            raise UserError(f"{folder}: no such folder; give one that holds sweeps")
        found = [one for place in _folders(folder, _DEPTH) if (one := _read(place)) is not None]
    except OSError as error:
        raise UserError(
            f"{error.filename or folder}: cannot be read: {error.strerror or error}"
        ) from error
    if not found:
        raise UserError(
            f"{folder}: holds no sweep; make one: fuzzyq bench success --out {folder / 'success'}"
        )
    return found


def _folders(folder: Path, depth: int) -> Iterator[Path]:
    yield folder
    if depth:
        for below in sorted(folder.iterdir()):
            if below.is_dir() and not below.is_symlink() and not below.name.startswith("."):
                yield from _folders(below, depth - 1)


def _read(folder: Path) -> Found | None:
    """Return the sweep in a folder; None if it holds none."""
    path, journal = folder / "settings.json", folder / "journal.jsonl"
    if not os.path.lexists(path):
        return None
    told = _told(path)
    if told is None:
        if journal.exists():
            raise UserError(f"{path}: is damaged: no settings of a sweep")
        return None
    if told.get("sweep") not in _KNOWN:
        return None
    try:
        settings = _SETTINGS.validate_python(told)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = ".".join(map(str, first["loc"][1:]))
        raise UserError(f"{path}: is damaged: {where}: {first['msg']}") from error
    table = folder / settings.table
    if os.path.lexists(table):
        rows = _table(table)
        if len(rows) != settings.total:
            raise UserError(
                f"{table}: is damaged: {len(rows)} rows, and {settings.total} episodes by "
                f"{path.name}; the command that made it makes it again"
            )
    else:
        rows = list({row.key: row for row in rows_in(journal)}.values()) if journal.exists() else []
    for row in rows:
        if not settings.holds(row):
            source = table if os.path.lexists(table) else journal
            raise UserError(
                f"{source}: is damaged: {row.planner}, {row.drive}, {row.layout} {row.count}, run "
                f"{row.run} is no episode of this sweep"
            )
    return Found(folder, settings, tuple(sorted(rows, key=lambda row: row.key)))


def _told(path: Path) -> dict[str, Any] | None:
    content = read_bytes(path, what="the settings of a sweep", most=MAX_SETTINGS)
    try:
        told = json.loads(content)
    except (ValueError, RecursionError):
        return None
    return told if isinstance(told, dict) else None


def _table(path: Path) -> list[Row]:
    content = read_bytes(path, what="the table of a sweep", most=MAX_BYTES)
    try:
        return from_csv(content.decode())
    except UnicodeDecodeError as error:
        raise UserError(f"{path}: is damaged: no UTF-8 text") from error
    except ValueError as error:
        raise UserError(f"{path}: is damaged: {error}") from error
