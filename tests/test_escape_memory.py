"""What the escape remembers: what it sees, what that promises, and which ways are still to try."""

from __future__ import annotations

import math
from itertools import groupby, pairwise

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.sparse import csgraph

from fuzzyq_bullet.geometry import Field, wrap_angle
from fuzzyq_bullet.ground_truth import feasible
from fuzzyq_bullet.planning import Decision, Observation, promise
from fuzzyq_bullet.planning.base import STEP_UNIT
from fuzzyq_bullet.planning.course import PATIENCE as COURSE_PATIENCE
from fuzzyq_bullet.planning.course import Course, Leg
from fuzzyq_bullet.planning.escape import GAIN, PATIENCE, Escape
from fuzzyq_bullet.planning.exits import Exit, exits_of
from fuzzyq_bullet.planning.places import NEAR, Place, Places
from fuzzyq_bullet.planning.promise import Walls
from fuzzyq_bullet.planning.view import look_around
from fuzzyq_bullet.scenario import Scenario

RANGE, BODY, WIDE = 1.0, 0.2, 0.22
"""How far the robot sees, its radius and half the width of a detection line (m)."""

HIDDEN = 0.07
"""How much of what the disc would touch may stand unseen between two rays (m).

The disc slides along something: the ray that meets it last before the place of contact and the
next one, 3° on, leave up to ρ²·sin 3° / r = 0.27 m of a flat face between them, which is
half of that from the nearer hit: a disc of √(0.22² − 0.14²) = 0.17 m would still touch it. At a
corner met from one side 1.22 m · sin 3° = 0.064 m are lost, and more only behind a cylinder thinner
than 0.2 m."""
ROUNDING = 1e-6
"""Headings are told to so much (rad), and so many metres more or less make no difference."""


def walls_of(seen):
    walls = Walls()
    walls.add(seen)
    return walls


def observe(field, here, *, goal=(100.0, 0.0), time=0.0, sense=None):
    """Return what a robot observes at a place, with exact rays."""
    return Observation(
        time=time,
        position=here,
        heading=0.0,
        speed=0.0,
        turn_rate=0.0,
        goal=goal,
        goal_radius=0.2,
        range=RANGE,
        radius=WIDE,
        sense=sense or (lambda headings: field.free_distance(here, headings, WIDE, RANGE)),
        look=lambda headings: field.free_distance(here, headings, 0.0, RANGE + WIDE),
    )


def free(field, here, there, radius):
    """Return whether a disc can move straight from one point to another."""
    way = math.dist(here, there)
    heading = math.atan2(there[1] - here[1], there[0] - here[0])
    return bool(field.free_distance(here, [heading], radius, way)[0] >= way - ROUNDING)


# ---- the view


@st.composite
def standing(draw):
    """A robot that stands free somewhere in a world of things at least 0.4 m thick."""
    place = st.floats(0.0, 4.0)
    size = st.floats(0.4, 1.2)
    cylinders = draw(st.lists(st.tuples(place, place, st.floats(0.2, 0.5)), max_size=8))
    boxes = draw(st.lists(st.tuples(place, place, size, size, st.floats(0.0, 3.1)), max_size=4))
    field = Field(np.array(cylinders), np.array(boxes), draw(st.sampled_from([(4.0, 4.0), None])))
    here = draw(st.tuples(st.floats(0.3, 3.7), st.floats(0.3, 3.7)))
    assume(field.clearance([here])[0] >= WIDE)
    return field, here


@given(standing())
@settings(max_examples=80)
def test_what_a_look_tells_is_free_up_to_what_may_hide_between_two_rays(seen):
    field, here = seen
    view = look_around(observe(field, here))
    headings, told = np.array(view.headings), np.array(view.lengths)
    assert (np.diff(headings) > 0.0).all()
    assert headings[0] >= 0.0
    assert headings[-1] < math.tau
    assert told.min() >= 0.0
    assert told.max() <= RANGE
    # Along the very edge of something the exact answer jumps from one heading to the next.
    exact = np.min(
        [
            field.free_distance(here, headings + turn, WIDE + ROUNDING, RANGE)
            for turn in (-ROUNDING, 0.0, ROUNDING)
        ],
        axis=0,
    )
    assert (told >= exact - ROUNDING).all()
    assert (told <= field.free_distance(here, headings, WIDE - HIDDEN, RANGE) + ROUNDING).all()


