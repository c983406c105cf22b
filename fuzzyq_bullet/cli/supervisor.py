"""A second process for a user's own code, which may end the one that it runs in."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable
from types import FrameType

from fuzzyq_bullet.platforms import end_with


def wanted() -> bool:
    """Tell whether the command line loads plugins, here where processes can be forked."""
    return hasattr(os, "fork") and any(word.startswith("--plugin") for word in sys.argv[1:])


def supervise(
    signals: tuple[signal.Signals, ...], lost: Callable[[str], int]
) -> Callable[[int], None]:
    """Let a second process do all that follows; this one ends with the exit code that it reports.

    So ``os._exit(0)`` in a planner, or a crash of a library, is no success.

    Args:
        signals: What asks a process to end, and is handed on.
        lost: Says how the second process ended without a word, and returns the exit code.

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

    for signum in signals:
        if signal.getsignal(signum) is not signal.SIG_IGN:
            signal.signal(signum, hand_on)
    _, state = os.waitpid(child, 0)
    os.set_blocking(reading, False)  # a process that the other left behind may hold the pipe
    try:
        told = os.read(reading, 1)
    except BlockingIOError:
        told = b""
    from fuzzyq_bullet.wording import end_in_words

    os._exit(told[0] if told else lost(end_in_words(os.waitstatus_to_exitcode(state))))


def _report(pipe: int, status: int) -> None:
    os.write(pipe, bytes([status]))
    os.close(pipe)
