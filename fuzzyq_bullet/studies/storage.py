"""What a sweep keeps on disk: its settings, its rows as they come, its records.

The folder refuses other settings than it was made with; whatever ends the process, no finished row
is lost.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import stat
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO

from pydantic import ValidationError

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import read_bytes, take_lock, writable_folder, write_text, written_beside
from fuzzyq_bullet.studies.episodes import Row

MAX_SETTINGS = 10_000_000
"""Largest file of settings that is read (bytes)."""
SETTINGS = "settings.json"
"""The file that says what a folder's sweep is."""
_ABSENT = "nothing"


class Folder:
    """Where a sweep keeps its settings, its journal, its records and its table.

    Attributes:
        path: The folder.
        journal: Path of the rows as they come.
        records: Folder of the records kept.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.journal = path / "journal.jsonl"
        self.records = path / "records"
        self._settings = path / SETTINGS

    def is_claimed(self) -> bool:
        """Tell whether it is one of a sweep already, of whatever settings."""
        return os.path.lexists(self._settings)

    def claim(self, settings: Mapping[str, Any]) -> None:
        """Make the folder one for a sweep of these settings, or make sure that it is.

        Args:
            settings: All that the rows depend on, as JSON can say it.

        Raises:
            UserError: If it was made with other settings, or cannot be written to.
        """
        wanted = json.loads(json.dumps(settings))
        writable_folder(self.path)
        before = self._read()
        if before is None:
            if self.journal.exists():
                raise UserError(
                    f"{self._settings}: is gone, and {self.journal.name} is of no use alone"
                )
            write_text(self._settings, json.dumps(wanted, indent=2) + "\n")
        elif before != wanted:
            told = "; ".join(_differences(before, wanted))
            raise UserError(
                f"{self.path}: holds a sweep with other settings: {told}; use another --out"
            )
        writable_folder(self.records)

    def tidy(self) -> None:
        """Remove what a sweep left half-written here when it was killed; none may be at work.

        Nothing else: others keep files here too, and other commands may be writing theirs.
        """
        for folder, name in (
            (self.path, r"settings\.json|[a-z]+\.csv"),
            (self.records, r".+\.npz"),
        ):
            ours = re.compile(rf"\.({name})\.[0-9a-f]{{8}}\.part")
            for left in folder.iterdir():
                if ours.fullmatch(left.name) and left.is_dir() and not left.is_symlink():
                    shutil.rmtree(left, ignore_errors=True)

    def keep(self, name: str, record: bytes) -> None:
        """Keep a record (``.npz``).

        Raises:
            UserError: If it cannot be written.
        """
        with written_beside(self.records / f"{name}.npz") as part:
            part.write_bytes(record)

    def _read(self) -> dict[str, Any] | None:
        if not self.is_claimed():
            return None
        known = settings_in(self._settings)
        if known is None:
            raise UserError(f"{self._settings}: is damaged; use another --out")
        return known


def settings_in(path: Path) -> dict[str, Any] | None:
    """Return what a file of settings says; None if it is no JSON object.

    Raises:
        UserError: If it cannot be read.
    """
    content = read_bytes(path, what="the settings of a sweep", most=MAX_SETTINGS)
    try:
        known = json.loads(content)
    except (ValueError, RecursionError):
        return None
    return known if isinstance(known, dict) else None


def _differences(before: Mapping[str, Any], wanted: Mapping[str, Any], at: str = "") -> list[str]:
    """Say which settings differ, in the order in which they are asked for; inner ones by a dot."""
    told = []
    for key in [*wanted, *(key for key in before if key not in wanted)]:
        old, new = before.get(key, _ABSENT), wanted.get(key, _ABSENT)
        if isinstance(old, Mapping) and isinstance(new, Mapping):
            told += _differences(old, new, f"{at}{key}.")
        elif old != new:
            told.append(f"{at}{key} {_shown(old)}, asked for {_shown(new)}")
    return told


def _shown(value: Any) -> str:
    if isinstance(value, Mapping):  # all that is in it would hide what differs
        return "something"
    return value if isinstance(value, str) else json.dumps(value)


MAX_BYTES = 1 << 30
"""Largest journal that is read: over a million rows."""
_APPEND = (
    os.O_RDWR
    | os.O_CREAT
    | os.O_APPEND
    | getattr(os, "O_NOFOLLOW", 0)
    | getattr(os, "O_NONBLOCK", 0)
    | getattr(os, "O_BINARY", 0)
)
"""Follows no link, and waits for nobody at the other end of a FIFO."""


def rows_in(path: Path) -> list[Row]:
    """Return the rows of a journal, which may be at work or torn, and stays as it is.

    Raises:
        UserError: If it cannot be read.
    """
    text = read_bytes(path, what="a journal of rows", most=MAX_BYTES)
    return _rows(text[: text.rfind(b"\n") + 1])


class Journal:
    """A file of rows, one a line, that one process at a time may append to.

    Opening it reads the rows that are there. A last line that was torn by whatever ended the
    process is cut off; a line damaged otherwise is passed over, and its episode runs again.

    Attributes:
        rows: The rows that were there, as they came.
    """

    def __init__(self, path: Path) -> None:
        """Open the journal, which is created if need be.

        Raises:
            UserError: If it cannot be opened, or another process has it open.
        """
        self._path = path
        self._file: BinaryIO | None = None
        self.rows: list[Row] = []

    def __enter__(self) -> Journal:
        try:
            self._file = file = self._opened()
            if not take_lock(file.fileno()):
                raise UserError(f"{self._path.parent}: another sweep is at work in it")
            file.seek(0)
            text = file.read()
            whole = text[: text.rfind(b"\n") + 1]
            if len(whole) < len(text):
                file.truncate(len(whole))
        except OSError as error:
            self._close()
            if self._path.is_symlink():  # it may lead to a file of somebody else's
                raise UserError(f"{self._path}: is a link; use another --out") from error
            raise self._problem(error) from error
        except UserError:
            self._close()
            raise
        self.rows = _rows(whole)
        return self

    def _opened(self) -> BinaryIO:
        descriptor = os.open(self._path, _APPEND, 0o666)
        if not stat.S_ISREG(os.fstat(descriptor).st_mode):
            os.close(descriptor)
            raise UserError(f"{self._path}: is not a file; use another --out")
        return os.fdopen(descriptor, "a+b")

    def append(self, row: Row) -> None:
        """Write a row; when this returns, it is on disk.

        Raises:
            UserError: If it cannot be written.
        """
        assert self._file is not None, "the journal is not open"
        try:
            self._file.write(row.model_dump_json().encode() + b"\n")
            self._file.flush()
            os.fsync(self._file.fileno())
        except OSError as error:
            raise self._problem(error) from error

    def __exit__(self, *_: object) -> None:
        self._close()

    def _close(self) -> None:
        if self._file is not None:
            with suppress(OSError):  # what could not be written has been told
                self._file.close()

    def _problem(self, error: OSError) -> UserError:
        return UserError(f"{self._path}: cannot be written: {error.strerror or error}")


def _rows(text: bytes) -> list[Row]:
    rows = []
    for line in text.splitlines():
        with suppress(ValidationError):
            rows.append(Row.model_validate_json(line))
    return rows
