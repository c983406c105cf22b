"""The process around a command: its signals, its standard streams, its exit code.

Imports the standard library only, so that it is in place before anything slow is loaded.
"""

from __future__ import annotations

import atexit
import io
import os
import signal
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from types import FrameType
from typing import NoReturn

from fuzzyq_bullet.errors import Stopped, UserError, printable
from fuzzyq_bullet.platforms import end_with

BAD_INPUT = 2
_GRACE = 2.0
"""Time (s) in which nothing interrupts the tidying up after an interrupt, nor one an import; and
that a plugin has to tidy up at the end."""
_SOON = 0.02
"""Time (s) after which an interrupt is tried again that came at a bad time."""


def guard(command: Callable[[], int]) -> NoReturn:
    """Run a command and exit with what it returns, whatever happens to the process meanwhile.

    A signal ends it in good order: everything half-written is removed, nobody sees a traceback.
    Its output may end in a pipe that closes early, which changes nothing about the verdict. A
    user's own code and a window run in a second process, so that what these do to it is no verdict
    either.
    """
    report = _supervise() if _may_be_ended() else None
    try:
        _catch_signals()
        _set_up_streams()
        status = _status_of(command)
        _ignore_signals()
    except Stopped as stopped:
        _ignore_signals()
        say_error("interrupted")
        status = stopped.status
    if report is not None:
        report(status)
        _leave(status)
    sys.exit(status)


def _may_be_ended() -> bool:
    """Tell whether the command line loads plugins or opens a window, which may end the process.

    Only where processes can be forked.
    """
    words = sys.argv[1:]
    plugins = any(word.startswith("--plugin") for word in words)
    return hasattr(os, "fork") and (plugins or words[:1] == ["watch"])


def _supervise() -> Callable[[int], None]:
    """Let a second process do all that follows; this one ends with the exit code that it reports.

    So ``os._exit(0)`` in a planner, or a crash of a library, is no success.

    Returns:
        What reports the exit code. Only the second process comes back from here.
    """
    parent = os.getpid()
    reading, writing = os.pipe()
    child = os.fork()
    if not child:
        os.close(reading)
        end_with(parent)
        return lambda status: _report(writing, status)
    os.close(writing)

    def hand_on(signum: int, frame: FrameType | None) -> None:
        os.kill(child, signum)

    for signum in _SIGNALS:
        if signal.getsignal(signum) is not signal.SIG_IGN:
            signal.signal(signum, hand_on)
    _, state = os.waitpid(child, 0)
    os.set_blocking(reading, False)  # a process that the other left behind may hold the pipe
    try:
        told = os.read(reading, 1)
    except BlockingIOError:
        told = b""
    if told:
        os._exit(told[0])
    from fuzzyq_bullet.wording import end_in_words

    how = end_in_words(os.waitstatus_to_exitcode(state))
    say_error(f"nothing came of it: {how}")
    os._exit(BAD_INPUT)


def _report(pipe: int, status: int) -> None:
    os.write(pipe, bytes([status]))
    os.close(pipe)


def _leave(status: int) -> NoReturn:
    """End this process now, whatever a plugin still does: the exit code is reported already.

    Its threads are not waited for, and its functions of ``atexit`` have ``_GRACE``.
    """
    if _TIMER is not None:  # then the kernel ends the process
        signal.signal(_TIMER, signal.SIG_DFL)
        signal.setitimer(signal.ITIMER_REAL, _GRACE)
    atexit._run_exitfuncs()
    with suppress(ValueError):  # a plugin has closed it
        sys.stderr.flush()
    os._exit(status)


def _status_of(command: Callable[[], int]) -> int:
    try:
        status = command()
        sys.stdout.flush()
        sys.stdout = sys.stderr  # what a plugin still says as it is unloaded is no result
    except MemoryError:
        say_error("out of memory")
        return BAD_INPUT
    except UserError as error:
        for problem in error.problems:
            say_error(problem)
        return BAD_INPUT
    return status


