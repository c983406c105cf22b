"""Cells of a grid map merged into outlines, without moving an edge.

Cells that share a side are one piece. A piece with a hole, or one that touches itself at a corner,
is cut along lines of the grid until what is left is simple: a scenario's polygon is. A piece that
is a rectangle becomes a box. So the union of the obstacles is the union of the blocked cells.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.quantities import MAX_OBSTACLES, MIN_RADIUS
from fuzzyq_bullet.scenario.importers.foreign import (
    THIN,
    ForeignMap,
    ImportOptions,
    Obstacle,
    too_many,
)
from fuzzyq_bullet.scenario.places import Bounds
from fuzzyq_bullet.shapes.outlines import LEAST_AREA

Mask: TypeAlias = NDArray[np.bool_]
Ring: TypeAlias = "list[tuple[int, int]]"
"""Corners of an outline in cells, (column, row), the origin at the lower left of the map."""
Place: TypeAlias = Callable[[float, float], "tuple[float, float]"]
"""From column and row to metres."""

_MOST_CORNERS = 1000
"""An outline of more corners is cut in two: a polygon may have 2000."""


def outlines_of(blocked: Mask, most: int = MAX_OBSTACLES) -> list[Ring]:
    """Return simple outlines that cover the blocked cells exactly and do not overlap.

    Args:
        blocked: Shape (rows, columns), the first row at the bottom.
        most: Stop when there are more.

    Returns:
        Rings, anticlockwise, corners alone. If there are too many, more than ``most`` of them.
    """
    rings: list[Ring] = []
    waiting: list[tuple[Mask, int, int]] = [(blocked, 0, 0)]
    while waiting and len(rings) <= most:
        area, column, row = waiting.pop()
        if not area.any():
            continue
        pieces, count = ndimage.label(area)
        if count > most:
            return [[] for _ in range(count)]
        for i, where in enumerate(ndimage.find_objects(pieces), 1):
            piece: Mask = pieces[where] == i
            at = (column + where[1].start, row + where[0].start)
            cut = _cut(piece)
            if cut is None:
                ring = _ring(piece)
                if len(ring) <= _MOST_CORNERS:
                    rings.append([(x + at[0], y + at[1]) for x, y in ring])
                    continue
                axis = int(piece.shape[1] > piece.shape[0])
                cut = axis, piece.shape[axis] // 2
            axis, line = cut
            first, second = np.split(piece, [line], axis=axis)
            waiting.append((first, *at))
            shifted = (at[0], at[1] + line) if axis == 0 else (at[0] + line, at[1])
            waiting.append((second, *shifted))
    return rings


def _cut(piece: Mask) -> tuple[int, int] | None:
    """Return the axis and the line of the grid to cut a piece along; None if it is simple."""
    padded = np.pad(piece, 1)
    outside, count = ndimage.label(~padded)
    if count > 1:
        boxes = ndimage.find_objects(outside)
        frame = outside[0, 0]
        holes = [where for i, where in enumerate(boxes, 1) if i != frame]
        axis = int(piece.shape[1] > piece.shape[0])  # across the longer side
        # Through the hole in the middle of all, so that as many are left on both sides.
        middles = [(where[axis].start + where[axis].stop) // 2 - 1 for where in holes]
        line = sorted(middles)[len(middles) // 2]
        return axis, min(max(line, 1), piece.shape[axis] - 1)
    return None  # nor does it touch itself at a corner: that would close off a hole


def _ring(piece: Mask) -> Ring:
    """Return the outline of a piece without holes, anticlockwise, corners alone."""
    padded = np.pad(piece, 1).astype(np.int8)
    here, below = padded[1:, 1:-1], padded[:-1, 1:-1]
    follows: dict[tuple[int, int], tuple[int, int]] = {}
    # Sides along x: a cell above goes right, a cell below left. Then the same along y.
    for row, column in np.argwhere((here == 1) & (below == 0)).tolist():
        follows[column, row] = (column + 1, row)
    for row, column in np.argwhere((here == 0) & (below == 1)).tolist():
        follows[column + 1, row] = (column, row)
    here, before = padded[1:-1, 1:], padded[1:-1, :-1]
    upward = np.argwhere((here == 0) & (before == 1)).tolist()
    downward = np.argwhere((here == 1) & (before == 0)).tolist()
    sides = {(column, row): (column, row + 1) for row, column in upward}
    sides.update({(column, row + 1): (column, row) for row, column in downward})
    ring: Ring = []
    start = at = next(iter(follows))  # at the lowest row's left end: a corner
    along = True
    while True:
        ring.append(at)
        table = follows if along else sides
        while at in table:
            at = table[at]
        along = not along
        if at == start:
            break
    return ring


def grid_map(
    path: Path,
    blocked: Mask,
    cell: float,
    options: ImportOptions,
    *,
    origin: tuple[float, float] = (0.0, 0.0),
    yaw: float = 0.0,
    border: bool = False,
) -> ForeignMap:
    """Return the map of a grid of cells.

    Args:
        path: The file, for messages.
        blocked: Shape (rows, columns), the first row at the bottom.
        cell: Size of a cell (m).
        options: What is asked for; cells outside its crop are not looked at.
        origin: Lower left corner of the grid (m).
        yaw: Turn of the grid about that corner (rad).
        border: Whether what the arena has beyond a turned grid is blocked.

    Raises:
        UserError: If it becomes too many obstacles.
    """
    rows, columns = blocked.shape
    cos, sin = math.cos(yaw), math.sin(yaw)
    if abs(sin) < 1e-12:
        cos, sin = math.copysign(1.0, cos), 0.0

    def place(column: float, row: float) -> tuple[float, float]:
        x, y = column * cell, row * cell
        return origin[0] + cos * x - sin * y, origin[1] + sin * x + cos * y

    frame = [place(0, 0), place(columns, 0), place(columns, rows), place(0, rows)]
    xs, ys = zip(*frame, strict=True)
    bounds = Bounds(min(xs), min(ys), max(xs), max(ys))
    left, low, wanted = _window(blocked, cell, options, origin, cos, sin)
    rings = outlines_of(wanted)
    if len(rings) > MAX_OBSTACLES:
        raise UserError(too_many(path, len(rings)))
    found = ForeignMap(bounds, walls=True)
    specks = 0
    for ring in rings:
        points = [(column + left, row + low) for column, row in ring]
        one, grown = _obstacle(points, cell, place, math.remainder(yaw, math.tau) if sin else 0.0)
        found.obstacles.append(one)
        specks += grown
    if specks:
        found.changed.append(f"{specks} specks thinner than {THIN:g} m: grown to that")
    if border and sin:
        found.obstacles += _beyond(frame, bounds)
    return found


def _window(
    blocked: Mask,
    cell: float,
    options: ImportOptions,
    origin: tuple[float, float],
    cos: float,
    sin: float,
) -> tuple[int, int, Mask]:
    """Return the cells that the crop may need, and how many lie left of and below them."""
    if options.crop is None:
        return 0, 0, blocked
    corners = np.array(options.crop.corners) - origin
    own = corners @ np.array([[cos, -sin], [sin, cos]]) / cell
    low = np.maximum(np.floor(own.min(axis=0)).astype(int) - 1, 0)
    high = np.maximum(np.ceil(own.max(axis=0)).astype(int) + 1, 0)
    (left, bottom), (right, top) = low.tolist(), high.tolist()
    return left, bottom, blocked[bottom:top, left:right]


def _obstacle(ring: Ring, cell: float, place: Place, yaw: float) -> tuple[Obstacle, bool]:
    """Return the obstacle of a ring, and whether it had to be grown."""
    corners = np.array(ring, dtype=np.float64)
    low, high = corners.min(axis=0), corners.max(axis=0)
    (x, y), size = (low + high) / 2, (high - low) * cell
    after = np.roll(corners, -1, axis=0)
    area = float(np.sum(corners[:, 0] * after[:, 1] - corners[:, 1] * after[:, 0])) / 2 * cell**2
    if min(size) < THIN or area < LEAST_AREA:
        dx, dy = (np.maximum(size, THIN) / cell / 2).tolist()
        around = [(x - dx, y - dy), (x + dx, y - dy), (x + dx, y + dy), (x - dx, y + dy)]
        return {"shape": "polygon", "points": [place(*point) for point in around]}, True
    if len(ring) == 4 and min(size) >= 2 * MIN_RADIUS:
        return {
            "shape": "box",
            "position": place(float(x), float(y)),
            "size": size.tolist(),
            "yaw": yaw,
        }, False
    return {"shape": "polygon", "points": [place(*point) for point in ring]}, False


def _beyond(frame: list[tuple[float, float]], bounds: Bounds) -> list[Obstacle]:
    """Return the corners of the arena beyond a turned grid, as triangles."""
    import shapely

    outside = shapely.box(*bounds).difference(shapely.Polygon(frame))
    return [
        {"shape": "polygon", "points": [(float(x), float(y)) for x, y in part.exterior.coords[:-1]]}
        for part in shapely.get_parts(outside)
        if part.area >= LEAST_AREA and shapely.minimum_clearance(part) > 1e-6
    ]
