"""Claims about polygons, convex and concave, held against shapely and against boxes."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.scenario import parse_scenario
from fuzzyq_bullet.shapes import Box, Polygon

U_SHAPE = ((0, 0), (3, 0), (3, 2), (2.5, 2), (2.5, 0.5), (0.5, 0.5), (0.5, 2), (0, 2))
coordinate = st.floats(-3.0, 3.0).map(lambda v: round(v, 3))
place = st.tuples(coordinate, coordinate)


def polygon(points, **more):
    return Polygon(shape="polygon", points=[(float(x), float(y)) for x, y in points], **more)


@st.composite
def stars(draw):
    """Return a polygon whose corners lie at random distances about a middle: seldom convex."""
    count = draw(st.integers(3, 9))
    radii = draw(st.lists(st.floats(0.2, 2.0), min_size=count, max_size=count))
    turn, x, y = draw(st.floats(0.0, 6.0)), draw(coordinate), draw(coordinate)
    angles = [turn + k * math.tau / count for k in range(count)]
    points = [
        (round(x + r * math.cos(a), 4), round(y + r * math.sin(a), 4))
        for r, a in zip(radii, angles, strict=True)
    ]
    if draw(st.booleans()):
        points.reverse()
    return polygon(points)


def true_distance(one, point):
    solid, at = shapely.Polygon(one.points), shapely.Point(point)
    return -solid.exterior.distance(at) if solid.contains(at) else solid.distance(at)


@given(st.lists(stars(), min_size=1, max_size=3), st.lists(place, min_size=1, max_size=5))
def test_distances_are_those_of_shapely(polygons, points):
    field = Field.of(polygons)
    want = np.array([[true_distance(one, point) for one in polygons] for point in points])
    got = np.array([field.distances(point) for point in points])
    np.testing.assert_allclose(got, want, atol=1e-9)
    np.testing.assert_allclose(field.clearance(points), want.min(axis=1), atol=1e-9)


@settings(max_examples=200)
@given(stars(), place, st.floats(0.0, 6.3), st.floats(0.05, 0.5))
@example(polygon(U_SHAPE), (1.5, 1.0), 0.3, 0.2)
@example(polygon(U_SHAPE), (1.5, 1.0), 0.0, 0.49)
@example(polygon(U_SHAPE), (1.5, 3.0), 3 * math.pi / 2, 0.2)
def test_a_disc_moves_until_it_touches(one, point, heading, radius):
    field = Field.of([one])
    assume(true_distance(one, point) > radius + 1e-6)
    [free] = field.free_distance(point, [heading], radius, 10.0)
    ahead = np.array([math.cos(heading), math.sin(heading)])
    solid = shapely.Polygon(one.points)
    way = shapely.LineString([point, np.add(point, (free - 1e-9) * ahead)])
    assert solid.distance(way) >= radius - 1e-7
    if free < 10.0:
        beyond = shapely.Point(np.add(point, (free + 1e-4) * ahead))
        assert solid.distance(beyond) <= radius + 1e-7


@given(stars(), st.floats(0.0, 6.3), st.floats(0.05, 0.5))
def test_what_is_touched_stops_only_what_comes_nearer(one, heading, radius):
    # A disc driven up to the polygon may turn round and leave, and cannot go on.
    field, ahead = Field.of([one]), np.array([math.cos(heading), math.sin(heading)])
    inside = np.array(shapely.Polygon(one.points).representative_point().coords[0])
    start = inside - 8.0 * ahead
    [free] = field.free_distance(start, [heading], radius, 9.0)
    assert free < 8.0
    there = start + (free + 1e-10) * ahead
    on, back = field.free_distance(there, [heading, heading + math.pi], radius, free)
    assert on < 1e-4
    assert back == pytest.approx(free, abs=1e-4)


@given(place, st.floats(0.05, 3.0), st.floats(0.05, 3.0), st.floats(-3.0, 3.0), st.data())
def test_a_polygon_like_a_box_is_that_box(centre, a, b, yaw, data):
    box = Box(shape="box", position=centre, size=(a, b), yaw=yaw)
    corners = box.outline()[:: data.draw(st.sampled_from([1, -1]))]
    one, other = Field.of([box]), Field.of([polygon(corners)])
    points = data.draw(st.lists(place, min_size=1, max_size=4))
    for point in points:
        np.testing.assert_allclose(one.distances(point), other.distances(point), atol=1e-9)
        clear = one.clearance([point])[0] > 0.3 + 1e-6
        if clear:
            headings = np.linspace(0.0, 6.0, 7) + 0.1
            np.testing.assert_allclose(
                one.free_distance(point, headings, 0.3, 9.0),
                other.free_distance(point, headings, 0.3, 9.0),
                atol=2e-4,  # a corner only grazed is one to the one and none to the other
            )


@given(stars())
def test_its_pieces_are_convex_and_make_it_up(one):
    pieces = [shapely.Polygon(piece) for piece in one.pieces()]
    for piece in pieces:
        assert piece.exterior.is_ccw
        assert piece.convex_hull.area == pytest.approx(piece.area, abs=1e-9)
    assert sum(piece.area for piece in pieces) == pytest.approx(shapely.Polygon(one.points).area)


@given(stars(), place, st.floats(0.0, 6.3))
def test_a_moved_polygon_keeps_its_form(one, to, turn):
    moved = one.moved(*to, turn)
    assert moved.extent() == pytest.approx(Polygon(**moved.model_dump()).extent())
    assert shapely.Polygon(moved.points).area == pytest.approx(
        shapely.Polygon(one.points).area, abs=5e-3
    )
    assert Polygon(**moved.model_dump()) == moved


FILE = """\
name: x
start: {position: [1.0, 1.0]}
goal: {position: [9.0, 9.0]}
obstacles:
  - {shape: box, position: [3.0, 8.0], size: [1.0, 1.0]}
  - shape: polygon
    points:
      - [4.0, 4.0]