def test_as_a_rule_a_look_is_exact_to_a_centimetre():
    rng = np.random.default_rng(5)
    late, count = 0, 0
    for _ in range(60):
        field = Field(np.column_stack([rng.uniform(0, 4, (6, 2)), rng.uniform(0.2, 0.5, 6)]))
        here = tuple(rng.uniform(0.3, 3.7, 2).tolist())
        if field.clearance([here])[0] < WIDE:
            continue
        view = look_around(observe(field, here))
        thinner = field.free_distance(here, view.headings, WIDE - 0.01, RANGE)
        late += int((np.array(view.lengths) > thinner + ROUNDING).sum())
        count += len(view.lengths)
    assert count > 3000
    assert late < 0.02 * count


@given(standing(), st.floats(-10.0, 10.0))
@settings(max_examples=50)
def test_between_two_headings_no_more_is_free_than_along_either(seen, heading):
    field, here = seen
    view = look_around(observe(field, here))
    apart = np.array([wrap_angle(one - heading) for one in view.headings])
    assume(np.abs(apart).min() > ROUNDING)
    left = int(np.where(apart > 0.0, apart, np.inf).argmin())
    right = int(np.where(apart < 0.0, apart, -np.inf).argmax())
    assert view.free(heading) == min(view.lengths[left], view.lengths[right])
    assert view.free(heading + math.tau) == view.free(heading)


@given(standing())
@settings(max_examples=50)
def test_walls_lie_where_the_centre_of_the_disc_would_be_stopped(seen):
    field, here = seen
    walls = look_around(observe(field, here)).walls
    assert walls.shape[1:] == (2, 2)
    if len(walls):
        clearance = field.clearance(walls.reshape(-1, 2))
        assert clearance.max() <= WIDE + ROUNDING
        assert clearance.min() >= WIDE - HIDDEN
        # Each is one piece of one boundary, from one heading to the next: 3°, or where it recedes.
        assert np.hypot(*(walls[:, 1] - walls[:, 0]).T).max() <= math.hypot(0.3, math.radians(3.0))


def test_a_wall_in_front_is_seen_without_a_hole_and_its_end_is_open():
    field = Field(boxes=np.array([[1.0, 1.0, 0.2, 2.4, 0.0]]))  # from y = −0.2 up to 2.2
    walls = look_around(observe(field, (0.0, 0.0))).walls
    known = walls_of(walls)
    crossed = [y for y in np.arange(-0.3, 0.45, 0.01) if not known.in_sight((0.0, y), (2.0, y))]
    assert crossed
    assert np.diff(crossed) == pytest.approx(0.01)
    assert crossed[-1] == pytest.approx(0.44)
    assert crossed[0] == pytest.approx(-0.3)  # −0.2 and half the width are blocked
    assert known.in_sight((0.0, -0.45), (2.0, -0.45))


def test_where_nothing_stands_all_is_free_and_there_are_no_walls():
    view = look_around(observe(Field(), (3.0, 2.0)))
    assert set(view.lengths) == {RANGE}
    assert view.walls.shape == (0, 2, 2)
    assert view.gaps == []


@pytest.mark.parametrize("apart", [0.2, 0.205, 0.215])
def test_what_the_robot_stands_too_near_to_does_not_keep_it_from_moving_away(apart):
    for field in (
        Field(np.array([[0.0, apart + 0.2, 0.2]])),
        Field(boxes=np.array([[0.0, apart + 0.1, 4.0, 0.2, 0.0]])),
    ):
        view = look_around(observe(field, (0.0, 0.0)))
        assert view.free(math.pi / 2) == pytest.approx(0.0, abs=0.002)
        for turn in np.radians([20.0, 60.0, 90.0, 120.0, 160.0]):
            assert view.free(-turn) == RANGE
        assert all(map(math.isfinite, view.lengths))


def test_a_robot_beside_a_wall_sees_the_way_along_it():
    view = look_around(observe(Field(boxes=np.array([[0.0, 0.31, 4.0, 0.2, 0.0]])), (0.0, 0.0)))
    assert view.free(-0.03) == pytest.approx(1.0)
    assert view.free(math.pi + 0.03) == pytest.approx(1.0)
    assert view.free(math.pi / 2) < 0.02


def seen_between(width, distance, aside, turned):
    """Return gaps and free ways that a robot sees between two cylinders."""
    turn = np.array([[math.cos(turned), -math.sin(turned)], [math.sin(turned), math.cos(turned)]])
    centres = np.array([[0.0, 0.2 + width / 2], [0.0, -0.2 - width / 2]]) @ turn.T
    here = tuple((turn @ (-distance, aside)).tolist())
    field = Field(np.column_stack([centres, [0.2, 0.2]]))
    assert field.clearance([here])[0] >= WIDE
    view = look_around(observe(field, here))
    towards = math.atan2(-here[1], -here[0])

    def between(k):
        return abs(wrap_angle(view.headings[k] - towards)) < 0.35

    through = min(RANGE, math.hypot(distance, aside) + 0.05)
    ways = [k for k, length in enumerate(view.lengths) if between(k) and length >= through]
    return [k for k in view.gaps if between(k)], ways


