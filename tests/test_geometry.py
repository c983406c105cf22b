"""Claims about the exact plane geometry, held against brute force."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from fuzzyq_bullet.geometry import WALL, Field, wrap_angle
from fuzzyq_bullet.scenario import Arena, Box, Cylinder
from fuzzyq_bullet.shapes import ConvexPolygons

coordinate = st.floats(-3.0, 3.0).map(lambda v: round(v, 3))
angle = st.floats(-7.0, 7.0)
cylinder = st.tuples(coordinate, coordinate, st.floats(0.05, 1.0))
box = st.tuples(coordinate, coordinate, st.floats(0.05, 2.0), st.floats(0.05, 2.0), angle)
ARENA = (6.0, 5.0)


def make(cylinders=(), boxes=(), arena=None):
    return Field(
        np.array(cylinders, dtype=float).reshape(-1, 3),
        np.array(boxes, dtype=float).reshape(-1, 5),
        arena,
    )


def corners(x, y, sx, sy, yaw):
    c, s = math.cos(yaw), math.sin(yaw)
    return [
        (x + c * a * sx / 2 - s * b * sy / 2, y + s * a * sx / 2 + c * b * sy / 2)
        for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]


def distance_to_polygon(p, vertices):
    """Signed distance to a convex anticlockwise polygon, edge by edge."""
    best, inside = math.inf, True
    for (ax, ay), (bx, by) in zip(vertices, vertices[1:] + vertices[:1], strict=True):
        ex, ey, wx, wy = bx - ax, by - ay, p[0] - ax, p[1] - ay
        t = min(1.0, max(0.0, (ex * wx + ey * wy) / (ex * ex + ey * ey)))
        best = min(best, math.hypot(wx - t * ex, wy - t * ey))
        inside &= ex * wy - ey * wx >= 0.0
    return -best if inside else best


def brute_clearance(p, cylinders, boxes, arena):
    gaps = [math.hypot(p[0] - x, p[1] - y) - r for x, y, r in cylinders]
    gaps += [distance_to_polygon(p, corners(*b)) for b in boxes]
    if arena is not None:
        gaps += [p[0], arena[0] - p[0], p[1], arena[1] - p[1]]
    return min(gaps, default=math.inf)


@given(st.floats(-50.0, 50.0))
@example(math.pi)
@example(-math.pi)
@example(3 * math.pi)
def test_a_wrapped_angle_is_the_same_direction_within_half_a_turn(a):
    wrapped = wrap_angle(a)
    assert -math.pi < wrapped <= math.pi
    assert math.isclose(math.cos(wrapped), math.cos(a), abs_tol=1e-9)
    assert math.isclose(math.sin(wrapped), math.sin(a), abs_tol=1e-9)


@given(
    st.lists(cylinder, max_size=4),
    st.lists(box, max_size=4),
    st.sampled_from([None, ARENA]),
    st.lists(st.tuples(coordinate, coordinate), min_size=1, max_size=5),
)
def test_clearance_is_the_least_signed_distance_to_anything(cylinders, boxes, arena, points):
    got = make(cylinders, boxes, arena).clearance(points)
    want = [brute_clearance(p, cylinders, boxes, arena) for p in points]
    np.testing.assert_allclose(got, want, atol=1e-9)


@given(
    st.lists(cylinder, max_size=4),
    st.lists(box, max_size=4),
    st.sampled_from([None, ARENA]),
    st.tuples(coordinate, coordinate),
    st.tuples(coordinate, coordinate),
)
def test_the_least_clearance_on_a_way_is_the_least_of_all_its_points(
    cylinders, boxes, arena, start, end
):
    field = make(cylinders, boxes, arena)
    points = np.linspace(start, end, 400)
    apart = math.dist(start, end) / 399
    sampled = field.clearance(points).min()
    assume(field.clearance(points).max() > 0 and (sampled > 0 or not boxes))
    [least], [place] = field.clearance_along([start], [end])
    assert math.isclose(least, field.clearance([place])[0], abs_tol=1e-9)
    assert sampled - apart / 2 - 1e-9 <= least <= sampled + 1e-9


def test_many_ways_have_the_clearances_that_each_has_alone(monkeypatch):
    rng = np.random.default_rng(5)
    field = make(rng.uniform(0.1, 3.0, (7, 3)), rng.uniform(0.1, 3.0, (5, 5)), ARENA)
    a, b = rng.uniform(-9.0, 9.0, (2, 60, 2))
    alone = [field.clearance_along(p, q) for p, q in zip(a, b, strict=True)]
    monkeypatch.setattr("fuzzyq_bullet.geometry._CHUNK", 100)
    least, places = field.clearance_along(a, b)
    np.testing.assert_array_equal(least, [one[0][0] for one in alone])
    np.testing.assert_array_equal(places, [one[1][0] for one in alone])


def test_clearance_of_many_points_does_not_depend_on_how_they_are_cut_up(monkeypatch):
    rng = np.random.default_rng(1)
    field = make(rng.uniform(0.1, 5, (7, 3)), rng.uniform(0.1, 5, (3, 5)), ARENA)
    points = rng.uniform(0, 6, (101, 2))
    whole = field.clearance(points)
    monkeypatch.setattr("fuzzyq_bullet.geometry._CHUNK", 30)
    np.testing.assert_array_equal(field.clearance(points), whole)


@pytest.mark.slow
@given(
    st.lists(cylinder, max_size=4),
    st.lists(box, max_size=4),
    st.sampled_from([None, ARENA]),
    st.tuples(coordinate, coordinate),
    angle,
    st.floats(0.0, 0.6),
)
@settings(max_examples=300)
def test_free_distance_ends_exactly_at_the_first_contact(
    cylinders, boxes, arena, origin, heading, radius
):
    field = make(cylinders, boxes, arena)
    assume(field.clearance([origin])[0] > radius + 1e-6)
    limit = 4.0
    (free,) = field.free_distance(origin, heading, radius, limit)
    assert 0.0 <= free <= limit
    t = np.linspace(0.0, free, 300)
    way = np.add(origin, t[:, None] * [math.cos(heading), math.sin(heading)])
    gaps = field.clearance(way) - radius
    assert gaps.min() >= -2e-9  # the depth that counts as grazing
    if free < limit:
        assert abs(gaps[-1]) < 1e-9


@pytest.mark.slow
@given(
    st.lists(cylinder, max_size=3),
    st.lists(box, max_size=3),
    st.sampled_from([None, ARENA]),
    st.tuples(coordinate, coordinate),
    angle,
)
@settings(max_examples=300)
def test_an_overlapping_disc_is_stopped_only_by_what_it_would_come_closer_to(
    cylinders, boxes, arena, origin, heading
):
    field, radius = make(cylinders, boxes, arena), 0.5
    singles = [make([c]) for c in cylinders] + [make([], [b]) for b in boxes]
    step = 1e-6 * np.array([math.cos(heading), math.sin(heading)])
    (free,) = field.free_distance(origin, heading, radius, 1.0)
    if arena is not None:
        singles.append(make(arena=arena))
    for single in singles[: len(cylinders) + len(boxes)]:
        before, here, there = single.clearance(np.add(origin, np.outer([-1, 0, 1], step)))
        smooth = abs(before - 2 * here + there) < 1e-10  # not where the nearest side changes
        if here < radius - 1e-6 and abs(there - here) > 1e-8 and smooth:
            (alone,) = single.free_distance(origin, heading, radius, 1.0)
            assert alone == (0.0 if there < here else 1.0)
    together = [float(s.free_distance(origin, heading, radius, 1.0)[0]) for s in singles]
    assert free == min([1.0, *together])


def polygons(boxes):
    """The same rectangles as a shape that knows nothing but its corners; one is padded."""
    return [np.array(corners(*one)) for one in boxes]


@pytest.mark.parametrize("heading", [0.0, 0.6, math.pi / 2, 2.5, -1.0])
def test_a_disc_at_the_very_centre_of_an_obstacle_may_leave_it_any_way(heading):
    blocks = [(1, 1, 1, 1, 0.3)], [(1, 1, 2, 1, 0)]
    shapes = [make([], one) for one in blocks]
    shapes += [Field(groups=[ConvexPolygons(polygons(one))]) for one in blocks]
    for field in (make([(1, 1, 0.5)]), *shapes):
        assert field.free_distance((1, 1), heading, 0.2, 3.0)[0] == 3.0


@given(st.floats(0.0, 0.6), angle, st.lists(angle, min_size=1, max_size=9))
def test_headings_are_answered_one_by_one(radius, yaw, headings):
    field = make([(1.5, 0.3, 0.3), (-1, -1, 0.4)], [(0.2, 1.5, 1.0, 0.4, yaw)])
    batch = field.free_distance((0.0, 0.0), headings, radius, 3.0)
    single = [field.free_distance((0.0, 0.0), h, radius, 3.0)[0] for h in headings]
    np.testing.assert_array_equal(batch, single)


@given(
    st.lists(box, min_size=1, max_size=4),
    st.tuples(coordinate, coordinate),
    st.lists(angle, min_size=1, max_size=5),
    st.floats(0.0, 0.6),
)
@settings(max_examples=200)
def test_a_shape_of_corners_alone_answers_like_the_boxes_of_those_corners(
    boxes, origin, headings, radius
):
    triangle = np.array([(20.0, 20.0), (21.0, 20.0), (20.5, 23.0), (20.2, 22.5), (20.0, 21.5)])
    known = make([], boxes)
    field = Field(groups=[ConvexPolygons([*polygons(boxes), triangle])])
    gaps = known.distances(origin)
    np.testing.assert_allclose(field.distances(origin)[:-1], gaps, atol=1e-9)
    # Just touching, and where several sides are nearest, rounding decides.
    assume(np.abs(gaps - radius).min() > 1e-6 and gaps.min() > 1e-6)
    np.testing.assert_allclose(
        field.free_distance(origin, headings, radius, 4.0),
        known.free_distance(origin, headings, radius, 4.0),
        atol=1e-6,
    )


def test_known_contacts():
    disc = make([(2.0, 0.0, 0.5)])
    assert disc.free_distance((0, 0), 0.0, 0.2, 9.0) == pytest.approx(1.3)
    assert disc.free_distance((0, 0.7), 0.0, 0.2, 9.0) == 9.0  # grazes
    square = make([], [(2.0, 0.0, 1.0, 1.0, 0.0)])
    assert square.free_distance((0, 0), 0.0, 0.2, 9.0) == pytest.approx(1.3)
    corner = 1.5 - math.sqrt(0.2**2 - 0.1**2)
    assert square.free_distance((0, 0.6), 0.0, 0.2, 9.0) == pytest.approx(corner)
    turned = make([], [(2.0, 0.0, 1.0, 1.0, math.pi / 4)])
    assert turned.free_distance((0, 0), 0.0, 0.2, 9.0) == pytest.approx(1.8 - math.sqrt(0.5))
    walls = make(arena=(4.0, 3.0))
    four = walls.free_distance((1, 1), [0.0, math.pi / 2, math.pi, -math.pi / 2], 0.2, 9.0)
    np.testing.assert_allclose(four, [2.8, 1.8, 0.8, 0.8])


@pytest.mark.parametrize("heading", [math.pi / 2, -math.pi / 2])
def test_a_disc_that_touches_slides_along_though_the_cosine_of_a_right_angle_is_not_zero(heading):
    for field in (
        make(arena=(10.0, 100.0)),
        make([(10.3, 50.0, 0.5)]),
        make([], [(10.5, 50.0, 1.0, 200.0, 0.0)]),
    ):
        for x in (9.8, 9.8 + 1e-15):
            assert field.free_distance((x, 50.0), heading, 0.2, 5.0)[0] == 5.0
            assert field.free_distance((x, 50.0), 0.0, 0.2, 5.0)[0] == pytest.approx(0, abs=1e-12)
            assert field.free_distance((x, 50.0), math.pi, 0.2, 5.0)[0] == 5.0


def test_an_empty_field_is_free_everywhere():
    field = Field()
    assert field.clearance([(0, 0)])[0] == math.inf
    assert field.nearest((0, 0)) == (WALL, math.inf)
    assert field.free_distance((0, 0), 1.0, 0.2, 1.5)[0] == 1.5


def test_indices_are_those_of_the_scenario_with_shapes_mixed():
    obstacles = [
        Box(shape="box", position=(1.0, 1.0), size=(0.4, 0.4)),
        Cylinder(shape="cylinder", position=(3.0, 1.0), radius=0.2),
        Box(shape="box", position=(5.0, 1.0), size=(0.4, 0.4), yaw=0.3),
    ]
    field = Field.of(obstacles, Arena(size=(9.0, 9.0)))
    for i, item in enumerate(obstacles):
        assert field.nearest(item.position) == (i, -0.2)
    assert field.nearest((8.5, 5.0)) == (WALL, 0.5)
    np.testing.assert_allclose(field.distances((1.0, 2.0)), [0.8, math.sqrt(5) - 0.2, 3.88], 1e-2)
    assert Field.of(obstacles, Arena(size=(9.0, 9.0), walls=False)).walls is None


def test_a_field_is_frozen_and_shares_no_memory_with_what_it_was_built_from():
    source = np.array([[2.0, 0.0, 0.5]])
    field = Field(source)
    source[0, 0] = 99.0
    assert field.nearest((0, 0)) == (0, 1.5)
    with pytest.raises(ValueError, match="read-only"):
        field.groups[0].discs[0, 0] = 1.0
    with pytest.raises(AttributeError):
        field.arena = (1.0, 1.0)


def test_numbering_an_obstacle_twice_is_refused():
    with pytest.raises(ValueError, match="number all obstacles once"):
        Field(np.ones((2, 3)), order=[0, 0])


def test_where_something_is_touched_lies_on_its_surface() -> None:
    field = Field(
        cylinders=np.array([[2.0, 2.0, 0.5]]),
        boxes=np.array([[6.0, 2.0, 2.0, 1.0, 0.0]]),
        arena=(10.0, 10.0),
    )
    for point, index, place in [
        ((3.0, 2.0), 0, (2.5, 2.0)),
        ((6.2, 3.0), 1, (6.2, 2.5)),
        ((5.0, 9.7), WALL, (5.0, 10.0)),
    ]:
        found, touched = field.touching(point)
        assert found == index
        assert touched == pytest.approx(place, abs=1e-4)
