"""Claims about the oracle: exact where the answer is known, and between two grids elsewhere."""

from __future__ import annotations

import math
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

import fuzzyq_bullet
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.ground_truth import GRAZE, Route, feasible, shortest_path, spl
from fuzzyq_bullet.ground_truth.configuration_space import ConfigurationSpace
from fuzzyq_bullet.ground_truth.search import shortest_route
from fuzzyq_bullet.scenario import Scenario, realise
from fuzzyq_bullet.shapes import Box, Boxes, ConvexPolygons

EXACT = 1e-9
"""Closed forms and the oracle differ by rounding and by the root of what may graze."""


def task(*obstacles, start=(1.0, 5.0), goal=(9.0, 5.0), radius=0.2, size=(10.0, 10.0), **rest):
    walls = rest.pop("walls", True)
    return Scenario.model_validate(
        {
            "name": "asked",
            "arena": {"size": size, "walls": walls},
            "start": {"position": start},
            "goal": {"position": goal, "radius": radius},
            "obstacles": obstacles,
            **rest,
        }
    )


def pillar(x, y, radius):
    return {"shape": "cylinder", "position": [x, y], "radius": radius}


def block(x0, y0, x1, y1):
    """A box by its lower left and upper right corners."""
    position, size = [(x0 + x1) / 2, (y0 + y1) / 2], [x1 - x0, y1 - y0]
    return {"shape": "box", "position": position, "size": size}


def length(scenario, radius=0.2) -> float:
    route = shortest_path(scenario, radius)
    assert route is not None
    assert feasible(scenario, radius)
    assert_sound(scenario, radius, route)
    return route.length


def assert_sound(scenario: Scenario, radius: float, route: Route) -> None:
    """A route begins at the start, ends in the goal, hits nothing and is as long as it says."""
    points = route.points
    assert tuple(points[0]) == scenario.start.position
    to_goal = math.dist(points[-1], scenario.goal.position)
    assert to_goal <= scenario.goal.radius + 1e-8
    between = [np.linspace(a, b, 2 + int(math.dist(a, b) / 0.02)) for a, b in pairwise(points)]
    field = Field.of(scenario.obstacles, scenario.arena)
    for part in between:  # chords of arcs stray into what they go around by less than 1 mm
        assert field.clearance(part).min() >= radius - 1e-3
    drawn = float(np.hypot(*np.diff(points, axis=0).T).sum())
    assert route.length * 0.998 - 1e-9 <= drawn <= route.length + 1e-7


# --- where the answer is known


@pytest.mark.parametrize("walls", [True, False])
def test_an_empty_arena_is_crossed_straight_to_the_rim_of_the_goal(walls):
    assert length(task(walls=walls)) == pytest.approx(8.0 - 0.2, abs=EXACT)


def test_one_cylinder_is_passed_by_a_line_an_arc_and_a_line():
    around, aside = 0.8 + 0.2, 4.0  # the grown radius; the distance of both ends
    expected = 2 * math.sqrt(aside**2 - around**2)
    expected += around * (math.pi - 2 * math.acos(around / aside)) - 0.2
    assert length(task(pillar(5, 5, 0.8))) == pytest.approx(expected, abs=EXACT)


@pytest.mark.parametrize("radius", [0.1, 0.2, 0.35])
def test_boxes_given_by_their_corners_alone_leave_the_same_way(radius):
    rng = np.random.default_rng(4)
    rows = np.column_stack([rng.uniform(2, 8, (14, 2)), rng.uniform(0.3, 1.5, (14, 2))])
    boxes = [
        Box(shape="box", position=(x, y), size=(a, b), yaw=yaw)
        for yaw, (x, y, a, b) in enumerate(rows.tolist())
    ]
    spaces = [
        ConfigurationSpace(Field(arena=(10.0, 10.0), groups=[group]), radius)
        for group in (Boxes.of(boxes), ConvexPolygons([one.outline() for one in boxes]))
    ]
    one, other = (shortest_route(space, (0.5, 0.5), (9.5, 9.5), 0.2) for space in spaces)
    assert one.length > math.dist((0.5, 0.5), (9.5, 9.5)) - 0.2 + EXACT  # not straight
    assert other.length == pytest.approx(one.length, abs=EXACT)