TURNS = np.linspace(0.0, math.radians(3.0), 5)


@pytest.mark.parametrize("distance", [0.4, 0.6, 0.8, 0.9])
def test_a_gap_two_centimetres_wider_than_a_line_is_seen(distance):
    for aside in (-0.25, -0.1, 0.0, 0.05, 0.15):
        for turned in TURNS:
            gaps, ways = seen_between(0.46, distance, aside, turned)
            assert gaps or ways


@pytest.mark.parametrize("distance", [0.4, 0.6, 0.8, 0.9])
def test_where_a_gap_is_as_wide_as_a_line_the_way_into_it_is_told_as_one(distance):
    for aside in (-0.1, 0.0, 0.05, 0.15):
        for turned in TURNS:
            gaps, ways = seen_between(0.44, distance, aside, turned)
            assert gaps or ways
            assert gaps or aside  # straight in front, too, where no line goes through


@pytest.mark.parametrize("distance", [0.3, 0.4, 0.5, 0.6])
def test_a_gap_too_narrow_is_none_seen_from_the_front(distance):
    # The disc touches both sides 0.419 m apart, 1.6 cm less than what is taken for a gap; rays 3°
    # apart meet the sides up to 1.6 cm beside that: farther off, or aslant, it may seem wider.
    for aside in (-0.1, 0.0, 0.05, 0.1):
        if math.hypot(distance, 0.4 - abs(aside)) < 0.42:
            continue
        for turned in TURNS:
            assert seen_between(0.40, distance, aside, turned) == ([], [])


@pytest.mark.parametrize("distance", [0.4, 0.5, 0.7, 0.9])
def test_a_gap_far_too_narrow_is_none_from_wherever_it_is_seen(distance):
    for aside in (-0.2, -0.1, 0.0, 0.15):
        for turned in TURNS:
            assert seen_between(0.30, distance, aside, turned) == ([], [])


# ---- what the known walls promise


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
    assert walls_of(WALL).in_sight(start, goal) is clear
    assert walls_of(WALL).in_sight(goal, start) is clear
    assert walls_of(WALL[:, ::-1]).in_sight(start, goal) is clear
    far = WALL + 50.0
    walls = walls_of(far)
    walls.add(WALL)
    assert walls.in_sight(start, goal) is clear


def test_without_walls_everything_is_in_sight():
    assert Walls().in_sight((0.0, 0.0), (5.0, 5.0))


EIGHT = 1.0 / math.cos(math.pi / 8)
"""A way on a grid of eight directions is longer than the straight one by no more than this."""
ENDS = 2.0 * math.sqrt(2.0) * promise.CELL
"""Two ends that lie anywhere in their cells (m)."""


@given(st.floats(-3, 3), st.floats(-3, 3))
@settings(max_examples=20)
def test_through_the_open_the_least_way_is_the_straight_one(x, y):
    [way] = Walls().ways_to_goal((0.3, 0.2), [(x, y)])
    straight = math.dist((x, y), (0.3, 0.2))
    assert straight - ENDS <= way <= EIGHT * straight + ENDS


def test_around_a_wall_the_least_way_leads_past_its_nearer_end():
    wall = pieces(np.array([[[0.0, -4.0], [0.0, 1.0]]]), 40)
    ways = walls_of(wall).ways_to_goal((1.0, 0.0), [(-1.0, 0.0), (0.5, 0.0)])
    around = 2.0 * math.sqrt(2.0)
    # The cells of the wall's end are gone round too.
    assert around - ENDS <= ways[0] <= EIGHT * around + ENDS + 2.0 * promise.CELL
    assert ways[1] == pytest.approx(0.5, abs=ENDS)


def square(half, at=(0.0, 0.0)):
    corners = [(1, 1), (-1, 1), (-1, -1), (1, -1), (1, 1)]
    points = [(at[0] + half * x, at[1] + half * y) for x, y in corners]
    return np.array(list(pairwise(points)))


def pieces(walls, count):
    """Cut each wall into as many pieces as a view would tell."""
    parts = np.linspace(0.0, 1.0, count + 1)
    ends = walls[:, 0, None] + (walls[:, 1] - walls[:, 0])[:, None] * parts[:, None]
    return np.stack([ends[:, :-1], ends[:, 1:]], axis=2).reshape(-1, 2, 2)


