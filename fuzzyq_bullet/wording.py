"""Words that every message about a mistake is made of: values, near misses, what is allowed."""

from __future__ import annotations

import difflib
import math
import signal
from collections.abc import Iterable, Sequence
from typing import Any


def shorten(value: Any) -> str:
    """Return a value as it would be written in the file, at most about 60 characters long."""
    match value:
        case None:
            return "nothing"
        case bool():
            return "true" if value else "false"
        case float() if not math.isfinite(value):
            return "nan" if math.isnan(value) else "inf" if value > 0 else "-inf"
        case dict():
            return "a mapping"
        case list() | tuple():
            if len(value) > 6 or any(isinstance(v, dict | list | tuple) for v in value):
                return f"a list of {len(value)}"
            return "[" + ", ".join(shorten(v) for v in value) + "]"
        case _ if hasattr(value, "model_fields"):
            return f"a {type(value).__name__}"
    try:
        text = repr(value[:80]) if isinstance(value, str) else repr(value)
    except Exception:  # even that may fail
        return f"a {type(value).__name__}"
    return text if len(text) <= 60 else f"{text[:56]} ..."


def plain(value: float, digits: int) -> str:
    """Return a number with so many digits, and no negative zero."""
    return f"{round(float(value), digits) + 0.0:.{digits}f}"


def did_you_mean(word: Any, allowed: Iterable[str]) -> str:
    """Return ``did you mean 'radius'? `` or nothing, for a word that is not allowed."""
    close = difflib.get_close_matches(str(word)[:100], list(allowed), n=1)
    return f"did you mean {close[0]!r}? " if close else ""


def not_one_of(what: str, value: Any, allowed: Sequence[str]) -> str:
    """Return ``no drive 'weels'; did you mean 'wheels'? allowed: wheels, kinematic``."""
    hint = did_you_mean(value, allowed)
    return f"no {what} {shorten(value)}; {hint}allowed: {', '.join(allowed)}"


def error_in_words(error: BaseException) -> str:
    """Return ``ValueError: no idea`` on one line, for an exception of code that is not ours."""
    try:
        message = " ".join(str(error).split())[:300]
    except Exception:  # even its words may fail
        message = ""
    return type(error).__name__ + (f": {message}" if message else "")


def end_in_words(code: int) -> str:
    """Say how a process ended.

    Args:
        code: Its exit code; negative for the signal that ended it.
    """
    if code >= 0:
        return f"its process ended by itself, with exit code {code}"
    known = {one.value: one.name for one in signal.Signals}
    name = known.get(-code, f"signal {-code}")
    why = (signal.strsignal(-code) or "").lower()
    if known.get(-code) == "SIGKILL":
        why = "killed from outside: the machine is out of memory, or somebody ended it"
    return f"its process crashed: {name} ({why})"
