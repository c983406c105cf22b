"""Obstacles as the centre of a disc sees them: larger discs, rounded boxes, walls moved inwards."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import KDTree

from fuzzyq_bullet.geometry import Field, Floats
from fuzzyq_bullet.shapes import GRAZE

if TYPE_CHECKING:
    from numpy.typing import NDArray


TOUCHES = 2 * GRAZE
"""The same for what was itself found to within ``GRAZE``."""
_CHUNK = 1_000_000
"""Most pairs of a line and an obstacle held in memory at once."""
_NEAR = 16
"""Discs about each end that a line is held against first: they stop most lines."""


class ConfigurationSpace:
    """Obstacles grown by the radius of the disc whose centre moves among them.

    Args:
        field: The obstacles and walls as they are.
        radius: Radius of the moving disc (m).

    Attributes:
        field: As given.
        radius: As given.
        centres: Shape (N, 2) (m): of all grown discs, those of round obstacles and of corners.
        radii: Shape (N,): radii of the grown discs (m).
        near: Shape (N, K): for each disc, the discs with the nearest centres, nearest first.
    """

    def __init__(self, field: Field, radius: float) -> None:
        self.field, self.radius = field, radius
        discs = np.unique(field.discs + np.array([0.0, 0.0, radius]), axis=0)
        self.centres, self.radii = discs[:, :2].copy(), discs[:, 2].copy()
        self.near = _nearest(self.centres)

    def is_free(self, points: Floats) -> NDArray[np.bool_]:
        """Tell for each point, shape (K, 2), whether the disc fits there; shape (K,)."""
        free: NDArray[np.bool_] = self.field.clearance(points) >= self.radius - TOUCHES
        return free

    def are_open(
        self,
        begin: Floats,
        end: Floats,
        first: NDArray[np.intp] | None = None,
        last: NDArray[np.intp] | None = None,
    ) -> NDArray[np.bool_]:
        """Tell for each straight line whether the disc can move along it; shape (S,).

        Both ends must be free. Then a line that enters a grown obstacle enters the disc of one of
        its corners or crosses the bare obstacle, and one between the walls stays there.

        Args:
            begin: Shape (S, 2) (m).
            end: Shape (S, 2) (m).
            first: Shape (S,): a disc near each beginning, if known; only makes it faster.
            last: Shape (S,): the same for the ends.
        """
        alive = np.arange(len(begin))
        for around in (first, last):
            if around is None:
                continue
            for k in range(self.near.shape[1]):
                disc = self.near[around[alive], k]
                gap = _to_lines(begin[alive], end[alive], self.centres[disc])
                alive = alive[gap >= self.radii[disc] - TOUCHES]
        rows = max(1, _CHUNK // max(1, 2 * len(self.radii)))
        open_ = np.zeros(len(begin), dtype=bool)
        for k in range(0, len(alive), rows):
            part = alive[k : k + rows]
            a, b = begin[part, None], end[part, None]
            clear = np.all(_to_lines(a, b, self.centres) >= self.radii - TOUCHES, axis=1)
            part = part[clear]
            open_[part] = True
            for group in self.field.groups:
                open_[part] &= ~group.are_crossed(begin[part], end[part])
        return open_


def _to_lines(begin: Floats, end: Floats, points: Floats) -> Floats:
    """Distance (m) from points to the straight lines between two others, elementwise."""
    vx, vy = end[..., 0] - begin[..., 0], end[..., 1] - begin[..., 1]
    wx, wy = points[..., 0] - begin[..., 0], points[..., 1] - begin[..., 1]
    squared = np.maximum(vx * vx + vy * vy, 1e-300)
    along = np.minimum(np.maximum((wx * vx + wy * vy) / squared, 0.0), 1.0)
    distance: Floats = np.hypot(wx - along * vx, wy - along * vy)
    return distance


def _nearest(centres: Floats) -> NDArray[np.intp]:
    count = min(_NEAR, len(centres))
    if count == 0:
        return np.zeros((0, 0), dtype=np.intp)
    _, index = KDTree(centres).query(centres, k=np.arange(1, count + 1))
    return np.asarray(index, dtype=np.intp)