def test_walls_that_are_seen_later_count_as_if_all_had_been_known_from_the_start():
    ring, starts = pieces(square(1.0), 40), [(3.0, 0.0), (0.5, 0.0)]
    far = ring + np.array([6.0, 0.0])  # beyond all that was known: another grid
    walls = walls_of(ring[:-4])
    [through, _] = walls.ways_to_goal((0.0, 0.0), starts)
    assert math.isfinite(through)
    for later, known in ((ring[-4:], ring), (far, np.concatenate([ring, far]))):
        walls.add(later)
        ways = walls.ways_to_goal((0.0, 0.0), starts)
        assert ways == walls_of(known).ways_to_goal((0.0, 0.0), starts)
        assert math.isinf(ways[0])
        assert math.isfinite(ways[1])


@pytest.mark.parametrize("turned", [0.0, 0.4, math.pi / 4])
def test_out_of_an_enclosure_there_is_no_way_and_within_it_there_is(turned):
    walls = pieces(square(1.0), 40)
    turn = np.array([[math.cos(turned), -math.sin(turned)], [math.sin(turned), math.cos(turned)]])
    out, within = walls_of(walls @ turn.T).ways_to_goal((0.0, 0.0), [(3.0, 0.0), (0.5, 0.0)])
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
    walls = walls_of(pieces(square(0.4, (size / 2, 0.0)), 40))
    [way] = walls.ways_to_goal((0.0, 0.0), [(size, size)])
    straight = size * math.sqrt(2.0)
    assert way == pytest.approx(straight, rel=0.09)
    assert 0.2 * promise.MOST < sizes[0] <= 1.1 * promise.MOST


# ---- places and exits


def row(gap):
    """Return a long wall of cylinders 0.6 m ahead with a gap in it."""
    half = [(0.6, 0.2 + gap / 2 + 0.4 * k, 0.2) for k in range(8)]
    return [*half, *((x, -y, r) for x, y, r in half)]


def seen_from(field, here):
    """Return a place with its view, and the exits of that."""
    view = look_around(observe(field, here))
    return Place(here, view=view), list(exits_of(0, here, view))


@given(standing(), st.floats(0.0, 4.0), st.floats(0.0, 4.0))
@settings(max_examples=50)
def test_what_a_place_sees_can_be_reached_straight_on(seen, x, y):
    field, here = seen
    place, _ = seen_from(field, here)
    assert not Place(here).sees((x, y))
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
    place, exits = seen_from(field, here)
    for exit_ in exits:
        assert exit_.way == pytest.approx(math.dist(here, exit_.point))
        assert exit_.way <= RANGE
        assert free(field, here, exit_.point, WIDE - HIDDEN)
        if exit_.beyond is not None:
            assert not place.sees(exit_.beyond)


def test_in_the_open_exits_lead_to_the_end_of_the_sight_every_fifteen_degrees_or_a_ray_more():
    _, exits = seen_from(Field(), (1.0, 1.0))
    apart = np.degrees(np.diff([one.heading for one in exits]))
    assert apart.min() > 14.99
    assert apart.max() < 18.01
    assert exits[0].heading == 0.0
    assert exits[-1].heading > math.radians(340.0)
    assert all(0.5 < one.way < RANGE < math.dist(one.beyond, (1.0, 1.0)) for one in exits)


@pytest.mark.parametrize("side", [1, -1])
def test_past_either_side_of_a_pillar_an_exit_leads_to_where_it_can_be_looked_behind(side):
    _, exits = seen_from(Field(np.array([[0.6, 0.0, 0.2]])), (0.0, 0.0))
    edge = side * math.asin((0.2 + WIDE) / 0.6)
    past = [one for one in exits if abs(wrap_angle(one.heading - edge)) < math.radians(3.0)]
    past = [one for one in past if abs(one.beyond[1]) < abs(one.point[1])]
    assert past
    # The disc is stopped where it touches the pillar from the side, 0.43 m on: PEEK past that.
    assert max(one.way for one in past) >= math.sqrt(0.6**2 - 0.42**2) + 0.2


def test_into_a_gap_an_exit_leads_as_far_as_is_free():
    # A wall with a gap of 0.43 m: from here no line leads through.
    field = Field(np.array(row(0.43)))
    _, exits = seen_from(field, (0.0, 0.0))
    into = [one for one in exits if one.beyond is None]
    assert [(one.heading, one.way) for one in into] == [(0.0, pytest.approx(0.6 - 0.05, abs=0.06))]


