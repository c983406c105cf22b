"""Reading what nobody vouches for: arrays or JSON of a bounded size, numbers, or a refusal."""

from __future__ import annotations

import io
import json
import math
import warnings
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import read_bytes
from fuzzyq_bullet.reading.kinds import not_a_record
from fuzzyq_bullet.wording import shorten

MAX_BYTES = 1 << 30
"""Most that an archive may unpack to; a million decisions, more than any run makes, take half."""
MAX_MEMBERS = 100
_DIGITS = 20
"""Whole numbers of more digits are refused: reading them takes quadratic time."""


def read_arrays(path: Path) -> dict[str, NDArray[Any]]:
    """Return the arrays of an ``.npz`` by name.

    Nothing in the file is executed (no pickle), and no more is unpacked than ``MAX_BYTES``.

    Raises:
        UserError: If it cannot be read, or is no archive of plain arrays.
    """
    content = read_bytes(path, what="an archive of arrays (.npz)", most=MAX_BYTES)
    try:
        # The warnings numpy has about odd headers are about files that it did not write itself.
        with zipfile.ZipFile(io.BytesIO(content)) as archive, warnings.catch_warnings():
            warnings.simplefilter("error")
            members = archive.infolist()
            # What a member says to be its size is also the most that is read of it.
            if len(members) > MAX_MEMBERS or sum(m.file_size for m in members) > MAX_BYTES:
                raise UserError(f"{path}: too large; a record unpacks to {MAX_BYTES} bytes at most")
            return {m.filename.removesuffix(".npy"): _read(archive, m) for m in members}
    except UserError:
        raise
    except OSError as error:
        raise UserError(f"{path}: cannot be read: {error.strerror or error}") from error
    except Exception as error:  # a damaged file makes zipfile, zlib and numpy raise ten kinds
        other = not_a_record(path, content)
        raise UserError(
            f"{path}: {other or 'not an archive of arrays (.npz), or damaged'}"
        ) from error


def _read(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> NDArray[Any]:
    with archive.open(member) as stream:
        array = np.load(stream, allow_pickle=False)
    if not isinstance(array, np.ndarray):
        raise TypeError(f"{member.filename} is no array")
    return array


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


def number(text: str, where: str, *, least: float = -math.inf, most: float = math.inf) -> float:
    """Return the number that a text stands for.

    Args:
        text: The text.
        where: File, line and key, for messages.
        least: Least value that is right.
        most: Greatest value that is right.

    Raises:
        UserError: If it is none, not finite, or out of bounds.
    """
    try:
        value = float(text) if len(text) < 100 else math.nan
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise UserError(f"{where}: {shorten(text.strip())} is not a finite number")
    if not least <= value <= most:
        raise UserError(f"{where}: {value:g} is out of bounds; allowed: {least:g} to {most:g}")
    return value
