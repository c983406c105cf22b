"""A command's help is its docstring, less what is for its callers in Python."""

from __future__ import annotations

import inspect
from collections.abc import Callable


def help_of(command: Callable[..., None]) -> str:
    """Return what ``--help`` says about a command."""
    return inspect.cleandoc(command.__doc__ or "").partition("\n\nRaises:")[0]
