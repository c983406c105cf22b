"""A way through a world, for measuring and drawing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fuzzyq_bullet.geometry import Floats


@dataclass(frozen=True, eq=False)
class Route:
    """The shortest way of a disc's centre from the start to the goal disc.

    Attributes:
        length: Exact length (m): of the straight lines and the true arcs.
        points: Shape (K, 2), K ≥ 1 (m): the way for drawing, with arcs as chords that stray from
            them by less than 1 mm; read-only.
    """

    length: float
    points: Floats