def test_the_arc_is_that_of_the_disc_that_moves():
    lengths = [length(task(pillar(5, 5, 0.5)), radius) for radius in (0.01, 0.2, 0.4)]
    expected = [
        2 * math.sqrt(16 - r * r) + r * (math.pi - 2 * math.acos(r / 4)) - 0.2
        for r in (0.51, 0.7, 0.9)
    ]
    assert lengths == pytest.approx(expected, abs=EXACT)


def test_a_cylinder_is_passed_on_its_nearer_side_whichever_that_is():
    upwards = {"start": (5.0, 1.0), "goal": (5.0, 9.0)}
    beside = [length(task(pillar(x, 5, 0.8), **upwards)) for x in (4.7, 5.3)]
    across = [length(task(pillar(5, y, 0.8))) for y in (4.7, 5.3)]
    assert beside + across == pytest.approx([across[0]] * 4, abs=EXACT)


@pytest.mark.parametrize("turn", [0.0, math.pi / 2])
def test_a_box_is_passed_by_its_corners_and_along_its_side(turn):
    size = [1.0, 2.0] if turn == 0.0 else [2.0, 1.0]
    box = {"shape": "box", "position": [5.0, 5.0], "size": size, "yaw": turn}
    to_corner = math.hypot(3.5, 1.0)
    rise = math.atan2(1.0, 3.5) + math.asin(0.2 / to_corner)
    expected = 2 * (math.sqrt(to_corner**2 - 0.04) + 0.2 * rise) + 1.0 - 0.2
    assert length(task(box)) == pytest.approx(expected, abs=EXACT)


def test_two_cylinders_on_opposite_sides_are_passed_in_an_s():
    # By symmetry through the centre of the inner tangent: two halves that mirror each other.
    high, low = pillar(4, 5.5, 1.3), pillar(6, 4.5, 1.3)
    closed = block(3.9, 6.0, 4.1, 10.0), block(5.9, 0.0, 6.1, 4.0)
    s = task(high, low, *closed, size=(10.0, 10.0), radius=0.05)
    apart, r = math.sqrt(5.0), 1.5
    assert apart < 2 * r  # they overlap once grown: no way between
    assert shortest_path(s) is None
    r = 0.8
    s = task(pillar(4, 5.5, 0.6), pillar(6, 4.5, 0.6), *closed, radius=0.05)
    to_low, to_tangent = math.hypot(3.0, 0.5), math.sqrt(9.25 - r * r)
    first = -(math.asin(r / to_low) - math.atan2(0.5, 3.0))  # heading of the first line
    middle = math.atan2(-1.0, 2.0) + math.asin(2 * r / apart)  # heading of the inner tangent
    expected = 2 * (to_tangent + r * (middle - first)) + math.sqrt(5.0 - 4 * r * r) - 0.05
    assert length(s) == pytest.approx(expected, abs=EXACT)


def test_a_u_shape_is_left_backwards_and_passed_outside():
    s = task(
        block(6.0, 3.0, 6.4, 7.0), block(4.0, 3.0, 6.4, 3.4), block(4.0, 6.6, 6.4, 7.0),
        start=(5.0, 5.0), radius=0.05,
    )  # fmt: skip
    out = math.hypot(1.0, 1.6)  # to the inner corner of a leg's end, two more and the goal
    back = math.hypot(9.0 - 6.4, 2.0)
    # The inner corner (4, 6.6) and the outer (4, 7), the outer (6.4, 7), and down to the goal.
    turn_in = math.atan2(1.6, 1.0) - math.asin(0.2 / out)  # from −x towards +y
    turn_out = math.atan2(2.0, 2.6) + math.asin(0.2 / back)  # from +x towards −y
    expected = math.sqrt(out**2 - 0.04) + 0.2 * (math.pi / 2 - turn_in) + 0.4
    expected += 0.2 * math.pi / 2 + 2.4 + 0.2 * turn_out + math.sqrt(back**2 - 0.04) - 0.05
    assert length(s) == pytest.approx(expected, abs=EXACT)


