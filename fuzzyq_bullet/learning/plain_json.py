"""Reading JSON that nobody vouches for: plain data of a bounded size, or a refusal."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import read_bytes

if TYPE_CHECKING:
    from pathlib import Path

_DIGITS = 20
"""Whole numbers of more digits are refused: reading them takes quadratic time."""


def read_object(path: Path, *, what: str, most: int) -> dict[str, Any]:
    """Return the one JSON object that a file holds.

    Stricter than ``json``: no key twice, no NaN, no Infinity, and nothing that eats up the stack.

    Args:
        path: The file.
        what: What it should be, with its article, for messages: ``a policy``.
        most: Bytes that it may have.

    Raises:
        UserError: If it cannot be read, or is anything else; one line.
    """
    content = read_bytes(path, what=what, most=most)
    if not content.strip():
        raise UserError(f"{path}: is empty; it should hold {what}")
    try:
        data = json.loads(
            content.decode("utf-8-sig"),
            object_pairs_hook=_unique,
            parse_constant=_no_constant,
            parse_int=_whole,
        )
    except UnicodeDecodeError as error:
        raise UserError(f"{path}: is not text (UTF-8); it should be {what}") from error
    except json.JSONDecodeError as error:
        raise UserError(f"{path}:{error.lineno}: not valid JSON: {error.msg}") from error
    except RecursionError as error:
        raise UserError(f"{path}: is nested too deeply to be {what}") from error
    except ValueError as error:  # from the three functions below
        raise UserError(f"{path}: {error}") from error
    if not isinstance(data, dict):
        raise UserError(f"{path}: holds {shown(data)}; {what} is an object: {{...}}")
    return data


def shown(value: Any) -> str:
    """Return any plain value in a few printable letters, for messages."""
    if isinstance(value, dict):
        return f"an object of {len(value)} keys"
    if isinstance(value, list | tuple):
        return f"a list of {len(value)}"
    if isinstance(value, str):  # cut first: it may be megabytes long
        return ascii(value[:60]) + ("..." if len(value) > 60 else "")
    if value is None or isinstance(value, bool):
        return json.dumps(value)
    return f"{value!r:.60}"


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) != len(pairs):
        seen: set[str] = set()
        for key, _ in pairs:
            if key in seen:
                raise ValueError(f"the key {shown(key)} is given twice; once is right")
            seen.add(key)
    return found


def _no_constant(name: str) -> float:
    raise ValueError(f"{name} is not allowed; all numbers must be finite")


def _whole(text: str) -> int:
    if len(text) > _DIGITS:
        raise ValueError(f"a whole number of {len(text)} digits; at most {_DIGITS} are allowed")
    return int(text)
