"""Writing files so that nothing finished is ever lost: write beside, then rename."""

from __future__ import annotations

import glob
import secrets
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from fuzzyq_bullet.errors import UserError


@contextmanager
def written_beside(path: Path) -> Iterator[Path]:
    """Yield a path beside ``path``; rename it into place when the block ends well.

    However else the block ends, what was at ``path`` before is still there, and nothing new.

    Raises:
        UserError: If the file cannot be written (permissions, a full disk, a folder in its place).
    """
    # A folder of its own: a program that is late to open its file, when all is over, then fails.
    folder = _part(path)
    part = folder / path.name
    try:
        folder.mkdir()
        yield part
        part.replace(path)
    except OSError as error:
        raise UserError(f"{path}: cannot be written: {error.strerror or error}") from error
    except UserError as error:  # raised by what was told to write the part; nobody else knows it
        told = (problem.replace(str(part), str(path)) for problem in error.problems)
        raise UserError(*told) from error
    finally:
        _remove(folder)


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
    probe = _part(path / "fuzzyq")
    try:
        path.mkdir(parents=True, exist_ok=True)
        try:
            probe.touch()
        finally:
            probe.unlink(missing_ok=True)
    except (OSError, ValueError) as error:  # ValueError: a null character
        reason = getattr(error, "strerror", None) or error
        raise UserError(f"{path}: not a folder that can be written to: {reason}") from error
    return path


def writable_files(folder: Path, names: Sequence[str]) -> list[Path]:
    """Return the paths of files that can be written in ``folder``, which is created if need be.

    Raises:
        UserError: If the folder cannot be written to, or a folder is in a file's place.
    """
    writable_folder(folder)
    paths = [folder / name for name in names]
    for path in paths:
        if path.is_dir():
            raise UserError(f"{path}: cannot be written: there is a folder of that name")
    return paths


def remove_parts(path: Path) -> None:
    """Remove what a process that was killed left of a file that it was about to write."""
    for part in path.parent.glob(f".{glob.escape(path.name)}.*.part"):
        _remove(part)


def _part(path: Path) -> Path:
    # By chance, not by process id: containers that share a folder may share that too.
    return path.with_name(f".{path.name}.{secrets.token_hex(4)}.part")


def _remove(folder: Path) -> None:
    for _ in range(3):  # something may still have been written while the first was at work
        shutil.rmtree(folder, ignore_errors=True)
        with suppress(OSError):  # a name too long, which never was made
            if folder.exists():
                continue
        return