def explore(field, start, goal, most=1000):
    """Go where the memory sends a point robot until it sees the goal or nothing is left to try.

    Returns:
        Whether it saw the goal, and where it looked.
    """
    here, places, looks, been = start, Places(), [], {start}
    places.pass_by(here)
    while not free(field, here, goal, WIDE):
        assert len(looks) < most
        assert min((math.dist(here, one) for one in looks), default=1.0) > NEAR
        places.look_around(observe(field, here, goal=goal))
        looks.append(here)
        found = places.best_exit(goal)
        if found is None:
            return False, looks
        chosen, route = found
        assert route[0] == here
        assert route[-1] == chosen.point
        assert set(route[:-1]) <= been
        for there in route[1:]:
            assert free(field, here, there, BODY)
            here = there
            places.pass_by(here)
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


def offered(places, goal=(100.0, 0.0)):
    """Take all exits out of a memory, best first."""
    exits = []
    while (found := places.best_exit(goal)) is not None:
        exits.append(found[0])
        places.give_up(found[0])
        assert len(exits) < 500
    return exits


def looked(field, *spots):
    places = Places()
    for spot in spots:
        places.pass_by(spot)
        places.look_around(observe(field, spot))
    return places


def test_what_was_given_up_for_good_is_not_offered_again_however_often_it_is_seen():
    field = Field(np.array([[2.6, 2.5, 0.2], [2.6, 1.5, 0.2]]), arena=(100.0, 100.0))
    places = looked(field, (2.0, 2.0))
    first = offered(places)
    assert len(first) > 10
    again = [sum(math.dist(a.point, b.point) <= NEAR for b in first) for a in first]
    assert max(again) <= 2  # at the very end what was given up may have a second chance
    for spot in ((2.0, 2.0), (2.01, 2.0), (2.0, 2.02)):
        places.look_around(observe(field, spot))
        for exit_ in offered(places):
            assert min(math.dist(exit_.point, one.point) for one in first) > NEAR
            first.append(exit_)


def test_what_was_seen_from_another_place_is_not_offered_any_more():
    there = (0.75, 0.0)
    before = offered(looked(Field(), (0.0, 0.0)))
    after = offered(looked(Field(), (0.0, 0.0), there))
    assert any(math.dist(one.beyond, there) < RANGE - 0.02 for one in before)
    for exit_ in after:
        assert exit_.beyond is not None
        assert min(math.dist(exit_.beyond, (0.0, 0.0)), math.dist(exit_.beyond, there)) > RANGE
        assert math.dist(exit_.point, there) > NEAR


def test_the_way_to_an_exit_leads_back_along_what_was_driven_and_cuts_corners_it_has_seen():
    # Along a wall and around its end: from (0, 0) up to (0, 1.6), over it and down to (1.6, 0.2).
    field = Field(boxes=np.array([[0.8, -1.0, 0.4, 4.6, 0.0]]))
    driven = [
        *((0.0, 0.05 * k) for k in range(34)),
        *((0.05 * k, 1.65) for k in range(1, 33)),
    ]
    places = Places()
    places.pass_by(driven[0])
    places.look_around(observe(field, driven[0]))
    for here in driven[1:]:
        places.pass_by(here)
    places.look_around(observe(field, driven[-1]))
    for exit_ in range(30):
        found = places.best_exit((0.0, -50.0))
        assert found is not None, exit_
        chosen, route = found
        if chosen.point[0] < 0.3 and chosen.point[1] < 0.3:
            break
        places.give_up(chosen)
    else:
        pytest.fail("the exits seen first are forgotten")
    assert route[0] == driven[-1]
    assert all(free(field, a, b, BODY) for a, b in pairwise(route))
    way = sum(math.dist(a, b) for a, b in pairwise(route))
    assert len(route) < len(driven) - 10  # what was seen in one look is cut short
    assert way <= 1.65 + 1.6 + chosen.way + 0.01


def test_the_exit_with_the_least_way_to_the_goal_comes_first():
    # The wall ends 0.4 m to the left, and far to the right; the goal is behind it.
    field = Field(boxes=np.array([[0.6, -2.0, 0.2, 4.8, 0.0]]))
    chosen, _ = looked(field, (0.0, 0.0)).best_exit((3.0, 0.0))
    assert chosen.point[1] > 0.4
    assert chosen.point[0] > 0.2


