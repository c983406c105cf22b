"""The exploration graph: which frontiers are offered in which order, and the paths to them."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzyq_bullet.geometry import Field, wrap_angle
from fuzzyq_bullet.ground_truth import feasible
from fuzzyq_bullet.planning.escape.exploration import (
    NEAR,
    ExplorationGraph,
    Node,
    costs_to_go,
    shortest_paths,
)
from fuzzyq_bullet.planning.escape.frontiers import Frontier, find_frontiers
from fuzzyq_bullet.planning.scan import scan_360
from fuzzyq_bullet.scenario import Scenario
from tests.helpers.exploring import BODY, HIDDEN, RANGE, WIDE, free, map_of, observe, standing


def row(gap):
    """Return a long wall of cylinders 0.6 m ahead with a gap in it."""
    half = [(0.6, 0.2 + gap / 2 + 0.4 * k, 0.2) for k in range(8)]
    return [*half, *((x, -y, r) for x, y, r in half)]


def towards(goal):
    """Return an observation of which the goal is all that counts."""
    return observe(Field(), (0.0, 0.0), goal=goal)


def seen_from(field, here):
    """Return a place with its scan, and the frontiers of that."""
    scan = scan_360(observe(field, here))
    return Node(here, scan=scan), list(find_frontiers(0, here, scan))


@given(standing(), st.floats(0.0, 4.0), st.floats(0.0, 4.0))
@settings(max_examples=50)
def test_what_a_place_sees_can_be_reached_straight_on(seen, x, y):
    field, here = seen
    place, _ = seen_from(field, here)
    assert not Node(here).sees((x, y))
    if place.sees((x, y)):
        assert math.dist(here, (x, y)) <= RANGE
        assert free(field, here, (x, y), WIDE - HIDDEN)
    for share in (0.05, 0.5, 0.95):
        near = (here[0] + share * (x - here[0]) / 4.0, here[1] + share * (y - here[1]) / 4.0)
        if free(field, here, near, WIDE + 0.15) and math.dist(here, near) < RANGE:
            assert place.sees(near)


@given(standing())
@settings(max_examples=40)
def test_ways_to_exits_are_free_and_lead_to_what_is_not_seen_yet(seen):
    field, here = seen
    place, frontiers = seen_from(field, here)
    for one in frontiers:
        assert one.distance == pytest.approx(math.dist(here, one.point))
        assert one.distance <= RANGE
        assert free(field, here, one.point, WIDE - HIDDEN)
        if one.beyond is not None:
            assert not place.sees(one.beyond)


def test_in_the_open_exits_lead_to_the_end_of_the_sight_every_fifteen_degrees_or_a_ray_more():
    _, frontiers = seen_from(Field(), (1.0, 1.0))
    apart = np.degrees(np.diff([one.heading for one in frontiers]))
    assert apart.min() > 14.99
    assert apart.max() < 18.01
    assert frontiers[0].heading == 0.0
    assert frontiers[-1].heading > math.radians(340.0)
    assert all(0.5 < one.distance < RANGE < math.dist(one.beyond, (1.0, 1.0)) for one in frontiers)


@pytest.mark.parametrize("side", [1, -1])
def test_past_either_side_of_a_pillar_an_exit_leads_to_where_it_can_be_looked_behind(side):
    _, frontiers = seen_from(Field(np.array([[0.6, 0.0, 0.2]])), (0.0, 0.0))
    edge = side * math.asin((0.2 + WIDE) / 0.6)
    past = [one for one in frontiers if abs(wrap_angle(one.heading - edge)) < math.radians(3.0)]
    past = [one for one in past if abs(one.beyond[1]) < abs(one.point[1])]
    assert past
    # The disc is stopped where it touches the pillar from the side, 0.43 m on: PEEK past that.
    assert max(one.distance for one in past) >= math.sqrt(0.6**2 - 0.42**2) + 0.2


def test_into_a_gap_an_exit_leads_as_far_as_is_free():
    # A wall with a gap of 0.43 m: from here no line leads through.
    field = Field(np.array(row(0.43)))
    _, frontiers = seen_from(field, (0.0, 0.0))
    into = [one for one in frontiers if one.beyond is None]
    assert [(one.heading, one.distance) for one in into] == [
        (0.0, pytest.approx(0.6 - 0.05, abs=0.06))
    ]


@given(st.lists(st.tuples(st.floats(-2, 2), st.floats(-2, 2), st.floats(0.2, 0.5)), max_size=8))
@settings(max_examples=20)
def test_a_robot_twice_as_large_in_a_world_twice_as_large_finds_the_same_ways_twice_as_far(pillars):
    world = np.array([one for one in pillars if math.hypot(*one[:2]) > one[2] + WIDE])
    usual, large = (
        scan_360(observe(Field(size * world), (0.0, 0.0), size=size)) for size in (1.0, 2.0)
    )
    # Gaps are told by what touches the disc, to a measure of the sensor and not of the robot.
    first, second = (
        [one for one in find_frontiers(0, (0.0, 0.0), scan) if one.beyond is not None]
        for scan in (usual, large)
    )
    assert len(first) == len(second)
    for one, other in zip(first, second, strict=True):
        assert other.heading == pytest.approx(one.heading)
        assert other.distance == pytest.approx(2.0 * one.distance)
        assert other.beyond == pytest.approx((2.0 * one.beyond[0], 2.0 * one.beyond[1]))


def explore(field, start, goal, most=1000):
    """Go where the memory sends a point robot until it sees the goal or nothing is left to try.

    Returns:
        Whether it saw the goal, and where it looked.
    """
    here, graph, looks, been = start, ExplorationGraph(), [], {start}
    graph.pass_by(here)
    while not free(field, here, goal, WIDE):
        assert len(looks) < most
        assert min((math.dist(here, one) for one in looks), default=1.0) > NEAR
        graph.scan(observe(field, here, goal=goal))
        looks.append(here)
        found = graph.best_frontier(towards(goal))
        if found is None:
            return False, looks
        chosen, path = found
        assert path[0] == here
        assert path[-1] == chosen.point
        assert set(path[:-1]) <= been
        for there in path[1:]:
            assert free(field, here, there, BODY)
            here = there
            graph.pass_by(here)
            been.add(here)
    return True, looks


def forest(seed):
    rng = np.random.default_rng(seed)
    start, goal = (0.5, 0.5), (4.5, 4.5)
    spots = rng.uniform(0.0, 5.0, (int(rng.integers(14, 26)), 2))
    spots = [one for one in spots.tolist() if min(math.dist(one, e) for e in (start, goal)) > 0.6]
    trees = [{"shape": "cylinder", "position": spot, "radius": 0.25} for spot in spots]
    world = {
        "name": "forest",
        "arena": {"size": (5.0, 5.0)},
        "start": {"position": start},
        "goal": {"position": goal},
        "obstacles": trees,
    }
    return Scenario.model_validate(world), start, goal


@pytest.mark.parametrize("part", range(3))
def test_where_there_is_a_way_its_memory_leads_to_it_on_ways_that_are_free(part):
    reached, looked = 0, 0
    for seed in range(part, 36, 3):
        world, start, goal = forest(seed)
        if feasible(world, WIDE):
            saw, looks = explore(Field.of(world.obstacles, world.arena), start, goal)
            assert saw, f"seed {seed}"
            reached += 1
            looked += len(looks)
    assert reached >= 6
    assert looked > 2 * reached


def test_out_of_a_maze_of_dead_ends_its_memory_leads_the_long_way():
    boxes = [(4.0, 2.5, 0.2, 4.0, 0.0), (3.0, 4.5, 2.2, 0.2, 0.0), (3.0, 0.6, 2.2, 0.2, 0.0)]
    field = Field(boxes=np.array([*boxes, (2.0, 1.6, 0.2, 2.2, 0.0)]), arena=(7.0, 5.5))
    saw, looks = explore(field, (3.2, 2.5), (6.0, 2.5))
    assert saw
    assert len(looks) < 25


@pytest.mark.parametrize("side", [0.6, 1.0, 2.4])
def test_in_a_closed_cell_it_ends_when_all_was_looked_at(side):
    inner, wall = side / 2 + 0.1, side + 0.4
    walls = [
        (inner, 0, 0.2, wall, 0),
        (-inner, 0, 0.2, wall, 0),
        (0, inner, wall, 0.2, 0),
        (0, -inner, wall, 0.2, 0),
    ]
    saw, looks = explore(Field(boxes=np.array(walls)), (-side / 2 + 0.25, 0.0), (5.0, 0.0), 400)
    assert not saw
    # No two looks are within NEAR of each other: discs of half of that do not overlap.
    assert len(looks) <= (side / NEAR + 1.0) ** 2 * 4.0 / math.pi


def offered(graph, goal=(100.0, 0.0)):
    """Take all frontiers out of a memory, best first."""
    frontiers = []
    while (found := graph.best_frontier(towards(goal))) is not None:
        frontiers.append(found[0])
        graph.blacklist(found[0])
        assert len(frontiers) < 500
    return frontiers


def looked(field, *spots):
    graph = ExplorationGraph()
    for spot in spots:
        graph.pass_by(spot)
        graph.scan(observe(field, spot))
    return graph


def test_what_was_given_up_for_good_is_not_offered_again_however_often_it_is_seen():
    field = Field(np.array([[2.6, 2.5, 0.2], [2.6, 1.5, 0.2]]), arena=(100.0, 100.0))
    graph = looked(field, (2.0, 2.0))
    first = offered(graph)
    assert len(first) > 10
    again = [sum(math.dist(a.point, b.point) <= NEAR for b in first) for a in first]
    assert max(again) <= 2  # at the very end what was given up may have a second chance
    for spot in ((2.0, 2.0), (2.01, 2.0), (2.0, 2.02)):
        graph.scan(observe(field, spot))
        for one in offered(graph):
            assert min(math.dist(one.point, other.point) for other in first) > NEAR
            first.append(one)


def test_what_was_seen_from_another_place_is_not_offered_any_more():
    there = (0.75, 0.0)
    before = offered(looked(Field(), (0.0, 0.0)))
    after = offered(looked(Field(), (0.0, 0.0), there))
    assert any(math.dist(one.beyond, there) < RANGE - 0.02 for one in before)
    for one in after:
        assert one.beyond is not None
        assert min(math.dist(one.beyond, (0.0, 0.0)), math.dist(one.beyond, there)) > RANGE
        assert math.dist(one.point, there) > NEAR


def test_the_way_to_an_exit_leads_back_along_what_was_driven_and_cuts_corners_it_has_seen():
    # Along a wall and around its end: from (0, 0) up to (0, 1.6), over it and down to (1.6, 0.2).
    field = Field(boxes=np.array([[0.8, -1.0, 0.4, 4.6, 0.0]]))
    driven = [
        *((0.0, 0.05 * k) for k in range(34)),
        *((0.05 * k, 1.65) for k in range(1, 33)),
    ]
    graph = ExplorationGraph()
    graph.pass_by(driven[0])
    graph.scan(observe(field, driven[0]))
    for here in driven[1:]:
        graph.pass_by(here)
    graph.scan(observe(field, driven[-1]))
    for one in range(30):
        found = graph.best_frontier(towards((0.0, -50.0)))
        assert found is not None, one
        chosen, path = found
        if chosen.point[0] < 0.3 and chosen.point[1] < 0.3:
            break
        graph.blacklist(chosen)
    else:
        pytest.fail("the frontiers seen first are forgotten")
    assert path[0] == driven[-1]
    assert all(free(field, a, b, BODY) for a, b in pairwise(path))
    way = sum(math.dist(a, b) for a, b in pairwise(path))
    assert len(path) < len(driven) - 10  # what was seen in one look is cut short
    assert way <= 1.65 + 1.6 + chosen.distance + 0.01


def test_the_exit_with_the_least_way_to_the_goal_comes_first():
    # The wall ends 0.4 m to the left, and far to the right; the goal is behind it.
    field = Field(boxes=np.array([[0.6, -2.0, 0.2, 4.8, 0.0]]))
    chosen, _ = looked(field, (0.0, 0.0)).best_frontier(towards((3.0, 0.0)))
    assert chosen.point[1] > 0.4
    assert chosen.point[0] > 0.2


@pytest.mark.parametrize("side", [1, -1])
def test_a_gap_it_has_seen_right_through_comes_before_the_way_around(side):
    # 4 mm to spare on either side: on the grid of the promise the gap is shut. The goal stands so
    # far aside that the straight line to it crosses what is beside the gap.
    field = Field(np.array(row(2.0 * WIDE + 0.008)))
    around = [(-0.3, 0.6 * k) for k in range(-6, 7) if k]
    chosen, _ = looked(field, *around, (-0.3, 0.0)).best_frontier(towards((1.4, 2.0 * side)))
    assert abs(chosen.heading) < 0.02
    assert chosen.point[0] > 0.4


@pytest.mark.parametrize(("wall", "way"), [([], 2.05), ([[[1.27, -0.05], [1.27, 0.05]]], 2.2)])
def test_the_way_on_counts_from_the_exit_also_where_it_begins_farther_on(wall, way):
    # With a wall at the end of the sight it begins at the exit, and leads around that.
    known = map_of(np.array(wall).reshape(-1, 2, 2))
    end = Frontier(0, (1.0, 0.0), 0.0, 0.75, (1.27, 0.0), ahead=True)
    assert costs_to_go([end], known, (3.0, 0.0)) == [pytest.approx(way, abs=0.1)]


def test_along_a_wall_that_was_seen_whole_an_end_comes_before_all_that_leads_away():
    # The wall reaches from x = −3 to 3. Straight to the goal, what lies below is less far.
    field = Field(boxes=np.array([[0.0, 1.0, 6.0, 0.2, 0.0]]))
    there = [(round(0.6 * k, 1), 0.5) for k in range(-5, 6)]
    chosen, path = looked(field, *there, (2.1, 0.45), (0.9, 0.45)).best_frontier(
        towards((0.0, 3.0))
    )
    assert chosen.point[0] > 2.7
    assert all(free(field, a, b, BODY) for a, b in pairwise(path))


def test_two_places_near_each_other_with_a_wall_between_are_not_joined():
    field = Field(boxes=np.array([[0.5, -1.0, 0.1, 4.6, 0.0]]))  # up to y = 1.3
    up = [(0.1, 0.05 * k) for k in range(34)]
    over = [(0.05 * k, 1.65) for k in range(3, 19)]
    down = [(0.9, 1.65 - 0.05 * k) for k in range(1, 34)]
    graph = ExplorationGraph()
    for here in up + over + down:
        graph.pass_by(here)
        if here in (up[0], down[-1]):
            graph.scan(observe(field, here))
    count = 0
    while (found := graph.best_frontier(towards((-5.0, 0.0)))) is not None and count < 60:
        assert all(free(field, a, b, BODY) for a, b in pairwise(found[1]))
        graph.blacklist(found[0])
        count += found[0].point[0] < 0.3
    assert count > 3


def test_of_two_exits_as_far_from_the_goal_the_nearer_one_comes_first():
    for goal in ((1.5, 10.0), (1.2, 10.0)):
        chosen, _ = looked(Field(), (0.0, 0.0), (3.0, 0.0)).best_frontier(towards(goal))
        assert chosen.point[0] > 2.0


def test_an_open_way_comes_before_a_gap_that_is_a_little_nearer():
    # A pillar, a gap of 0.43 m and a wall: past the pillar it is 0.3 m farther, and sure.
    wall = [(0.6, -0.415 - 0.4 * k, 0.2) for k in range(8)]
    field = Field(np.array([(0.6, 0.415, 0.2), *wall]))
    assert any(one.beyond is None for one in seen_from(field, (0.0, 0.0))[1])
    chosen, _ = looked(field, (0.0, 0.0)).best_frontier(towards((5.0, 2.0)))
    assert chosen.beyond is not None
    # What is nearer by more than the doubt is worth comes first all the same.
    nearer, _ = looked(Field(np.array(row(0.43))), (0.0, 0.0)).best_frontier(towards((5.0, 0.0)))
    assert nearer.beyond is None


def test_when_all_else_was_tried_what_seems_a_corner_is_tried_too_also_in_later_looks():
    field = Field(np.array(row(0.40)))
    assert [one for one in seen_from(field, (0.0, 0.0))[1] if one.beyond is None] == []
    graph = looked(field, (0.0, 0.0))
    tried = offered(graph)
    doubtful = [one for one in tried if one.beyond is None]
    assert any(abs(wrap_angle(one.heading)) < 0.05 for one in doubtful)
    first = next(k for k, one in enumerate(tried) if one.beyond is None)
    for later in tried[first:]:
        assert later.beyond is None or later in tried[:first]

    graph = looked(field, (-9.0, 0.0))
    offered(graph)
    graph.scan(observe(field, (0.0, 0.0)))
    again = [one for one in offered(graph) if one.beyond is None]
    assert any(abs(wrap_angle(one.heading)) < 0.05 for one in again)


def test_in_a_world_of_nothing_its_first_exit_points_at_the_goal():
    for goal in ((9.0, 0.0), (0.0, 9.0), (-6.0, -6.0)):
        chosen, path = looked(Field(), (0.0, 0.0)).best_frontier(towards(goal))
        assert math.cos(chosen.heading - math.atan2(goal[1], goal[0])) > math.cos(0.14)
        assert path == [(0.0, 0.0), chosen.point]


def test_a_goal_under_the_robot_is_no_mistake():
    chosen, _ = looked(Field(arena=(4.0, 4.0)), (2.0, 2.0)).best_frontier(towards((2.0, 2.0)))
    assert chosen.distance > 0.0


def test_the_shortest_paths_from_the_last_node_follow_its_edges():
    # 0 – 1 – 2 along a line, a long edge from 0 to 3, and a shorter path to it by 2.
    edges = [
        {1: 1.0, 3: 9.0, 4: 0.5},
        {0: 1.0, 2: 1.0},
        {1: 1.0, 3: 1.0},
        {0: 9.0, 2: 1.0},
        {0: 0.5},
    ]
    lengths, before = shortest_paths([Node((0.0, 0.0), edges=one) for one in edges])
    assert lengths == [0.5, 1.5, 2.5, 3.5, 0.0]
    assert before == [4, 0, 1, 2, -1]
