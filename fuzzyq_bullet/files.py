"""Writing files so that nothing finished is ever lost: write beside, then rename."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from fuzzyq_bullet.errors import UserError


@contextmanager
def written_beside(path: Path) -> Iterator[Path]:
    """Yield a path beside ``path``; rename it into place when the block ends well.

    Raises:
        UserError: If the file cannot be written (permissions, a full disk, a folder in its place).
    """
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        yield part
        os.replace(part, path)
    except OSError as error:
        raise UserError(f"{path}: cannot be written: {error.strerror or error}") from error
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """Write a text file whole or not at all.

    Raises:
        UserError: If it cannot be written.
    """
    with written_beside(path) as part:
        part.write_text(text, encoding="utf-8")


def writable_folder(path: Path) -> Path:
    """Create the folder ``path`` if need be and make sure that a file can be written there.

    Raises:
        UserError: If it cannot be created or written to.
    """
    probe = path / f".fuzzyq-{os.getpid()}.part"
    try:
        path.mkdir(parents=True, exist_ok=True)
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise UserError(
            f"{path}: not a folder that can be written to: {error.strerror or error}"
        ) from error
    return path