def test_a_maze_has_the_way_that_its_walls_leave():
    walls = [block(x, 0.0, x + 0.2, 9.0) for x in (2.0, 6.0)]
    walls.append(block(4.0, 1.0, 4.2, 10.0))
    s = task(*walls, goal=(9.0, 1.0), start=(1.0, 1.0))
    # Over the first wall, under the second, over the third; each leg nearly as high as the arena.
    assert 8.0 * 4 < length(s) < 8.0 * 4 + 8.0
    assert not feasible(task(*walls, block(4.0, 0.0, 4.2, 0.7), goal=(9.0, 1.0), start=(1.0, 1.0)))


def test_it_goes_around_outside_where_there_are_no_walls():
    barrier = block(4.8, -1.0, 5.2, 11.0)
    assert shortest_path(task(barrier)) is None
    assert length(task(barrier, walls=False)) > 2 * math.hypot(4.0, 6.0) - 0.2


def gap_of(kind, gap):
    """A barrier from wall to wall with one gap of that width (m) between two things."""
    if kind == "boxes":
        return task(block(4.8, 0.0, 5.2, 3.0), block(4.8, 3.0 + gap, 5.2, 10.0))
    if kind == "cylinders":
        low, high = 3.0, 3.0 + 0.8 + gap
        closed = block(4.8, 0.0, 5.2, low), block(4.8, high, 5.2, 10.0)
        return task(pillar(5, low, 0.4), pillar(5, high, 0.4), *closed)
    if kind == "cylinder and wall":
        return task(pillar(5, gap + 0.4, 0.4), block(4.8, gap + 0.4, 5.2, 10.0))
    if kind == "box and wall":
        return task(block(4.8, gap, 5.2, 10.0))
    if kind == "cylinder and box":
        return task(block(4.8, 0.0, 5.2, 3.0), pillar(5, 3.4 + gap, 0.4), block(4.8, 4.0, 5.2, 10))
    turned = {"shape": "box", "position": [5.0, gap + 1.0], "size": [math.sqrt(2)] * 2}
    return task({**turned, "yaw": math.pi / 4}, block(4.9, gap + 1.0, 5.1, 10.0))


GAPS = ["boxes", "cylinders", "cylinder and wall", "box and wall", "cylinder and box", "corner"]


@pytest.mark.parametrize("kind", GAPS)
@pytest.mark.parametrize("more", [1e-3, 1e-6, 1e-8])
def test_a_gap_is_open_to_what_is_narrower_and_closed_to_what_is_wider(kind, more):
    assert length(gap_of(kind, 0.4 + more)) > 7.8
    assert feasible(gap_of(kind, 0.4 + more))
    assert shortest_path(gap_of(kind, 0.4 - more)) is None
    assert not feasible(gap_of(kind, 0.4 - more))


@pytest.mark.parametrize("kind", GAPS)
def test_a_gap_exactly_as_wide_as_the_disc_is_open_whatever_the_rounding(kind):
    through = length(gap_of(kind, 0.4))
    assert through == pytest.approx(length(gap_of(kind, 0.4 + 1e-7)), abs=1e-4)


@pytest.mark.parametrize("turn", np.linspace(0.1, 3.0, 7))
def test_a_gap_turned_by_any_angle_is_told_to_the_micrometre(turn):
    for more, through in ((1e-6, True), (-1e-6, False)):
        c, s = math.cos(turn), math.sin(turn)
        bars = [
            {
                "shape": "box",
                "position": [5 + d * c, 5 + d * s],
                "size": [9.6, 0.3],
                "yaw": float(turn),
            }
            for d in (5.0 + more / 2, -5.0 - more / 2)
        ]
        ends = [(5 - 1.5 * s * k, 5 + 1.5 * c * k) for k in (1, -1)]
        scenario = task(*bars, start=ends[0], goal=ends[1])
        assert feasible(scenario) is through
        if through:
            assert length(scenario) == pytest.approx(3.0 - 0.2, abs=1e-6)