def say_error(problem: str) -> None:
    """Print one line about something that went wrong."""
    line = f"error: {printable(problem)}"
    if sys.stderr.isatty() and not os.environ.get("NO_COLOR"):
        line = f"\x1b[1;31m{line}\x1b[0m"
    print(line, file=sys.stderr, flush=True)


_SIGNALS = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
)
"""What asks a process to end; Windows has no SIGHUP."""
_TIMER = getattr(signal, "SIGALRM", None)
"""What tries an interrupt again a little later; nothing on Windows, where none is put off."""


def _catch_signals() -> None:
    raised: float | None = None
    asked: tuple[int, float] | None = None

    def stop(signum: int, frame: FrameType | None) -> None:
        nonlocal raised, asked
        now = time.monotonic()
        if raised is not None and now - raised <= _GRACE:
            return
        if asked is None:
            if signum == _TIMER:
                return
            asked = signum, now
        signum, since = asked
        if _TIMER is not None and _imports(frame) and now - since < _GRACE:
            signal.setitimer(signal.ITIMER_REAL, _SOON)
            return
        raised, asked = now, None
        raise Stopped(signum)

    ignored = sys.unraisablehook

    def again(what: sys.UnraisableHookArgs) -> None:
        # It came while a destructor or a callback ran, which let nothing through.
        nonlocal raised, asked
        if _TIMER is None or not isinstance(what.exc_value, Stopped):
            ignored(what)
            return
        raised, asked = None, (what.exc_value.status - 128, time.monotonic())
        signal.setitimer(signal.ITIMER_REAL, _SOON)

    sys.unraisablehook = again
    for signum in _SIGNALS:
        # What is ignored from the start stays so: nohup, or a shell's job in the background.
        if signal.getsignal(signum) is not signal.SIG_IGN:
            signal.signal(signum, stop)
    if _TIMER is not None:
        signal.signal(_TIMER, stop)


def _imports(frame: FrameType | None) -> bool:
    """Tell whether a module is being loaded, in which an exception may be lost or become another.

    The import system ignores what is raised in its callbacks; numpy makes an ``ImportError`` of it.
    """
    while frame is not None:
        if frame.f_code.co_filename == "<frozen importlib._bootstrap>":
            return True
        frame = frame.f_back
    return False


def _ignore_signals() -> None:
    for signum in (*_SIGNALS, *([_TIMER] if _TIMER is not None else [])):
        # What is left to do takes no time.
        signal.signal(signum, signal.SIG_IGN)


class _Outlet(io.TextIOWrapper):
    """Standard output or error that outlives its reader, as in ``fuzzyq list | head -1``."""

    def __init__(self, descriptor: int, name: str, *, must: bool) -> None:
        # Whatever the locale, a sign that cannot be shown is no reason to fail.
        encoding = getattr(getattr(sys, name), "encoding", None) or "utf-8"
        binary = os.fdopen(descriptor, "wb", closefd=False)
        super().__init__(binary, encoding, "backslashreplace", line_buffering=not must)
        self._what, self._must = name, must

    def write(self, text: str, /) -> int:
        try:
            return super().write(text)
        except OSError as error:
            self._give_up(error)
            return len(text)

    def flush(self) -> None:
        try:
            super().flush()
        except OSError as error:
            self._give_up(error)

    def _give_up(self, error: OSError) -> None:
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, self.fileno())
        os.close(null)
        if self._must and not isinstance(error, BrokenPipeError):
            raise UserError(f"{self._what}: cannot be written: {error.strerror}") from error


def _set_up_streams() -> None:
    # One that is closed would become that of the next file opened.
    while (descriptor := os.open(os.devnull, os.O_RDWR)) < 3:
        pass
    os.close(descriptor)
    # What libraries print from C must not get between the lines of a result on stdout.
    sys.stdout = _Outlet(os.dup(1), "stdout", must=True)
    os.dup2(2, 1)
    sys.stderr = _Outlet(2, "stderr", must=False)
