"""Pictures as maps: a pixel is a cell, and what is dark is blocked."""

from __future__ import annotations

import io
import warnings
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import read_bytes
from fuzzyq_bullet.scenario.importers.cells import grid_map
from fuzzyq_bullet.scenario.importers.foreign import ForeignMap, ImportOptions
from fuzzyq_bullet.scenario.importers.registry import register_importer

_MAX_BYTES = 100_000_000
_MAX_PIXELS = 25_000_000
"""Most pixels of a picture: 5000 × 5000."""
_LEAST_CELL = 0.001
_FORMATS = ("PNG", "PPM", "BMP")


def read_grey(path: Path) -> NDArray[np.float64]:
    """Return how bright the pixels of a picture are, 0 to 1.

    Colours count as the mean of red, green and blue; what is transparent lies on white.

    Returns:
        Shape (rows, columns), the first row at the bottom.

    Raises:
        UserError: If it is no picture, is damaged, or is too large.
    """
    from PIL import Image

    content = read_bytes(path, what="a picture", most=_MAX_BYTES)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # the size is looked at here
            picture = Image.open(io.BytesIO(content), formats=_FORMATS)
            width, height = picture.size
            if width * height > _MAX_PIXELS:
                raise UserError(f"{path}: has more than {_MAX_PIXELS} pixels, which are not read")
            picture.load()
            if picture.mode.startswith("I") or picture.mode == "F":
                values = np.array(picture, dtype=np.float64) / 65535.0
            else:
                layers = np.array(picture.convert("RGBA"), dtype=np.uint8)
                opaque = layers[..., 3] / 255.0
                grey = layers[..., :3].astype(np.uint16).sum(axis=2) / 765.0
                values = grey * opaque + (1.0 - opaque)
    except UserError:
        raise
    except Image.DecompressionBombError as error:
        raise UserError(
            f"{path}: has more than {_MAX_PIXELS} pixels, which are not read"
        ) from error
    except Exception as error:  # a damaged file makes Pillow raise ten kinds
        raise UserError(f"{path}: is no picture (PNG, PGM, BMP) that can be read") from error
    if not values.size:
        raise UserError(f"{path}: is a picture without pixels")
    return values[::-1]


def cell_size(value: float, where: str) -> float:
    """Return the size of a cell (m), which can be one.

    Raises:
        UserError: If it cannot.
    """
    if not _LEAST_CELL <= value <= 100.0:
        raise UserError(f"{where}: {value:g} m cannot be; allowed: {_LEAST_CELL:g} to 100 m")
    return value


@register_importer(".png", ".pgm", ".bmp")
def picture(path: Path, options: ImportOptions) -> ForeignMap:
    """Read a picture whose dark pixels are blocked; its lower left corner is the origin."""
    if options.resolution is None:
        raise UserError(
            f"{path}: a picture does not say how large it is; give --resolution M_PER_PIXEL, "
            "such as 0.05"
        )
    cell = cell_size(options.resolution, "--resolution")
    return grid_map(path, read_grey(path) < 0.5, cell, options)