def test_a_start_that_is_walled_in_has_no_way():
    ring = [pillar(1.5 + math.cos(a), 5 + math.sin(a), 0.3) for a in np.arange(0, 6.2, 0.5)]
    assert shortest_path(task(*ring, start=(1.5, 5.0))) is None
    assert not feasible(task(*ring, start=(1.5, 5.0)))
    assert length(task(*ring[1:], start=(1.5, 5.0)), 0.05) > 7.0


def test_a_goal_that_is_walled_in_has_no_way():
    ring = [pillar(8.5 + math.cos(a), 5 + math.sin(a), 0.3) for a in np.arange(0, 6.2, 0.5)]
    assert shortest_path(task(*ring, goal=(8.5, 5.0))) is None


def test_a_start_that_does_not_fit_has_no_way():
    for scenario in (task(pillar(1.0, 5.3, 0.2)), task(start=(0.1, 5.0)), task(start=(-1.0, 5.0))):
        assert shortest_path(scenario) is None
        assert not feasible(scenario)


def test_a_start_in_the_goal_is_there_already():
    route = shortest_path(task(start=(8.0, 5.0), radius=1.5))
    assert route is not None
    assert route.length == 0.0
    assert route.points.tolist() == [[8.0, 5.0]]
    assert length(task(start=(9.0, 5.0))) == 0.0


def test_a_start_that_touches_can_still_leave():
    # A quarter round the grown disc, of radius 0.4, and a little less than straight on.
    assert 7.8 < length(task(pillar(1.4, 5.0, 0.2))) < 7.8 + 0.4 * math.pi / 2


def test_a_goal_whose_centre_is_covered_is_reached_at_its_rim():
    roof = block(0.0, 5.1, 10.0, 9.0)  # the disc may go up to y = 4.9
    s = task(roof, start=(2.0, 4.9), goal=(5.0, 5.0), radius=0.5)
    assert length(s) == pytest.approx(3.0 - math.sqrt(0.25 - 0.01), abs=1e-7)
    # From below and aside, the straight leg to the centre would meet the rim within the roof.
    s = task(block(0.0, 5.8, 10.0, 9.0), start=(2.0, 5.5), goal=(5.0, 5.95), radius=0.5)
    corner = 5.0 - math.sqrt(0.25 - 0.35**2)
    assert 5.95 - 0.5 * math.sin(math.atan2(0.45, 3.0)) > 5.6
    assert length(s) == pytest.approx(math.dist((2.0, 5.5), (corner, 5.6)), abs=1e-7)
    assert shortest_path(task(block(4.0, 4.0, 6.0, 6.0), goal=(5.0, 5.0), radius=0.5)) is None


def test_an_arc_may_end_the_way_where_it_meets_the_rim():
    # The goal lies behind the pillar, close: its near rim is met before any line leaves the arc.
    s = task(pillar(5.0, 5.0, 0.8), start=(4.0, 5.0), goal=(6.1, 5.0), radius=0.5)
    meets = math.acos((1.0 + 1.1**2 - 0.25) / 2.2)  # angle at the pillar's centre
    assert length(s) == pytest.approx(math.pi - meets, abs=1e-6)


# --- where only a grid can tell

SIDE, STEP, BODY = 3.0, 0.03, 0.15
_MOVES = [(1, 0), (0, 1), (1, 1), (1, -1), (1, 2), (2, 1), (1, -2), (2, -1)]
_AT = np.arange(0.0, SIDE + STEP / 2, STEP)
_GRID = np.stack(np.meshgrid(_AT, _AT, indexing="ij"), axis=-1)
_LONGEST = STEP * math.sqrt(5.0)
_DETOUR = 1 / math.cos(math.radians(13.3))
"""Ways along 16 directions are at most this much longer than straight ones."""