@pytest.mark.parametrize("side", [1, -1])
def test_a_gap_it_has_seen_right_through_comes_before_the_way_around(side):
    # 4 mm to spare on either side: on the grid of the promise the gap is shut. The goal stands so
    # far aside that the straight line to it crosses what is beside the gap.
    field = Field(np.array(row(2.0 * WIDE + 0.008)))
    around = [(-0.3, 0.6 * k) for k in range(-6, 7) if k]
    chosen, _ = looked(field, *around, (-0.3, 0.0)).best_exit((1.4, 2.0 * side))
    assert abs(chosen.heading) < 0.02
    assert chosen.point[0] > 0.4


@pytest.mark.parametrize(("wall", "way"), [([], 2.05), ([[[1.27, -0.05], [1.27, 0.05]]], 2.2)])
def test_the_way_on_counts_from_the_exit_also_where_it_begins_farther_on(wall, way):
    # With a wall at the end of the sight it begins at the exit, and leads around that.
    places = Places()
    places._walls.add(np.array(wall).reshape(-1, 2, 2))
    places._exits = [Exit(0, (1.0, 0.0), 0.0, 0.75, (1.27, 0.0), ahead=True)]
    assert places._ways_on((3.0, 0.0)) == [pytest.approx(way, abs=0.1)]


def test_along_a_wall_that_was_seen_whole_an_end_comes_before_all_that_leads_away():
    # The wall reaches from x = −3 to 3. Straight to the goal, what lies below is less far.
    field = Field(boxes=np.array([[0.0, 1.0, 6.0, 0.2, 0.0]]))
    there = [(round(0.6 * k, 1), 0.5) for k in range(-5, 6)]
    chosen, route = looked(field, *there, (2.1, 0.45), (0.9, 0.45)).best_exit((0.0, 3.0))
    assert chosen.point[0] > 2.7
    assert all(free(field, a, b, BODY) for a, b in pairwise(route))


def test_two_places_near_each_other_with_a_wall_between_are_not_joined():
    field = Field(boxes=np.array([[0.5, -1.0, 0.1, 4.6, 0.0]]))  # up to y = 1.3
    up = [(0.1, 0.05 * k) for k in range(34)]
    over = [(0.05 * k, 1.65) for k in range(3, 19)]
    down = [(0.9, 1.65 - 0.05 * k) for k in range(1, 34)]
    places = Places()
    for here in up + over + down:
        places.pass_by(here)
        if here in (up[0], down[-1]):
            places.look_around(observe(field, here))
    count = 0
    while (found := places.best_exit((-5.0, 0.0))) is not None and count < 60:
        assert all(free(field, a, b, BODY) for a, b in pairwise(found[1]))
        places.give_up(found[0])
        count += found[0].point[0] < 0.3
    assert count > 3


def test_of_two_exits_as_far_from_the_goal_the_nearer_one_comes_first():
    for goal in ((1.5, 10.0), (1.2, 10.0)):
        chosen, _ = looked(Field(), (0.0, 0.0), (3.0, 0.0)).best_exit(goal)
        assert chosen.point[0] > 2.0


def test_an_open_way_comes_before_a_gap_that_is_a_little_nearer():
    # A pillar, a gap of 0.43 m and a wall: past the pillar it is 0.3 m farther, and sure.
    wall = [(0.6, -0.415 - 0.4 * k, 0.2) for k in range(8)]
    field = Field(np.array([(0.6, 0.415, 0.2), *wall]))
    assert any(one.beyond is None for one in seen_from(field, (0.0, 0.0))[1])
    chosen, _ = looked(field, (0.0, 0.0)).best_exit((5.0, 2.0))
    assert chosen.beyond is not None
    # What is nearer by more than the doubt is worth comes first all the same.
    nearer, _ = looked(Field(np.array(row(0.43))), (0.0, 0.0)).best_exit((5.0, 0.0))
    assert nearer.beyond is None


def test_when_all_else_was_tried_what_seems_a_corner_is_tried_too_also_in_later_looks():
    field = Field(np.array(row(0.40)))
    assert [one for one in seen_from(field, (0.0, 0.0))[1] if one.beyond is None] == []
    places = looked(field, (0.0, 0.0))
    tried = offered(places)
    doubtful = [one for one in tried if one.beyond is None]
    assert any(abs(wrap_angle(one.heading)) < 0.05 for one in doubtful)
    first = next(k for k, one in enumerate(tried) if one.beyond is None)
    for later in tried[first:]:
        assert later.beyond is None or later in tried[:first]

    places = looked(field, (-9.0, 0.0))
    offered(places)
    places.look_around(observe(field, (0.0, 0.0)))
    again = [one for one in offered(places) if one.beyond is None]
    assert any(abs(wrap_angle(one.heading)) < 0.05 for one in again)


