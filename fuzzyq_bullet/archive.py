"""Reading an ``.npz`` that nobody vouches for: plain arrays of a bounded size, or a refusal."""

from __future__ import annotations

import io
import warnings
import zipfile
from typing import TYPE_CHECKING, Any

import numpy as np

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import read_bytes

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

MAX_BYTES = 1 << 30
"""Most that an archive may unpack to; a million decisions, more than any run makes, take half."""
MAX_MEMBERS = 100


def read_arrays(path: Path) -> dict[str, NDArray[Any]]:
    """Return the arrays of an ``.npz`` by name.

    Nothing in the file is executed (no pickle), and no more is unpacked than ``MAX_BYTES``.

    Raises:
        UserError: If it cannot be read, or is no archive of plain arrays.
    """
    try:
        content = io.BytesIO(read_bytes(path, what="an archive of arrays (.npz)", most=MAX_BYTES))
        # The warnings numpy has about odd headers are about files that it did not write itself.
        with zipfile.ZipFile(content) as archive, warnings.catch_warnings():
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
        raise UserError(f"{path}: not an archive of arrays (.npz), or damaged") from error


def _read(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> NDArray[Any]:
    with archive.open(member) as stream:
        array = np.load(stream, allow_pickle=False)
    if not isinstance(array, np.ndarray):
        raise TypeError(f"{member.filename} is no array")
    return array