def along_grid(scenario, radius, goal_radius):
    """Length (m) of the shortest way on the grid; infinite if there is none."""
    n = len(_AT)
    field = Field.of(scenario.obstacles, scenario.arena)
    free = (field.clearance(_GRID.reshape(-1, 2)) >= radius).reshape(n, n)
    index = np.arange(n * n).reshape(n, n)
    rows, columns, lengths = [], [], []
    for dx, dy in _MOVES:
        a = np.s_[: n - dx, max(0, -dy) : n - max(0, dy)]
        b = np.s_[dx:, max(0, dy) : n - max(0, -dy)]
        both = free[a] & free[b]
        rows.append(index[a][both])
        columns.append(index[b][both])
        lengths.append(np.full(both.sum(), STEP * math.hypot(dx, dy)))
    links = np.concatenate(lengths), (np.concatenate(rows), np.concatenate(columns))
    ix, iy = np.rint(np.array(scenario.start.position) / STEP).astype(int)
    if not free[ix, iy]:
        return math.inf
    graph = csr_matrix(links, shape=(n * n, n * n))
    distance = dijkstra(graph, directed=False, indices=index[ix, iy])
    there = np.hypot(*(_GRID.reshape(-1, 2) - scenario.goal.position).T) <= goal_radius
    return float(distance[there].min(initial=math.inf))


on_grid = st.integers(0, round(SIDE / STEP)).map(lambda k: round(k * STEP, 2))
spot = st.tuples(on_grid, on_grid)
inside = st.tuples(*[st.integers(7, 93).map(lambda k: round(k * STEP, 2))] * 2)
pillars = st.builds(pillar, on_grid, on_grid, st.floats(0.05, 0.4))
blocks = st.builds(
    lambda x, y, a, b, yaw: {"shape": "box", "position": [x, y], "size": [a, b], "yaw": yaw},
    on_grid, on_grid, st.floats(0.05, 1.5), st.floats(0.05, 0.5),
    st.sampled_from([0.0, math.pi / 2]) | st.floats(-3.2, 3.2),
)  # fmt: skip


@pytest.mark.slow
@settings(max_examples=40)
@given(
    st.lists(pillars, max_size=9),
    st.lists(blocks, max_size=4),
    inside,
    inside,
    st.floats(0.05, 0.5),
)
@example([pillar(1.5, 1.5, 0.4)] * 2, [], (0.3, 1.5), (2.7, 1.5), 0.1)
def test_it_lies_between_a_grid_that_is_too_strict_and_one_that_is_too_lax(
    cylinders, boxes, start, goal, radius
):
    s = task(*cylinders, *boxes, start=start, goal=goal, radius=radius, size=(SIDE, SIDE))
    route = shortest_path(s, BODY)
    assert feasible(s, BODY) is (route is not None)
    # Half the longest move away from nodes that are that much freer, everything is free.
    strict = along_grid(s, BODY + _LONGEST / 2, radius)
    if route is None:
        assert strict == math.inf
        return
    assert_sound(s, BODY, route)
    assert route.length <= strict + EXACT
    # Next to any free point there is a node that is nearly free.
    lax = along_grid(s, BODY - STEP / math.sqrt(2) - EXACT, radius + STEP / math.sqrt(2))
    assert lax < math.inf
    assert route.length >= (lax - 2 * STEP) / _DETOUR - 0.05


@settings(max_examples=25)
@given(st.lists(pillars, max_size=6), st.lists(blocks, max_size=2), st.floats(0, 6.3))
def test_turning_the_whole_world_changes_nothing(cylinders, boxes, turn):
    c, s = math.cos(turn), math.sin(turn)

    def turned(item):
        x, y = item["position"]
        yaw = {"yaw": item["yaw"] + turn} if "yaw" in item else {}
        return {**item, "position": [c * x - s * y, s * x + c * y], **yaw}

    things = [*cylinders, *boxes]
    ends = [(-1.0, 1.5), (4.0, 1.5)]
    moved = [(c * x - s * y, s * x + c * y) for x, y in ends]
    still = task(*things, start=ends[0], goal=ends[1], walls=False)
    spun = task(*map(turned, things), start=moved[0], goal=moved[1], walls=False)
    a, b = shortest_path(still, BODY), shortest_path(spun, BODY)
    assert (a is None) == (b is None)
    if a is not None and b is not None:
        assert a.length == pytest.approx(b.length, abs=1e-7)


