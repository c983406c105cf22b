"""A program beside this one that is asked line by line, and never outlives it."""

from __future__ import annotations

import os
import selectors
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import suppress

from fuzzyq_bullet.errors import printable
from fuzzyq_bullet.wording import shorten

LONGEST_LINE = 65_536
"""Most bytes of one answer."""
_TAIL = 4_096
_AFTER_ITS_END = 0.5
"""How long its last words and its exit status are waited for (s)."""

_GUARD = (
    "import os, signal, sys\n"
    "signal.signal(signal.SIGINT, signal.SIG_IGN)\n"
    "os.read(0, 1)\n"
    "os.killpg(int(sys.argv[1]), signal.SIGKILL)\n"
)
"""Waits for the end of whoever started it, even by ``kill -9``, and ends the program's group."""


class ChildError(Exception):
    """The program did not answer as it should; says what it did, in one line."""


class LineChild:
    """A program that answers each line with a line.

    It has a process group of its own, which ends with it, with ``close`` and with this process.

    Args:
        command: The program and its arguments.

    Raises:
        ChildError: If it cannot be started.
    """

    def __init__(self, command: Sequence[str]) -> None:
        if not hasattr(os, "killpg"):
            raise ChildError("cannot be started: it needs Linux or macOS")
        pipe = subprocess.PIPE
        try:
            self._child = subprocess.Popen(
                list(command), stdin=pipe, stdout=pipe, stderr=pipe, start_new_session=True
            )
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or error
            raise ChildError(f"cannot be started: {reason}") from error
        child = self._child
        try:
            assert child.stdin
            assert child.stdout
            assert child.stderr
            self._stdin, self._stdout, self._stderr = child.stdin, child.stdout, child.stderr
            for stream in (self._stdin, self._stdout, self._stderr):
                os.set_blocking(stream.fileno(), False)
            self._guard: subprocess.Popen[bytes] | None = None
            self._guard = subprocess.Popen(
                [sys.executable, "-I", "-S", "-c", _GUARD, str(child.pid)],
                stdin=pipe,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                start_new_session=True,
            )
        except BaseException:
            self.close()
            raise
        self._out, self._err = bytearray(), bytearray()

    def tell(self, line: str, limit: float) -> None:
        """Send a line that needs no answer.

        Raises:
            ChildError: If the program has ended, or does not take the line in time.
        """
        self._talk(line, limit, answered=False)

    def ask(self, line: str, limit: float) -> str:
        """Send a line and return the one that the program answers.

        Args:
            line: Without its line feed.
            limit: Longest time that it may take (s).

        Raises:
            ChildError: If it has ended, takes longer, had said something before it was asked, or
                its answer is too long.
        """
        self._drain()
        if self._out:
            raise self._failed(f"said {_shown(self._out)} before it was asked")
        return self._talk(line, limit, answered=True)

    def close(self) -> None:
        """End the program and all of its group."""
        with suppress(OSError):  # it has ended already
            os.killpg(self._child.pid, signal.SIGKILL)
        if self._guard is not None:
            self._guard.kill()
            self._guard.wait()
            if self._guard.stdin:
                self._guard.stdin.close()
        self._child.wait()
        for stream in (self._child.stdin, self._child.stdout, self._child.stderr):
            if stream:
                with suppress(OSError):
                    stream.close()

    def failed(self, what: str) -> ChildError:
        """Return an error that says what it did, its exit status and its last words.

        Args:
            what: What it did wrong, such as ``answered "x"``.
        """
        return self._failed(what)

    def _talk(self, line: str, limit: float, *, answered: bool) -> str:
        left = memoryview(line.encode() + b"\n")
        deadline = time.monotonic() + limit
        with selectors.DefaultSelector() as selector:
            selector.register(self._stdin, selectors.EVENT_WRITE)
            selector.register(self._stdout, selectors.EVENT_READ)
            selector.register(self._stderr, selectors.EVENT_READ)
            while left or answered:
                rest = deadline - time.monotonic()
                if rest <= 0.0:
                    raise self._failed(f"gave no answer within {limit:g} s{self._begun()}")
                for key, _ in selector.select(rest):
                    if key.fileobj is self._stdin:
                        left = self._write(left)
                        if not left:
                            selector.unregister(self._stdin)
                    elif key.fileobj is self._stderr:
                        if not self._hear():
                            selector.unregister(self._stderr)
                    elif not self._read():
                        raise self._failed(f"ended{self._begun()}")
                end = self._out.find(b"\n")
                if answered and end >= 0 and end <= LONGEST_LINE:
                    said = bytes(self._out[:end])
                    del self._out[: end + 1]
                    return said.decode("utf-8", "replace")
                if len(self._out) > LONGEST_LINE:
                    what = f"answered {_shown(self._out)}"
                    raise self._failed(f"{what}, longer than {LONGEST_LINE} bytes")
        return ""

    def _write(self, left: memoryview) -> memoryview:
        try:
            return left[os.write(self._stdin.fileno(), left) :]
        except BlockingIOError:
            return left
        except OSError as error:
            raise self._failed(f"ended{self._begun()}") from error

    def _read(self) -> bool:
        """Read what it says; return whether it may say more."""
        try:
            said = os.read(self._stdout.fileno(), LONGEST_LINE)
        except BlockingIOError:
            return True
        self._out += said
        return bool(said)

    def _hear(self) -> bool:
        """Keep the end of what it complains of; return whether there may be more."""
        try:
            said = os.read(self._stderr.fileno(), LONGEST_LINE)
        except BlockingIOError:
            return True
        self._err += said
        del self._err[:-_TAIL]
        return bool(said)

    def _drain(self) -> None:
        with suppress(BlockingIOError):
            self._out += os.read(self._stdout.fileno(), _TAIL)

    def _begun(self) -> str:
        return f", having said {_shown(self._out)}" if self._out else ""

    def _failed(self, what: str) -> ChildError:
        status = self._status()
        deadline = time.monotonic() + _AFTER_ITS_END
        while status is not None and time.monotonic() < deadline:
            before = len(self._err)
            if not self._hear() or len(self._err) == before:
                break
        words = [line for line in bytes(self._err).decode("utf-8", "replace").splitlines() if line]
        last = f"; its last words: {shorten(printable(words[-1].strip()))}" if words else ""
        running = "it was still running" if status is None else f"exit status {status}"
        return ChildError(f"{what} ({running}{last})")

    def _status(self) -> int | None:
        """Return its exit status, negative for a signal; None if it goes on."""
        with suppress(subprocess.TimeoutExpired):
            closed = not self._open()
            return self._child.wait(_AFTER_ITS_END if closed else 0.0)
        return None

    def _open(self) -> bool:
        """Return whether it may still say something."""
        try:
            return bool(os.read(self._stdout.fileno(), 1))
        except BlockingIOError:
            return True


def _shown(said: bytes | bytearray) -> str:
    return shorten(printable(bytes(said[:200]).decode("utf-8", "replace")))
