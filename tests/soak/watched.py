"""A command and all that it starts, seen from outside: its processes, their memory, their end."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO

MARK = "FUZZYQ_SOAK"
"""The variable by which a process is known as one of a soak's, however far down."""
_MB = 2**20


@dataclass(frozen=True)
class Seen:
    """A process.

    Attributes:
        pid: Its number.
        parent: That of its parent.
        worker: Whether it is one of the pool's.
        memory_mb: What it holds (RSS, MB).
    """

    pid: int
    parent: int
    worker: bool
    memory_mb: float


class Watched:
    """A command whose processes carry a mark in their environment."""

    def __init__(
        self,
        command: Sequence[str],
        mark: str,
        temporary: Path,
        log: IO[bytes],
        cwd: Path,
        output: IO[bytes] | int = subprocess.DEVNULL,
    ) -> None:
        """Start it.

        Args:
            command: Program and arguments.
            mark: What its processes, and no others, are known by.
            temporary: Where they put their temporary files.
            log: Takes what it says on stderr.
            cwd: Its folder.
            output: Takes what it says on stdout: a file, because nobody reads a pipe meanwhile.
        """
        self._mark = mark
        environment = {**os.environ, MARK: mark, "TMPDIR": str(temporary)}
        self.process = subprocess.Popen(
            command, env=environment, stdout=output, stderr=log, cwd=cwd
        )

    def seen(self) -> list[Seen]:
        """Return its processes that are alive."""
        return list(filter(None, map(_seen, marked(self._mark))))

    def workers(self) -> list[Seen]:
        """Return those of the pool."""
        return [one for one in self.seen() if one.worker]

    def commander(self) -> Seen | None:
        """Return the process that the workers work for; None if there is none yet."""
        seen = self.seen()
        bosses = {one.parent for one in seen if one.worker}
        return next((one for one in seen if one.pid in bosses), None)

    def all_gone(self, within: float) -> bool:
        """Tell whether all of its processes end in that time (s); they are killed if not."""
        deadline = time.monotonic() + within
        while marked(self._mark):
            if time.monotonic() > deadline:
                for pid in marked(self._mark):
                    kill(pid)
                return False
            time.sleep(0.05)
        return True


def marked(mark: str) -> list[int]:
    """Return the processes with this mark that have not ended."""
    wanted = f"{MARK}={mark}".encode()
    found = []
    for folder in Path("/proc").iterdir():
        if folder.name.isdigit() and int(folder.name) != os.getpid():
            with suppress(OSError):  # it has ended meanwhile, or is of somebody else
                if wanted in (folder / "environ").read_bytes().split(b"\0"):
                    found.append(int(folder.name))
    return found


def kill(pid: int) -> None:
    """End a process as the kernel does when memory is short."""
    with suppress(ProcessLookupError):
        os.kill(pid, signal.SIGKILL)


def _seen(pid: int) -> Seen | None:
    folder = Path("/proc") / str(pid)
    with suppress(OSError):
        pages = int((folder / "statm").read_text().split()[1])
        parent = int((folder / "stat").read_text().rpartition(")")[2].split()[1])
        worker = b"fuzzyq_bullet.workers.process" in (folder / "cmdline").read_bytes()
        return Seen(pid, parent, worker, pages * os.sysconf("SC_PAGE_SIZE") / _MB)
    return None