@settings(max_examples=40)
@given(st.lists(pillars, max_size=8), st.lists(blocks, max_size=3), pillars | blocks)
def test_one_more_obstacle_never_makes_the_way_shorter(cylinders, boxes, another):
    ends = {"start": (0.3, 0.3), "goal": (2.7, 2.7), "size": (SIDE, SIDE)}
    before = shortest_path(task(*cylinders, *boxes, **ends), BODY)
    after = shortest_path(task(*cylinders, *boxes, another, **ends), BODY)
    if after is not None:
        assert before is not None
        assert before.length <= after.length + 1e-7


# --- size, memory, manners


def scattered(count, side, seed=3):
    ends = {"start": (1.0, 1.0), "goal": (side - 1, side - 1), "size": (side, side)}
    return realise(task(**ends, random={"count": count}, seed=seed))


@pytest.mark.slow
def test_a_thousand_obstacles_are_not_too_many():
    for count, side in ((125, 10.0), (1000, 28.3)):
        scenario = scattered(count, side)
        assert length(scenario) > side


def test_neither_order_nor_doubles_nor_what_is_hidden_in_others_matters():
    plain = scattered(60, 8.0)
    hidden = [pillar(*item.position, 0.1) for item in plain.obstacles]
    mixed = plain.model_copy(
        update={"obstacles": plain.obstacles[::-1] + task(*hidden).obstacles + plain.obstacles}
    )
    assert length(mixed) == pytest.approx(length(plain), abs=EXACT)


def test_answers_are_remembered_by_geometry_alone():
    scenario = scattered(30, 6.0)
    again = scenario.model_copy(update={"seed": 9, "name": "other", "drive": "kinematic"})
    route = shortest_path(scenario)
    assert route is not None
    assert shortest_path(again) is route
    assert shortest_path(scenario, 0.1) is not route
    assert not route.points.flags.writeable


def test_what_is_not_drawn_yet_and_discs_without_size_are_refused():
    with pytest.raises(ValueError, match="realise"):
        shortest_path(task(random={"count": 3}))
    for radius in (0.0, -1.0, math.inf, math.nan, GRAZE):
        with pytest.raises(ValueError, match="radius"):
            feasible(task(), radius)


def test_spl_is_the_share_of_the_driven_path_that_was_needed():
    assert spl(True, 8.0, 10.0) == pytest.approx(0.8)
    assert spl(False, 8.0, 10.0) == 0.0
    assert spl(True, 8.0, 7.999999) == 1.0
    assert spl(True, 0.0, 0.0) == 1.0
    assert spl(False, 0.0, 0.0) == 0.0


def test_nothing_that_drives_or_plans_can_reach_it():
    code = (
        "import sys, fuzzyq_bullet.episode, fuzzyq_bullet.planning, fuzzyq_bullet.drives\n"
        "sys.exit(any(name.startswith('fuzzyq_bullet.ground_truth') for name in sys.modules))"
    )
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0
    root = Path(fuzzyq_bullet.__file__).parent
    for room in ("planning", "learning", "drives", "physics", "scenario", "episode.py"):
        files = [root / room] if room.endswith(".py") else (root / room).rglob("*.py")
        assert not [f for f in files if "ground_truth" in f.read_text(encoding="utf-8")]


def test_a_way_through_a_via_point_passes_close_to_a_concave_polygon() -> None:
    # The leg to a point of the via point's disc ends at a disc without a rim.
    hook = [[8, 3], [10, 3], [10, 3.2], [8.2, 3.2], [8.2, 4.5], [8, 4.5]]
    told = {
        "name": "hook",
        "arena": {"size": [16, 10]},
        "start": {"position": [1.5, 5]},
        "via": [{"position": [8, 5.2], "radius": 0.3}],
        "goal": {"position": [14.5, 5], "radius": 0.4},
        "obstacles": [
            {"shape": "cylinder", "position": [5, 5.2], "radius": 0.4},
            {"shape": "polygon", "points": hook},
        ],
    }
    scenario = Scenario.model_validate(told)
    way = shortest_path(scenario, 0.5988)
    assert way is not None
    assert 12.6 < way.length < 13.0
