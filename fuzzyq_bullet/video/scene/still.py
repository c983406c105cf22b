"""The picture of solid things that stand still, with the depth of every pixel: a z-buffer.

It shows what TinyRenderer would, which draws the robot: the same light, samples and depth, so that
the two pictures can be laid over each other. PyBullet hands every pixel over as Python numbers;
for a whole picture in full HD that takes seconds.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.physics.camera import NOTHING, Lens, Mesh, Picture, Window, lit

if TYPE_CHECKING:
    from fuzzyq_bullet.video.map.footprints import Floats

_BAND = 64
"""Rows of a triangle that are filled at a time: few enough to stay in the processor's cache."""


def photograph(
    meshes: Sequence[Mesh], lens: Lens, oversampling: int = 1, window: Window | None = None
) -> Picture:
    """Return the picture of solid things; its mask holds indices into ``meshes``.

    Surfaces are seen from outside alone, and one with a corner behind the camera is not seen.

    Args:
        meshes: What to see; each triangle is lit by the normal at its first corner.
        lens: The camera.
        oversampling: How many times larger than the lens's size the picture is made.
        window: The part of it that is made; by default all.
    """
    width, height = (side * oversampling for side in lens.size)
    left, top, right, bottom = (k * oversampling for k in window or (0, 0, *lens.size))
    matrix = lens.projection() @ lens.view()
    shape = (bottom - top, right - left)
    depth = np.ones(shape, dtype=np.float32)
    colour = np.full((*shape, 3), 255, dtype=np.uint8)
    mask = np.full(shape, NOTHING, dtype=np.int32)
    for index, mesh in enumerate(meshes):
        corners = np.column_stack([mesh.vertices, np.ones(len(mesh.vertices))]) @ matrix.T
        ahead = corners[:, 3] > 0.0
        x, y, z = (corners[:, :3] / np.where(ahead, corners[:, 3], np.nan)[:, None]).T
        # Row r of the picture is sampled at its lower edge, column c at its left one.
        seen = np.column_stack([(x + 1) * width / 2, (1 - y) * height / 2 - 1, (z + 1) / 2])
        seen -= (left, top, 0.0)
        colours = lit(mesh)
        for triangle in _facing(seen, mesh.triangles, shape[1], shape[0]):
            _fill(seen[triangle], colours[triangle[0]], index, depth, colour, mask)
    return Picture(colour, depth, mask)


def _facing(
    seen: Floats, triangles: NDArray[np.int64], width: int, height: int
) -> NDArray[np.int64]:
    """Return the triangles that show their outside and touch the picture, shape (N, 3)."""
    corners = seen[triangles]
    (ax, ay), (bx, by) = ((corners[:, k, :2] - corners[:, 0, :2]).T for k in (1, 2))
    low, high = corners.min(axis=1), corners.max(axis=1)
    outside = ax * by - ay * bx < 0.0  # anticlockwise, with y pointing down; never, if one is NaN
    touches = (high[:, 0] >= 0) & (high[:, 1] >= 0) & (low[:, 0] < width) & (low[:, 1] < height)
    return np.asarray(triangles[outside & touches])


def _fill(
    corners: Floats,
    tint: NDArray[np.uint8],
    index: int,
    depth: NDArray[np.float32],
    colour: NDArray[np.uint8],
    mask: NDArray[np.int32],
) -> None:
    """Put one triangle into a picture, wherever it is nearer than what is there.

    Args:
        corners: Column, row and depth of its corners (pixels), shape (3, 3).
        tint: Its colour, shape (3,).
        index: What the mask is to hold.
        depth: Depth of the picture, changed in place, as are the next two.
        colour: Its colours.
        mask: Its mask.
    """
    height, width = depth.shape
    x0, y0, z0 = corners[0].tolist()
    one, other = (corners[1:] - corners[0]).tolist()
    area = one[0] * other[1] - one[1] * other[0]
    across = (one[2] * other[1] - one[1] * other[2]) / area
    down = (one[0] * other[2] - one[2] * other[0]) / area
    top = max(int(np.ceil(corners[:, 1].min())), 0)
    bottom = min(int(np.ceil(corners[:, 1].max())), height)
    for first in range(top, bottom, _BAND):
        rows = np.arange(first, min(first + _BAND, bottom))
        left, right = _spans(corners, rows)
        start, stop = max(int(left.min()), 0), min(int(right.max()), width)
        if stop <= start:
            continue
        columns = np.arange(start, stop)
        z = (z0 + down * (rows - y0))[:, None] + across * (columns - x0)
        here = (slice(first, first + len(rows)), slice(start, stop))
        nearer = (columns >= left[:, None]) & (columns < right[:, None]) & (z < depth[here])
        np.copyto(depth[here], z, casting="same_kind", where=nearer)
        np.copyto(colour[here], tint, where=nearer[..., None])
        np.copyto(mask[here], index, where=nearer)


def _spans(corners: Floats, rows: NDArray[np.int64]) -> tuple[Floats, Floats]:
    """Return the first column of a triangle in each row, and the first one beyond it.

    Edges are followed downwards: two triangles that share one meet without a gap.
    """
    left, right = np.full(len(rows), np.inf), np.full(len(rows), -np.inf)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        (x0, y0), (x1, y1) = sorted((corners[a, :2].tolist(), corners[b, :2].tolist()), key=_row)
        if y1 <= y0:
            continue
        crossed = (rows >= y0) & (rows < y1)
        x = np.ceil(x0 + (rows - y0) * ((x1 - x0) / (y1 - y0)))
        left = np.where(crossed, np.minimum(left, x), left)
        right = np.where(crossed, np.maximum(right, x), right)
    return left, right


def _row(point: list[float]) -> tuple[float, float]:
    return point[1], point[0]
