"""Code of the user's own, from a plugin: whatever it raises becomes one line that blames it."""

from __future__ import annotations

import signal
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NoReturn

from fuzzyq_bullet.errors import Stopped, UserError
from fuzzyq_bullet.wording import error_in_words

_PACKAGE = Path(__file__).resolve().parent


@contextmanager
def blamed(who: str, when: str = "", kind: type[UserError] = UserError) -> Iterator[None]:
    """Blame somebody's code for whatever is raised meanwhile; see ``blame``."""
    try:
        yield
    except BaseException as error:  # whatever it is: asyncio's and others' are no Exception
        blame(error, who, when, kind)


def blame(
    error: BaseException, who: str, when: str = "", kind: type[UserError] = UserError
) -> NoReturn:
    """Raise an exception of somebody's code as one line: who, what, when, and where in their file.

    A ``UserError`` is such a line already. A ``KeyboardInterrupt`` that may be a person's passes:
    only where Ctrl-C raises none, as on the command line and in workers, can it be the code's own.

    Args:
        error: The exception that was caught.
        who: What raised it, as ``planner greedy``.
        when: When it did, as ``after 2.00 s``.
        kind: What to raise instead.
    """
    if isinstance(error, UserError | Stopped):
        raise error
    own = signal.getsignal(signal.SIGINT) is not signal.default_int_handler
    if isinstance(error, KeyboardInterrupt) and not own:
        raise error
    exits = isinstance(error, SystemExit)
    what = "tried to exit" if exits else f"stopped by {error_in_words(error)}"
    raise kind(f"{who}: {what}{when and f', {when}'}{_place(error)}") from error


def _place(error: BaseException) -> str:
    """Say where an exception comes from: the last line that is not this package's own."""
    frames = traceback.extract_tb(error.__traceback__)
    theirs = [frame for frame in frames if _PACKAGE not in Path(frame.filename).parents]
    if not frames:
        return ""
    last = (theirs or frames)[-1]
    return f" ({last.filename}:{last.lineno}, in {last.name})"
