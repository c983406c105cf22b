"""What the obstacles seen so far leave of paths to the goal."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import csgraph

from fuzzyq_bullet.occupancy import OccupancyGrid
from fuzzyq_bullet.planning.escape.cost_to_go import CELL, MOST, TIGHT, ObstacleMap
from tests.helpers.exploring import map_of

WALL = np.array([[[1.0, -1.0], [1.0, 1.0]]])


@pytest.mark.parametrize(
    ("start", "goal", "clear"),
    [
        ((0.0, 0.0), (2.0, 0.0), False),
        ((2.0, 0.0), (0.0, 0.5), False),
        ((0.0, 0.0), (0.9, 0.0), True),  # short of it
        ((2.0, 0.0), (1.1, 0.5), True),
        ((0.0, 0.0), (2.0, 4.0), True),  # past its end
        ((0.0, -3.0), (0.0, 3.0), True),  # beside it
        ((0.0, 1.0), (2.0, 1.0), False),  # touching its end
        ((0.0, 0.0), (1.0, 0.0), False),  # ending on it
        ((1.0, 0.5), (3.0, 0.5), False),  # beginning on it
        ((1.0, -2.0), (1.0, 2.0), False),  # along it
    ],
)
def test_a_line_is_in_sight_if_it_neither_crosses_nor_touches_a_wall(start, goal, clear):
    assert map_of(WALL).in_sight(start, goal) is clear
    assert map_of(WALL).in_sight(goal, start) is clear
    assert map_of(WALL[:, ::-1]).in_sight(start, goal) is clear
    far = WALL + 50.0
    walls = map_of(far)
    walls.add(WALL)
    assert walls.in_sight(start, goal) is clear


def test_without_walls_everything_is_in_sight():
    assert ObstacleMap().in_sight((0.0, 0.0), (5.0, 5.0))


EIGHT = 1.0 / math.cos(math.pi / 8)
"""A way on a grid of eight directions is longer than the straight one by no more than this."""
ENDS = 2.0 * math.sqrt(2.0) * CELL
"""Two ends that lie anywhere in their cells (m)."""


@given(st.floats(-3, 3), st.floats(-3, 3))
@settings(max_examples=20)
def test_through_the_open_the_least_way_is_the_straight_one(x, y):
    [way] = ObstacleMap().cost_to_go((0.3, 0.2), [(x, y)])
    straight = math.dist((x, y), (0.3, 0.2))
    assert straight - ENDS <= way <= EIGHT * straight + ENDS


def test_around_a_wall_the_least_way_leads_past_its_nearer_end():
    wall = pieces(np.array([[[0.0, -4.0], [0.0, 1.0]]]), 40)
    ways = map_of(wall).cost_to_go((1.0, 0.0), [(-1.0, 0.0), (0.5, 0.0)])
    around = 2.0 * math.sqrt(2.0)
    # The cells of the wall's end are gone round too.
    assert around - ENDS <= ways[0] <= EIGHT * around + ENDS + 2.0 * CELL
    assert ways[1] == pytest.approx(0.5, abs=ENDS)


def square(half, at=(0.0, 0.0)):
    corners = [(1, 1), (-1, 1), (-1, -1), (1, -1), (1, 1)]
    points = [(at[0] + half * x, at[1] + half * y) for x, y in corners]
    return np.array(list(pairwise(points)))


def pieces(walls, count):
    """Cut each wall into as many pieces as a scan would tell."""
    parts = np.linspace(0.0, 1.0, count + 1)
    ends = walls[:, 0, None] + (walls[:, 1] - walls[:, 0])[:, None] * parts[:, None]
    return np.stack([ends[:, :-1], ends[:, 1:]], axis=2).reshape(-1, 2, 2)


def test_walls_that_are_seen_later_count_as_if_all_had_been_known_from_the_start():
    ring, starts = pieces(square(1.0), 40), [(3.0, 0.0), (0.5, 0.0)]
    far = ring + np.array([6.0, 0.0])  # beyond all that was known: another grid
    walls = map_of(ring[:-4])
    [through, _] = walls.cost_to_go((0.0, 0.0), starts)
    assert math.isfinite(through)
    for later, known in ((ring[-4:], ring), (far, np.concatenate([ring, far]))):
        walls.add(later)
        ways = walls.cost_to_go((0.0, 0.0), starts)
        assert ways == map_of(known).cost_to_go((0.0, 0.0), starts)
        assert math.isinf(ways[0])
        assert math.isfinite(ways[1])


@pytest.mark.parametrize("turned", [0.0, 0.4, math.pi / 4])
def test_out_of_an_enclosure_there_is_no_way_and_within_it_there_is(turned):
    walls = pieces(square(1.0), 40)
    turn = np.array([[math.cos(turned), -math.sin(turned)], [math.sin(turned), math.cos(turned)]])
    out, within = map_of(walls @ turn.T).cost_to_go((0.0, 0.0), [(3.0, 0.0), (0.5, 0.0)])
    assert out == math.inf
    assert within == pytest.approx(0.5, abs=ENDS)


@pytest.mark.parametrize("size", [30.0, 300.0, 1e5])
def test_however_large_the_world_the_grid_stays_small(size, monkeypatch):
    sizes = []

    def counting(graph, **rest):
        sizes.append(graph.shape[0])
        return dijkstra(graph, **rest)

    dijkstra = csgraph.dijkstra
    monkeypatch.setattr(csgraph, "dijkstra", counting)
    walls = map_of(pieces(square(0.4, (size / 2, 0.0)), 40))
    [way] = walls.cost_to_go((0.0, 0.0), [(size, size)])
    straight = size * math.sqrt(2.0)
    assert way == pytest.approx(straight, rel=0.09)
    assert 0.2 * MOST < sizes[0] <= 1.1 * MOST


def ring(radius, gap):
    """Points on a circle about the origin, 0.02 m apart, with a gap so wide (m) towards +x."""
    half = gap / 2.0 / radius
    angles = np.arange(half, math.tau - half, 0.02 / radius)
    return radius * np.column_stack([np.cos(angles), np.sin(angles)])


def test_through_a_gap_with_no_room_for_the_disc_a_path_costs_more():
    def cost(gap):
        walls = ObstacleMap()
        walls.add(np.zeros((0, 2, 2)), ring(1.0, gap), 0.22)
        return walls.cost_to_go((0.0, 0.0), [(2.0, 0.0)])[0]

    assert cost(0.8) == pytest.approx(2.0, abs=0.3)
    assert cost(0.2) == pytest.approx(2.0 + TIGHT, abs=0.3)
    assert cost(0.0) == pytest.approx(2.0 + TIGHT, abs=0.3)  # the boundaries know of no wall


def test_what_lies_within_a_radius_of_a_point_is_covered():
    grid = OccupancyGrid.over((-1.0, -1.0), (1.0, 1.0), 0.1)
    grid.cover(np.array([[0.23, -0.31], [5.0, 5.0]]), 0.17)
    middles = grid.points() + 0.05
    away = np.hypot(*np.moveaxis(middles - (0.23, -0.31), 2, 0))
    assert (grid.free == (away > 0.17)).all()
