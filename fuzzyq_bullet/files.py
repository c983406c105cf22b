"""Writing files so that nothing finished is ever lost: write beside, then rename."""

from __future__ import annotations

import glob
import os
import secrets
import shutil
import stat
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from fuzzyq_bullet.errors import MachineError, UserError

_BINARY = getattr(os, "O_BINARY", 0)
"""Without it Windows would change line ends."""
_owner = ""
"""What stands in the names of all that this process writes beside, or for a while."""


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


def read_bytes(path: Path, *, what: str, most: int) -> bytes:
    """Return the contents of a regular file; nothing that could keep a reader waiting is opened.

    Args:
        path: The file.
        what: What it should be, with its article, for messages: ``a policy``.
        most: Bytes that it may have.

    Raises:
        UserError: If it cannot be read, is no regular file (a folder, a FIFO, a device), or is too
            large; one line.
    """
    try:
        # Opened without waiting and looked at when open: no FIFO can take its place in between.
        descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | _BINARY)
        if not stat.S_ISREG(os.fstat(descriptor).st_mode):
            os.close(descriptor)
            raise UserError(f"{path}: is not a file; give {what}")
        with os.fdopen(descriptor, "rb") as file:
            content = file.read(most + 1)
    except (OSError, ValueError) as error:  # ValueError: a null character in its name
        reason = getattr(error, "strerror", None) or error
        raise UserError(f"{path}: cannot be read: {reason}") from error
    if len(content) > most:
        raise UserError(f"{path}: too large; {what} has at most {most} bytes")
    return content


def read_text(path: Path, *, what: str, most: int) -> str:
    """Return the text of a regular file.

    Args:
        path: The file.
        what: What it should be, for the error, such as ``a scenario``.
        most: Most bytes that it may have.

    Raises:
        UserError: If it cannot be read, is too large, or is not UTF-8; the last with its line.
    """
    content = read_bytes(path, what=what, most=most)
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise UserError(f"{path}:{line}: is not UTF-8 text") from error


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


def refuse_inputs(outputs: Iterable[Path], inputs: Iterable[Path]) -> None:
    """Make sure that no output is the same file as an input, by whatever path or link.

    Raises:
        UserError: If one is.
    """
    read = list(inputs)
    for output in outputs:
        for one in read:
            with suppress(OSError, ValueError):  # one of them is not there: not the same
                if output.samefile(one):
                    raise UserError(
                        f"{output}: would be replaced, but is an input of this command ({one}); "
                        "write somewhere else"
                    )


@contextmanager
def temporary_folder() -> Iterator[Path]:
    """Yield a folder for files that are needed within the block alone.

    Raises:
        MachineError: If it cannot be made or written to, as on a full disk.
    """
    import tempfile  # which takes long to load

    try:
        with tempfile.TemporaryDirectory(prefix=f"fuzzyq-{_owner}") as folder:
            yield Path(folder)
    except OSError as error:
        where = error.filename or "the folder of temporary files"
        raise MachineError(f"{where}: cannot be written: {error.strerror or error}") from error


def own_parts(owner: str) -> None:
    """Mark all that this process writes beside, so that ``remove_parts`` finds it and no other's.

    Its temporary folders too, for ``remove_temporary``.

    Args:
        owner: Letters and digits that no other process uses.
    """
    global _owner
    _owner = owner


def remove_parts(path: Path, owner: str) -> None:
    """Remove what a process that was killed left of a file that it was about to write.

    Args:
        path: The file.
        owner: What the process called itself in ``own_parts``.
    """
    for part in path.parent.glob(f".{glob.escape(path.name)}.{owner}*.part"):
        _remove(part)


def remove_temporary(owner: str) -> None:
    """Remove the temporary folders that a process left when it was killed.

    Args:
        owner: What the process called itself in ``own_parts``.
    """
    import tempfile

    for left in Path(tempfile.gettempdir()).glob(f"fuzzyq-{glob.escape(owner)}*"):
        _remove(left)


@contextmanager
def alone_at(path: Path) -> Iterator[None]:
    """Hold a file against other processes that would renew it while the block runs.

    Where the system or its folder knows no locks, nobody is kept out.

    Raises:
        UserError: If another process holds it.
    """
    if not hasattr(os, "O_NOFOLLOW"):  # Windows
        yield
        return
    lock = path.with_name(f".{path.name}.lock")
    try:
        descriptor = os.open(lock, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK, 0o666)
    except OSError as error:
        raise UserError(f"{lock}: cannot be written: {error.strerror or error}") from error
    try:
        if not take_lock(descriptor):
            raise UserError(f"{path}: another process is at work on it; use another --out")
        try:
            yield
        finally:
            if os.fstat(descriptor).st_size == 0:  # else it is somebody's file of that name
                with suppress(OSError):
                    lock.unlink()  # while it is still held: who comes later makes a new one
    finally:
        os.close(descriptor)


def take_lock(descriptor: int) -> bool:
    """Lock an open file until it is closed; False if another process has.

    Where the system or the file's folder knows no locks, nobody has.
    """
    try:
        import fcntl
    except ImportError:  # Windows
        return True
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # a file system without locks
        return True
    return True


def _part(path: Path) -> Path:
    # By chance, not by process id: containers that share a folder may share that too.
    return path.with_name(f".{path.name}.{_owner}{secrets.token_hex(4)}.part")


def _remove(folder: Path) -> None:
    try:
        _remove_once(folder)
    except BaseException:  # an interrupt meanwhile, which comes once
        _remove_once(folder)
        raise


def _remove_once(folder: Path) -> None:
    for _ in range(3):  # something may still have been written while the first was at work
        shutil.rmtree(folder, ignore_errors=True)
        with suppress(OSError):  # a name too long, which never was made
            if folder.exists():
                continue
        return