def test_in_a_world_of_nothing_its_first_exit_points_at_the_goal():
    for goal in ((9.0, 0.0), (0.0, 9.0), (-6.0, -6.0)):
        chosen, route = looked(Field(), (0.0, 0.0)).best_exit(goal)
        assert math.cos(chosen.heading - math.atan2(goal[1], goal[0])) > math.cos(0.14)
        assert route == [(0.0, 0.0), chosen.point]


def test_a_goal_under_the_robot_is_no_mistake():
    chosen, _ = looked(Field(arena=(4.0, 4.0)), (2.0, 2.0)).best_exit((2.0, 2.0))
    assert chosen.way > 0.0


# ---- the escape


class Walk:
    """A robot that is put somewhere, and what its escape decides there."""

    def __init__(self, field, goal):
        self.escape, self.field, self.goal, self.time = Escape(), field, goal, 0.0

    def decide(self, here, *, middle=None, sense=None):
        """Return the decision a quarter of a second later; ``middle``: the line to the goal."""
        self.time += 0.25
        seen = observe(self.field, here, goal=self.goal, time=self.time, sense=sense)
        bearing = math.atan2(self.goal[1] - here[1], self.goal[0] - here[0])
        lines = np.array([bearing + 0.8, bearing, bearing - 0.8])
        lengths = np.array(seen.sense(lines))
        lengths[1] = lengths[1] if middle is None else middle
        routine = Decision(
            heading=7.0,
            step=0.1,
            lines=lines,
            lengths=lengths,
            weights=(1.0, 1.0),
            breakout_at=1.0,
        )
        return self.escape.decide(routine, seen)


WALLED = Field(boxes=np.array([[0.7, 0.0, 0.1, 6.0, 0.0]]))
"""The goal at (5, 0) is behind a wall; from the origin the line to it is free for 0.43 m."""


def stalled():
    """A robot that came no nearer for too long, 0.43 m before the wall: its first breakout."""
    walk = Walk(WALLED, (5.0, 0.0))
    while (decision := walk.decide((0.0, 0.0))).mode == "routine":
        assert walk.time <= PATIENCE + 0.6
    assert decision.mode == "breakout"
    assert walk.time > PATIENCE
    return walk


def test_a_stalled_robot_does_not_leave_where_it_stalled():
    walk = stalled()
    for _ in range(10):
        assert walk.decide((0.0, 0.0)).mode == "following"


def test_it_leaves_where_the_line_leads_nearer_than_the_line_that_did_not_help():
    # The line led to 0.43 m before the goal's 5 m. At the same distance from the goal elsewhere:
    as_before = math.dist((0.1, 1.0), (5.0, 0.0)) - 4.57
    for more in (-0.1, 0.0, GAIN * STEP_UNIT - 0.02):
        walk = stalled()
        assert walk.decide((0.1, 1.0), middle=as_before + more).mode == "following"
    walk = stalled()
    left = walk.decide((0.1, 1.0), middle=as_before + GAIN * STEP_UNIT + 0.02)
    assert left.mode == "routine"
    # ... and it drives that line, not the controller's heading, until it is nearer than ever.
    assert left.heading == pytest.approx(math.atan2(-1.0, 4.9))
    assert not left.hopeless
    away = walk.decide((0.0, 0.5), middle=0.6)
    assert (away.mode, away.heading) == ("routine", pytest.approx(math.atan2(-0.5, 5.0)))
    nearer = walk.decide((0.3, 0.2), middle=0.6)
    assert (nearer.mode, nearer.heading) == ("routine", 7.0)


def test_it_leaves_where_the_line_leads_to_the_goal():
    walk = stalled()
    assert walk.decide((4.0, 1.0), middle=math.dist((4.0, 1.0), (5.0, 0.0))).mode == "routine"


def test_a_blocked_robot_looks_at_once():
    walk = Walk(WALLED, (5.0, 0.0))
    assert walk.decide((0.0, 0.0)).mode == "routine"
    decision = walk.decide((0.3, 0.0))  # 0.13 m before it stops
    assert decision.mode == "breakout"
    assert abs(decision.target[1]) > 0.5


def test_where_it_comes_nearer_it_leaves_the_controller_alone():
    walk = Walk(WALLED, (5.0, 0.0))
    for k in range(30):
        decision = walk.decide((-2.0 + 0.05 * k, 0.0))
        assert (decision.mode, decision.heading) == ("routine", 7.0)