"""


@pytest.mark.parametrize(
    ("points", "said"),
    [
        (["[5.0, 4.0]"], "7: obstacles[1].points: must have at least 3 values, got 2"),
        (
            ["[6.0, 6.0]", "[6.0, 4.0]", "[4.0, 6.0]"],
            "10: obstacles[1].points[2]: the side points[2]–points[3] meets the side "
            "points[0]–points[1]; no side may meet another",
        ),
        (
            ["[5.0, 4.0]", "[6.0, 4.0]", "[5.0, 4.0]"],
            "11: obstacles[1].points[3]: is the same place as points[1]",
        ),
        (
            ["[5.0, 4.0]", "[6.0, 6.0]", "[4.0, 4.0]"],
            "11: obstacles[1].points[3]: is the same place as points[0]; leave it out: a polygon "
            "closes by itself",
        ),
        (["[5.0, 4.0]", "[6.0, 4.0]"], "no side may meet another"),
        (
            ["[4.005, 4.0]", "[4.0, 4.005]"],
            "7: obstacles[1].points: enclose 1.2e-05 m²; at least 0.0001 m² are needed",
        ),
        (["[5.0, .nan]", "[6.0, 4.0]"], "9: obstacles[1].points[1][1]: must be finite"),
        (["[5.0]", "[6.0, 4.0]"], "9: obstacles[1].points[1]: needs 2 values"),
    ],
)
def test_what_is_no_polygon_is_refused_where_it_stands(points, said):
    rows = "".join(f"      - {point}\n" for point in points)
    with pytest.raises(UserError) as caught:
        parse_scenario(FILE + rows, "f.yaml")
    assert said in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1


def test_too_many_points_and_a_position_of_its_own_are_refused():
    angles = [k * math.tau / 2001 for k in range(2001)]
    ring = [[5 + math.cos(a), 5 + math.sin(a)] for a in angles]
    head = FILE.split("  - shape")[0]
    with pytest.raises(UserError, match=r"obstacles\[1\].points: must have at most 2000 values"):
        parse_scenario(head + f"  - {{shape: polygon, points: {ring}}}\n")
    given = "[[4.0, 4.0], [5.0, 4.0], [5.0, 5.0]]"
    with pytest.raises(UserError, match="has no position; its points say where it is"):
        parse_scenario(head + f"  - {{shape: polygon, points: {given}, position: [1.0, 1.0]}}\n")
