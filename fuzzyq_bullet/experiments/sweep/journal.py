"""The rows of a sweep on disk as they come: whatever ends the process, no finished row is lost."""

from __future__ import annotations

import os
import stat
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import BinaryIO

from pydantic import ValidationError

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.experiments.sweep.rows import Row
from fuzzyq_bullet.files import read_bytes

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
            self._lock(file)
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

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        where: TracebackType | None,
    ) -> None:
        self._close()

    def _close(self) -> None:
        if self._file is not None:
            with suppress(OSError):  # what could not be written has been told
                self._file.close()

    def _lock(self, file: BinaryIO) -> None:
        try:
            import fcntl
        except ImportError:  # Windows
            return
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise UserError(f"{self._path.parent}: another sweep is at work in it") from error
        except OSError:  # a file system without locks
            pass

    def _problem(self, error: OSError) -> UserError:
        return UserError(f"{self._path}: cannot be written: {error.strerror or error}")


def _rows(text: bytes) -> list[Row]:
    rows = []
    for line in text.splitlines():
        with suppress(ValidationError):
            rows.append(Row.model_validate_json(line))
    return rows