def test_an_exit_that_cannot_be_reached_is_tried_twice_and_then_given_up():
    walk = stalled()
    held = []  # the robot is held where it is, though all ways seem free
    while not (decision := walk.decide((0.0, 0.0))).hopeless:
        held.append(decision.target)
        assert len(held) < 2000
    tries = [(target, len(list(decisions))) for target, decisions in groupby(held)]
    targets = {target for target, _ in tries}
    assert len(targets) > 3
    # None is come back to before all the others were tried.
    assert {target for target, _ in tries[: len(targets)]} == targets
    twice = 2 * COURSE_PATIENCE / 0.25 + 2
    counts = [count for _, count in tries[1:]]
    assert counts[: len(targets) - 1] == pytest.approx([twice] * (len(targets) - 1), abs=2)
    assert max(counts) <= twice + 2
    assert len(tries) <= 2 * len(targets)
    assert decision.step == decision.reach == 0.0


def test_where_no_way_is_free_it_knows_at_once_that_it_is_hopeless():
    walk = Walk(Field(arena=(0.46, 0.46)), (5.0, 0.0))
    decision = walk.decide((0.23, 0.23))
    assert decision.hopeless
    assert decision.step == decision.reach == 0.0


def test_where_ways_are_seen_but_none_can_be_gone_it_ends_hopeless_soon():
    walk = Walk(WALLED, (5.0, 0.0))
    walk.decide((0.3, 0.0))
    for _ in range(60):
        decision = walk.decide((0.3, 0.0), sense=lambda headings: np.zeros(len(headings)))
        if decision.hopeless:
            break
        assert decision.mode == "following"
    assert decision.hopeless


def test_at_an_exit_it_looks_again_and_goes_on_to_another():
    walk = stalled()
    first = walk.decide((0.0, 0.0)).target
    second = walk.decide(first)
    assert second.mode == "following"
    assert math.dist(second.target, first) > NEAR


def test_near_the_goal_a_line_that_leads_to_it_is_taken_though_little_is_to_gain():
    walk = Walk(Field(boxes=np.array([[0.4, 0.0, 0.1, 0.3, 0.0]])), (0.2, 0.0))
    assert walk.decide((0.0, 0.0), middle=0.1).mode == "breakout"
    assert walk.decide((0.15, 0.3), middle=0.25).mode == "following"
    assert walk.decide((0.15, 0.3), middle=0.31).mode == "routine"


def test_a_line_that_leads_nearer_but_is_blocked_is_not_taken():
    walk = stalled()
    assert walk.decide((0.8, 0.0), middle=0.1).mode == "following"


def test_a_robot_that_comes_no_nearer_but_sees_nothing_on_its_line_goes_on():
    walk = Walk(Field(), (5.0, 0.0))
    assert {walk.decide((0.0, 0.0)).mode for _ in range(40)} == {"routine"}


def test_it_drives_each_leg_of_its_course_and_no_farther(monkeypatch):
    walk = stalled()
    monkeypatch.setattr(Course, "next", lambda self, observation: Leg(1.2, 0.03, 0.02))
    decision = walk.decide((0.0, 0.0))
    assert (decision.heading, decision.reach) == (1.2, 0.02)
    assert decision.step <= 0.03


def test_ways_to_the_wanted_places_are_the_same_whatever_else_is_asked_for():
    # 0 – 1 – 2 along a line, a long way from 0 to 3, and a shorter one to it by 2.
    places = Places()
    for joined in (
        {1: 1.0, 3: 9.0},
        {0: 1.0, 2: 1.0},
        {1: 1.0, 3: 1.0},
        {0: 9.0, 2: 1.0},
        {0: 0.5},
    ):
        places._places.append(Place((0.0, 0.0), ways=dict(joined)))
    places._places[0].ways[4] = 0.5
    whole, before = places._ways(set(range(5)))
    assert whole == [0.5, 1.5, 2.5, 3.5, 0.0]
    for wanted in ({0}, {3}, {1, 3}, {2, 3}):
        ways, back = places._ways(set(wanted))
        assert [ways[one] for one in wanted] == [whole[one] for one in wanted]
        assert [back[one] for one in wanted] == [before[one] for one in wanted]


def test_the_way_to_every_exit_is_asked_for(monkeypatch):
    places, asked = Places(), []
    places._places += [Place((0.0, 0.0), ways={1: 1.0}), Place((1.0, 0.0), ways={0: 1.0})]
    places._exits += [Exit(place, (2.0, place), 0.0, 1.0, None) for place in (1, 0)]
    ways = places._ways
    monkeypatch.setattr(places, "_ways", lambda wanted: asked.append(set(wanted)) or ways(wanted))
    places.best_exit((3.0, 0.0))
    assert asked == [{0, 1}]
