"""Straight lines that touch circles: between two circles, and from points to circles."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fuzzyq_bullet.oracle.world import TOUCHES

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fuzzyq_bullet.geometry import Floats
    from fuzzyq_bullet.oracle.world import GrownWorld


class Tangents(NamedTuple):
    """Lines between the edges of pairs of discs, T of them.

    Attributes:
        first: Shape (T,): the disc touched at the beginning.
        second: Shape (T,): the disc touched at the end.
        first_angle: Shape (T,): where on the first one's edge (rad).
        second_angle: Shape (T,): where on the second one's edge (rad).
    """

    first: NDArray[np.intp]
    second: NDArray[np.intp]
    first_angle: Floats
    second_angle: Floats

    def only(self, which: NDArray[np.bool_]) -> Tangents:
        """Return those for which ``which``, shape (T,), is true."""
        return Tangents(
            self.first[which],
            self.second[which],
            self.first_angle[which],
            self.second_angle[which],
        )

    def ends(self, world: GrownWorld) -> tuple[Floats, Floats]:
        """Return where they begin and where they end (m), each of shape (T, 2)."""
        return (
            on_edge(world, self.first, self.first_angle),
            on_edge(world, self.second, self.second_angle),
        )


def between_discs(world: GrownWorld, first: NDArray[np.intp], second: NDArray[np.intp]) -> Tangents:
    """Return all common tangents of pairs of discs, up to four for each pair.

    With n the direction from the first centre to where the line touches, the second disc is
    touched on the same side (outer) or on the other (inner), and n · d = R₁ ∓ R₂ for the vector d
    between the centres.
    """
    dx, dy = (world.centres[second] - world.centres[first]).T
    apart, bearing = np.hypot(dx, dy), np.arctan2(dy, dx)
    r1, r2 = world.radii[first], world.radii[second]
    found = []
    for lead, opposite in ((r1 - r2, 0.0), (r1 + r2, np.pi)):
        # Discs that only graze each other have one line between them, of no length.
        exists = np.flatnonzero((np.abs(lead) <= apart + TOUCHES) & (apart > 0.0))
        swing = np.arccos(np.clip(lead[exists] / apart[exists], -1.0, 1.0))
        for side in (swing, -swing):
            angle = bearing[exists] + side
            found.append(Tangents(first[exists], second[exists], angle, angle + opposite))
    return Tangents(*(np.concatenate(parts) for parts in zip(*found, strict=True)))


def from_point(world: GrownWorld, point: Floats) -> tuple[NDArray[np.intp], Floats]:
    """Return the lines from a point, shape (2,), that touch discs.

    Returns:
        Shape (T,): the disc touched; and shape (T,): where on its edge (rad).
    """
    dx, dy = (point - world.centres).T
    apart, bearing = np.hypot(dx, dy), np.arctan2(dy, dx)
    outside = np.flatnonzero((apart >= world.radii - TOUCHES) & (apart > 0.0))
    swing = np.arccos(np.minimum(world.radii[outside] / apart[outside], 1.0))
    angles = np.concatenate([bearing[outside] + swing, bearing[outside] - swing])
    return np.concatenate([outside, outside]), angles


def on_edge(world: GrownWorld, disc: NDArray[np.intp], angle: Floats) -> Floats:
    """Return the points, shape (T, 2), at the angles (rad) on the discs' edges."""
    direction = np.column_stack([np.cos(angle), np.sin(angle)])
    points: Floats = world.centres[disc] + world.radii[disc, None] * direction
    return points
