"""The shortest way in the tangent graph.

Nodes are the points where lines touch the free edges of grown discs. Links are those lines, where
nothing is in their way, and the arcs between neighbouring nodes. A first search among near discs
only gives an upper bound; the full one leaves out whatever no way as short can visit.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from functools import cached_property
from typing import TypeAlias

import numpy as np

from fuzzyq_bullet.geometry import Floats, Ints
from fuzzyq_bullet.ground_truth.configuration_space import ConfigurationSpace, FreeArcs, free_arcs
from fuzzyq_bullet.ground_truth.tangent_graph import (
    Route,
    TangentGraph,
    between_discs,
    from_point,
    on_edge,
)
from fuzzyq_bullet.quantities import Point

Pairs: TypeAlias = tuple[Ints, Ints]

_PAIRS = 50_000
"""Pairs of discs whose tangents are held in memory at once."""
_START, _GOAL = 0, 1


def shortest_route(
    world: ConfigurationSpace, start: Point, goal: Point, goal_radius: float
) -> Route | None:
    """Return the shortest way from ``start`` to any point within ``goal_radius`` of ``goal``."""
    search = _Search(world, start, goal, goal_radius)
    if not search.begins_free():
        return None
    near = search.solve(search.near_pairs())
    if near is not None and near.length == 0.0:
        return near
    full = search.solve(search.all_pairs(near), near)
    if near is None or full is None:
        return full or near
    return min(near, full, key=lambda route: route.length)


def is_connected(world: ConfigurationSpace, start: Point, goal: Point, goal_radius: float) -> bool:
    """Tell whether there is any way. Near discs alone often tell."""
    search = _Search(world, start, goal, goal_radius)
    if not search.begins_free():
        return False
    if search.solve(search.near_pairs()) is not None:
        return True
    return search.solve(search.all_pairs(None)) is not None


class _Search:
    """One question to one world."""

    def __init__(
        self, world: ConfigurationSpace, start: Point, goal: Point, goal_radius: float
    ) -> None:
        self.world = world
        self.start = np.array(start, dtype=np.float64)
        self.goal = np.array(goal, dtype=np.float64)
        self.goal_radius = goal_radius
        # Every way that visits a disc is at least as long as from the start to it and on.
        self._from_start = _beyond(world.centres, self.start, world.radii)
        self._to_goal = _beyond(world.centres, self.goal, world.radii + goal_radius)

    @cached_property
    def arcs(self) -> FreeArcs:
        return FreeArcs.of(self.world)

    @cached_property
    def rim(self) -> Floats:
        """Where free parts of the goal disc's rim end, shape (E, 2).

        A shortest way that does not head for the centre of the goal ends at one of them.
        """
        if self.goal_radius == 0.0:
            return np.zeros((0, 2))
        free = np.array(free_arcs(self.world, self.goal, self.goal_radius)).reshape(-1, 2)
        free = free[free[:, 1] < math.tau]
        angle = np.concatenate([free[:, 0], free.sum(axis=1)])
        direction = np.column_stack([np.cos(angle), np.sin(angle)])
        points: Floats = self.goal + self.goal_radius * direction
        return points[self.world.is_free(points)]

    def begins_free(self) -> bool:
        return bool(self.world.is_free(self.start[None])[0])

    def near_pairs(self) -> Iterator[Pairs]:
        """Each disc with its nearest ones."""
        near = self.world.near[:, 1:]
        first = np.repeat(np.arange(len(near)), near.shape[1])
        pairs = np.unique(np.sort(np.column_stack([first, near.ravel()]), axis=1), axis=0)
        pairs = pairs[np.all(self.arcs.last[pairs] >= 0, axis=1)]
        yield pairs[:, 0], pairs[:, 1]

    def all_pairs(self, bound: Route | None) -> Iterator[Pairs]:
        """All pairs that a way may visit one after the other, if no longer than ``bound``."""
        longest = _at_most(bound)
        visited = self._from_start + self._to_goal <= longest
        discs = np.flatnonzero(visited & (self.arcs.last >= 0))
        rows = max(1, _PAIRS // max(1, len(discs)))
        for k in range(0, len(discs), rows):
            i, j = np.nonzero(
                np.arange(k, min(k + rows, len(discs)))[:, None] < np.arange(len(discs))
            )
            first, second = discs[i + k], discs[j]
            apart = np.hypot(*(self.world.centres[second] - self.world.centres[first]).T)
            gap = np.maximum(apart - self.world.radii[first] - self.world.radii[second], 0.0)
            forth = self._from_start[first] + self._to_goal[second]
            back = self._from_start[second] + self._to_goal[first]
            short = gap + np.minimum(forth, back) <= longest
            yield first[short], second[short]

    def solve(self, pairs: Iterable[Pairs], bound: Route | None = None) -> Route | None:
        """Return the shortest way that changes discs only between those pairs.

        Args:
            pairs: Chunks of pairs of discs.
            bound: A way that is known; longer ones may be missed.
        """
        graph = TangentGraph(self.world, self.arcs)
        graph.add_points(np.array([self.start, self.goal]))
        rim = graph.add_points(self.rim)
        graph.link(rim, np.full(len(rim), _GOAL), np.zeros(len(rim)))
        self._add_arrivals(graph)
        self._add_sight(graph)
        for first, second in pairs:
            self._add_tangents(graph, first, second, _at_most(bound))
        return self._trace(graph)

    def _add_arrivals(self, graph: TangentGraph) -> None:
        """Link straight legs towards the goal's centre; they end at the rim."""
        disc, angle = self._touching(graph, self.goal)
        begin = np.concatenate([self.start[None], on_edge(self.world, disc, angle)])
        end, legs = self._towards_goal(begin)
        arrives = self.world.is_free(end) & self.world.are_open(begin, end)
        if arrives[0]:
            graph.link(np.array([_START]), np.array([_GOAL]), legs[:1])
        nodes = graph.add_touches(disc[arrives[1:]], angle[arrives[1:]])
        graph.link(nodes, np.full(len(nodes), _GOAL), legs[1:][arrives[1:]])

    def _touching(self, graph: TangentGraph, point: Floats) -> tuple[Ints, Floats]:
        """Discs and angles (rad) at which lines from a point touch free edges."""
        disc, angle = from_point(self.world, point)
        able = graph.can_touch(disc, angle)
        return disc[able], angle[able]

    def _towards_goal(self, begin: Floats) -> tuple[Floats, Floats]:
        """Straight on to the goal disc: the ends, shape (K, 2), and the lengths, shape (K,)."""
        way = self.goal - begin
        apart = np.hypot(*way.T)
        legs = np.maximum(apart - self.goal_radius, 0.0)
        end: Floats = begin + way * (legs / np.maximum(apart, 1e-300))[:, None]
        return end, legs

    def _add_sight(self, graph: TangentGraph) -> None:
        """Link the start and the ends of the rim with one another and with discs."""
        begin = np.repeat(self.start[None], len(self.rim), axis=0)
        visible = np.flatnonzero(self.world.are_open(begin, self.rim))
        lengths = np.hypot(*(self.rim - self.start).T)[visible]
        graph.link(np.full(len(visible), _START), visible + _GOAL + 1, lengths)
        for node, point in ((_START, self.start), *enumerate(self.rim, _GOAL + 1)):
            disc, angle = self._touching(graph, point)
            end = on_edge(self.world, disc, angle)
            begin = np.repeat(point[None], len(end), axis=0)
            seen = self.world.are_open(begin, end, last=disc)
            nodes = graph.add_touches(disc[seen], angle[seen])
            graph.link(np.full(len(nodes), node), nodes, np.hypot(*(end[seen] - point).T))

    def _add_tangents(self, graph: TangentGraph, first: Ints, second: Ints, longest: float) -> None:
        lines = between_discs(self.world, first, second)
        able = graph.can_touch(lines.first, lines.first_angle)
        able[able] = graph.can_touch(lines.second[able], lines.second_angle[able])
        lines = lines.only(able)
        begin, end = lines.ends(self.world)
        shortest = np.hypot(*(end - begin).T) + self._shortest_beside(begin, end)
        lines = lines.only(shortest <= longest)
        begin, end = lines.ends(self.world)
        seen = self.world.are_open(begin, end, lines.first, lines.second)
        lengths = np.hypot(*(end - begin).T)[seen]
        lines = lines.only(seen)
        graph.link(
            graph.add_touches(lines.first, lines.first_angle),
            graph.add_touches(lines.second, lines.second_angle),
            lengths,
        )

    def _shortest_beside(self, begin: Floats, end: Floats) -> Floats:
        """Least length (m), shape (S,), of what a way by these lines adds to them."""
        ends = (begin, end)
        from_start = [np.hypot(*(p - self.start).T) for p in ends]
        to_goal = [np.maximum(np.hypot(*(p - self.goal).T) - self.goal_radius, 0.0) for p in ends]
        least: Floats = np.minimum(from_start[0] + to_goal[1], from_start[1] + to_goal[0])
        return least

    def _trace(self, graph: TangentGraph) -> Route | None:
        length, nodes = graph.shortest(_START, _GOAL)
        if not nodes:
            return None
        points = graph.draw(nodes[:-1])
        end, legs = self._towards_goal(points[-1:])
        if legs[0] > 0.0:
            points = np.concatenate([points, end])
        points.flags.writeable = False
        return Route(length, points)


def _beyond(centres: Floats, point: Floats, radii: Floats) -> Floats:
    distance: Floats = np.maximum(np.hypot(*(centres - point).T) - radii, 0.0)
    return distance


def _at_most(bound: Route | None) -> float:
    """Length (m) above which a way is not worth looking at, with room for rounding."""
    return math.inf if bound is None else bound.length * (1.0 + 1e-9) + 1e-6
