"""Straight lines that touch circles, and the graph of points on free arcs that they link."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

from fuzzyq_bullet.geometry import Floats, Ints
from fuzzyq_bullet.ground_truth.configuration_space import TOUCHES, ConfigurationSpace, FreeArcs

_SAG = 0.0005
"""Farthest that a chord strays from a drawn arc (m)."""
_NO_LENGTH = 1e-300
"""Stands for 0 (m), which matrices of links may take for no link at all."""
_WIDEST = 0.2
"""Largest turn between two drawn points of an arc (rad)."""


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


class Tangents(NamedTuple):
    """Lines between the edges of pairs of discs, T of them.

    Attributes:
        first: Shape (T,): the disc touched at the beginning.
        second: Shape (T,): the disc touched at the end.
        first_angle: Shape (T,): where on the first one's edge (rad).
        second_angle: Shape (T,): where on the second one's edge (rad).
    """

    first: Ints
    second: Ints
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

    def ends(self, world: ConfigurationSpace) -> tuple[Floats, Floats]:
        """Return where they begin and where they end (m), each of shape (T, 2)."""
        return (
            on_edge(world, self.first, self.first_angle),
            on_edge(world, self.second, self.second_angle),
        )


def between_discs(world: ConfigurationSpace, first: Ints, second: Ints) -> Tangents:
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


def from_point(world: ConfigurationSpace, point: Floats) -> tuple[Ints, Floats]:
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


def on_edge(world: ConfigurationSpace, disc: Ints, angle: Floats) -> Floats:
    """Return the points, shape (T, 2), at the angles (rad) on the discs' edges."""
    direction = np.column_stack([np.cos(angle), np.sin(angle)])
    points: Floats = world.centres[disc] + world.radii[disc, None] * direction
    return points


class TangentGraph:
    """Collects nodes and links, then finds the shortest way through them.

    A node is a point that stands alone, or one where a line touches the free edge of a disc. Nodes
    on one arc need no links: neighbours are linked along it.
    """

    def __init__(self, world: ConfigurationSpace, arcs: FreeArcs) -> None:
        self._world = world
        self._arcs = arcs
        self._count = 0
        self._nodes: list[tuple[Ints, Floats, Floats]] = []  # arc or −1, offset on it, place
        self._links: list[tuple[Ints, Ints, Floats]] = []

    def add_points(self, points: Floats) -> Ints:
        """Add nodes that stand alone, shape (K, 2); return their numbers, shape (K,)."""
        alone = np.full(len(points), -1, dtype=np.intp)
        return self._add(alone, np.zeros(len(points)), points)

    def can_touch(self, disc: Ints, angle: Floats) -> NDArray[np.bool_]:
        """Tell where the edges of discs are free at these angles (rad); shape (K,)."""
        arc, _ = self._arcs.locate(disc, angle)
        return arc >= 0

    def add_touches(self, disc: Ints, angle: Floats) -> Ints:
        """Add nodes on free edges, at these angles (rad); return their numbers, shape (K,)."""
        arc, offset = self._arcs.locate(disc, angle)
        return self._add(arc, offset, on_edge(self._world, disc, angle))

    def link(self, first: Ints, second: Ints, lengths: Floats) -> None:
        """Link nodes by straight lines of these lengths (m)."""
        self._links.append((first, second, lengths))

    def shortest(self, start: int, goal: int) -> tuple[float, list[int]]:
        """Return length (m) and nodes of the shortest way; infinite and none if there is none."""
        first, second, lengths = (
            np.concatenate(parts) for parts in zip(*self._links, *self._along_arcs(), strict=True)
        )
        low, high = np.minimum(first, second), np.maximum(first, second)
        order = np.lexsort((lengths, high, low))
        low, high, lengths = low[order], high[order], lengths[order]
        new = np.ones(len(low), dtype=bool)  # of several links between two nodes, the shortest
        new[1:] = (np.diff(low) != 0) | (np.diff(high) != 0)
        shape = (self._count, self._count)
        weights = np.maximum(lengths[new], _NO_LENGTH)
        matrix = csr_matrix((weights, (low[new], high[new])), shape=shape)
        distance, before = dijkstra(matrix, directed=False, indices=start, return_predecessors=True)
        if not math.isfinite(distance[goal]):
            return math.inf, []
        nodes = [goal]
        while nodes[-1] != start:
            nodes.append(int(before[nodes[-1]]))
        length = float(distance[goal])
        return (length if length > 1e-200 else 0.0), nodes[::-1]

    def draw(self, nodes: list[int]) -> Floats:
        """Return the way along these nodes, shape (K, 2), with arcs as chords."""
        arc, offset, place = self._gathered()
        points = [place[nodes[0]][None]]
        for a, b in pairwise(nodes):
            if arc[a] >= 0 and arc[a] == arc[b]:
                points.append(self._chords(int(arc[a]), float(offset[a]), float(offset[b])))
            points.append(place[b][None])
        drawn: Floats = np.concatenate(points)
        repeated = np.all(np.diff(drawn, axis=0) == 0.0, axis=1)
        distinct: Floats = drawn[np.concatenate([[True], ~repeated])]
        return distinct

    def _add(self, arc: Ints, offset: Floats, place: Floats) -> Ints:
        numbers = np.arange(self._count, self._count + len(arc))
        self._nodes.append((arc, offset, place))
        self._count += len(arc)
        return numbers

    def _gathered(self) -> tuple[Ints, Floats, Floats]:
        arc, offset, place = (np.concatenate(p) for p in zip(*self._nodes, strict=True))
        return arc, offset, place

    def _along_arcs(self) -> list[tuple[Ints, Ints, Floats]]:
        """Links between neighbours on each arc, and around whole circles from last to first."""
        arc, offset, _ = self._gathered()
        nodes = np.flatnonzero(arc >= 0)
        nodes = nodes[np.lexsort((offset[nodes], arc[nodes]))]
        radius = self._world.radii[self._arcs.disc[arc[nodes]]]
        same = arc[nodes[1:]] == arc[nodes[:-1]]
        a, b = nodes[:-1][same], nodes[1:][same]
        along = (a, b, radius[1:][same] * (offset[b] - offset[a]))

        leads, ends = np.ones(len(nodes), dtype=bool), np.ones(len(nodes), dtype=bool)
        leads[1:], ends[:-1] = ~same, ~same
        a, b = nodes[leads], nodes[ends]
        whole = (self._arcs.extent[arc[a]] >= math.tau) & (a != b)
        a, b, radius = a[whole], b[whole], radius[leads][whole]
        around = (a, b, radius * (math.tau - offset[b] + offset[a]))
        return [along, around]

    def _chords(self, arc: int, begin: float, end: float) -> Floats:
        """Points strictly between two places on an arc, the shorter way round on a circle."""
        disc = self._arcs.disc[arc]
        radius = float(self._world.radii[disc])
        turn = end - begin
        if self._arcs.extent[arc] >= math.tau:
            turn = math.remainder(turn, math.tau)
        widest = min(_WIDEST, 2 * math.acos(max(1.0 - _SAG / radius, -1.0)))
        angle = (
            self._arcs.begin[arc]
            + begin
            + np.linspace(0.0, turn, 1 + math.ceil(abs(turn) / widest))
        )
        return on_edge(self._world, np.full(len(angle), disc), angle)
