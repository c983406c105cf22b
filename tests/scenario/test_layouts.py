"""Claims about drawn layouts: they keep their promises for any seed, or say that they cannot."""

from __future__ import annotations

import math

import jsonschema
import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import label

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.ground_truth import feasible, shortest_path
from fuzzyq_bullet.robots import FUZZYQ
from fuzzyq_bullet.scenario import (
    Box,
    Cylinder,
    Scenario,
    check,
    dump_scenario,
    find_conflicts,
    parse_scenario,
    random_task,
    realise,
    scenario_schema,
)
from fuzzyq_bullet.scenario.layouts.maze import carve, runs
from fuzzyq_bullet.scenario.layouts.rectangles import overlap

TRAPS = ["semicircle", "arc", "u-shape", "long-wall"]
ALL = [*TRAPS, "rectangles", "maze", "cellular", "scatter"]
COUNTED = {"rectangles": {"count": 25}, "scatter": {"count": 25}}
seeds = st.integers(0, 2**63 - 1)


def asked(layout, start=(1.0, 5.0), goal=(9.0, 5.0), obstacles=(), arena=None, **given):
    return Scenario.model_validate(
        {
            "name": "drawn",
            "arena": arena or {},
            "start": {"position": start},
            "goal": {"position": goal},
            "obstacles": obstacles,
            "random": {"layout": layout, **COUNTED.get(layout, {}), **given},
        }
    )


def corners_of(item: Box) -> np.ndarray:
    c, s = math.cos(item.yaw), math.sin(item.yaw)
    signs = np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)])
    return (signs * item.size / 2) @ np.array([[c, s], [-s, c]]) + item.position


def extent_of(item) -> tuple[np.ndarray, np.ndarray]:
    if isinstance(item, Cylinder):
        at = np.array(item.position)
        return at - item.radius, at + item.radius
    at = corners_of(item)
    return at.min(axis=0), at.max(axis=0)


# --- what holds for all of them


@pytest.mark.slow
@pytest.mark.parametrize("layout", ALL)
@settings(max_examples=5)
@given(seeds, st.booleans(), st.sampled_from([(9.0, 5.0), (9.0, 9.2), (5.0, 9.0), (1.2, 0.6)]))
def test_all_is_clear_of_start_and_goal_and_can_be_run(layout, seed, walls, goal):
    start = (1.0, 5.0) if goal[0] > 2 else (8.8, 9.0)
    margin = 0.15
    scenario = asked(layout, start, goal, arena={"walls": walls}, margin=margin)
    check(scenario)
    drawn = realise(scenario, seed)
    assert drawn.random is None
    assert drawn.seed == seed
    assert drawn.obstacles
    assert find_conflicts(drawn) == []
    field = Field.of(drawn.obstacles)
    for place in (start, goal):
        assert field.nearest(place)[1] >= FUZZYQ.radius + margin
    if layout not in ("rectangles", "scatter"):
        assert feasible(drawn)
    assert parse_scenario(dump_scenario(drawn)) == drawn


@pytest.mark.parametrize("layout", [*TRAPS, "rectangles", "scatter"])
def test_every_obstacle_is_wholly_within_the_arena(layout):
    for seed in range(8):
        for item in realise(asked(layout, turned=True) if layout == "rectangles" else
                            asked(layout), seed).obstacles:  # fmt: skip
            low, high = extent_of(item)
            assert low.min() >= -2e-4
            assert high.max() <= 10.0 + 2e-4


@pytest.mark.parametrize("layout", ALL)
def test_the_same_seed_gives_the_same_and_another_seed_something_else(layout):
    scenario = asked(layout)
    assert realise(scenario, 3) == realise(scenario, 3)
    assert len({realise(scenario, seed).obstacles for seed in range(3)}) == 3


@pytest.mark.parametrize("layout", ALL)
def test_listed_obstacles_come_first_and_stay(layout):
    listed = ({"shape": "cylinder", "position": [5.0, 9.5], "radius": 0.1},)
    scenario = asked(layout, obstacles=listed)
    drawn = realise(scenario)
    assert drawn.obstacles[0] == scenario.obstacles[0]
    assert len(drawn.obstacles) > 1
    for item in drawn.obstacles:
        assert all(round(v, 4) == v for v in item.position)


@pytest.mark.parametrize("layout", ALL)
def test_a_layout_comes_back_from_a_file_as_it_was_and_fits_the_schema(layout):
    scenario = asked(layout)
    text = dump_scenario(scenario)
    assert parse_scenario(text) == scenario
    jsonschema.Draft202012Validator(scenario_schema()).validate(yaml.safe_load(text))


# --- traps


def middle_and_opening(drawn):
    """Centre and opening direction of a semicircle, from its first, last and middle cylinder."""
    at = np.array([item.position for item in drawn.obstacles])
    middle = (at[0] + at[-1]) / 2
    back = at[len(at) // 2] - middle
    return middle, math.atan2(-back[1], -back[0]), float(np.hypot(*back))


@pytest.mark.slow
@pytest.mark.parametrize("layout", TRAPS)
def test_a_trap_stands_in_the_way_between_start_and_goal(layout):
    lengths = []
    for seed in range(12):
        drawn = realise(asked(layout), seed)
        route = shortest_path(drawn)
        assert route is not None
        [free] = Field.of(drawn.obstacles).free_distance((1.0, 5.0), 0.0, FUZZYQ.radius, 8.0)
        assert free < 8.0
        lengths.append(route.length)
    assert min(lengths) > 8.0 - 0.2
    assert max(lengths) > 8.4


@settings(max_examples=8)
@given(seeds)
def test_a_semicircle_opens_towards_the_start_and_has_no_holes(seed):
    drawn = realise(asked("semicircle"), seed)
    middle, opening, radius = middle_and_opening(drawn)
    to_start = math.atan2(5.0 - middle[1], 1.0 - middle[0])
    assert abs(math.remainder(opening - to_start, math.tau)) <= 0.6 + 0.1
    at = np.array([item.position for item in drawn.obstacles])
    assert np.hypot(*np.diff(at, axis=0).T).max() <= 0.2 + 1e-3
    assert np.hypot(*(at - middle).T) == pytest.approx(radius, rel=0.01)
    headings = opening + np.linspace(math.pi / 2 + 0.01, 3 * math.pi / 2 - 0.01, 200)
    free = Field.of(drawn.obstacles).free_distance(middle, headings, 1e-6, 20.0)
    assert free.max() < radius


def test_sizes_and_places_that_are_given_are_kept():
    drawn = realise(
        asked("semicircle", position=[5.0, 4.0], direction=0.5, radius=1.5, thickness=0.2), 4
    )
    middle, opening, radius = middle_and_opening(drawn)
    assert middle == pytest.approx([5.0, 4.0], abs=1e-3)
    assert opening == pytest.approx(0.5, abs=0.04)
    assert radius == pytest.approx(1.5, abs=0.01)
    assert {item.radius for item in drawn.obstacles} == {0.1}
    [wall] = realise(asked("long-wall", position=[5, 5], direction=0.0, length=6.0)).obstacles
    assert wall.position == (5.0, 5.0)
    assert wall.size == (0.2, 6.0)
    u = realise(asked("u-shape", position=[5, 5], direction=math.pi, width=3.0, depth=2.0))
    lows, highs = zip(*(extent_of(item) for item in u.obstacles), strict=True)
    assert np.min(lows, axis=0) == pytest.approx([4.0, 3.5], abs=1e-3)
    assert np.max(highs, axis=0) == pytest.approx([6.0, 6.5], abs=1e-3)
    assert Field.of(u.obstacles).nearest((4.0, 5.0))[1] > 1.0  # open to the left
    angle = realise(asked("arc", position=[5, 5], radius=2.0, angle=1.0, direction=0.0)).obstacles
    first, last = np.array(angle[0].position), np.array(angle[-1].position)
    assert np.hypot(*(last - first)) == pytest.approx(4.0 * math.sin(0.5), abs=1e-3)


def test_the_start_may_be_inside_the_trap():
    inside = {"start": (2.0, 5.0), "position": [2.2, 5.0], "radius": 1.5}
    drawn = realise(asked("semicircle", direction=0.0, **inside))
    assert shortest_path(drawn).length == pytest.approx(6.8)
    drawn = realise(asked("u-shape", start=(5.0, 5.0), position=[5, 5], direction=math.pi,
                          width=2.0, depth=2.0))  # fmt: skip
    assert shortest_path(drawn).length > 6.0


@pytest.mark.parametrize(
    ("layout", "given"),
    [
        ("semicircle", {"radius": 6.0}),
        ("semicircle", {"position": [1.0, 5.0], "radius": 0.3}),  # on the start
        ("long-wall", {"position": [5.0, 5.0], "direction": 0.0, "length": 9.9}),  # no way round
        ("long-wall", {"length": 30.0}),
        ("u-shape", {"margin": 8.0}),
        (
            "arc",
            {"position": [1.0, 5.0], "radius": 0.8, "angle": 5.5, "direction": 0.0, "margin": 0.0},
        ),  # shut in
        ("semicircle", {"radius": 450.0, "thickness": 0.05}),  # more than a scenario may have
    ],
)
def test_a_trap_that_cannot_be_is_refused(layout, given):
    with pytest.raises(
        UserError, match=rf"drawn: random.layout: cannot place {layout} within 10 × 10 m"
    ):
        realise(asked(layout, **given))


def test_a_trap_stays_where_listed_obstacles_leave_a_way():
    # A barrier with a door above the middle: a wall across the door would shut it.
    barrier = [
        {"shape": "box", "position": [5.0, 2.5], "size": [0.2, 5.0]},
        {"shape": "box", "position": [5.0, 8.5], "size": [0.2, 3.0]},
    ]
    for seed in range(3):
        assert feasible(realise(asked("long-wall", obstacles=barrier, length=3.0), seed))
    shut = asked("long-wall", obstacles=barrier, position=[5.0, 6.0], direction=0.0, length=1.5)
    with pytest.raises(UserError, match="way round"):
        realise(shut)


# --- rectangles


def test_rectangles_are_as_many_and_as_large_as_asked_for():
    few = realise(asked("rectangles", shortest=0.3, longest=0.6)).obstacles
    assert len(few) == 25
    sizes = np.array([item.size for item in few])
    assert sizes.min() >= 0.3
    assert sizes.max() <= 0.6
    assert {item.yaw for item in few} == {0.0}
    turned = realise(asked("rectangles", turned=True)).obstacles
    assert len({item.yaw for item in turned}) == 25
    assert realise(asked("rectangles", count=0)).obstacles == ()
    many = realise(asked("rectangles", count=40)).obstacles
    assert many[:25] == realise(asked("rectangles")).obstacles


@pytest.mark.parametrize("turned", [False, True])
def test_rectangles_overlap_only_where_they_may(turned):
    listed = (
        {"shape": "cylinder", "position": [5.0, 5.0], "radius": 1.5},
        {"shape": "box", "position": [5.0, 8.5], "size": [3.0, 0.5], "yaw": 0.3},
    )
    drawn = realise(asked("rectangles", obstacles=listed, count=40, overlap=False, turned=turned))
    points = np.random.default_rng(0).uniform(0, 10, (4000, 2))
    inside = np.array([Field.of([item]).clearance(points) < 0.0 for item in drawn.obstacles])
    assert inside.sum(axis=0).max() == 1
    crowd = realise(asked("rectangles", count=40, turned=turned))
    inside = np.array([Field.of([item]).clearance(points) < 0.0 for item in crowd.obstacles])
    assert inside.sum(axis=0).max() > 1


@settings(max_examples=100)
@given(*[st.tuples(*[st.floats(-1, 1)] * 2, *[st.floats(0.2, 2)] * 2, st.floats(-4, 4))] * 2)
def test_two_boxes_overlap_where_they_share_points(one, other):
    a, b = (Box(shape="box", position=v[:2], size=v[2:4], yaw=v[4]) for v in (one, other))
    grid = np.stack(np.meshgrid(*[np.linspace(-0.5, 0.5, 60)] * 2), axis=-1).reshape(-1, 2)
    c, s = math.cos(a.yaw), math.sin(a.yaw)
    points = (grid * a.size) @ np.array([[c, s], [-s, c]]) + a.position
    depth = -Field.of([b]).clearance(points).min()
    if depth > 1e-6:
        assert overlap(a, b)
    elif depth < -0.05:  # farther off than the points are from one another
        assert not overlap(a, b)


# --- cells


def test_a_cellular_automaton_leaves_few_pillars_alone():
    def alone(smoothing, fill):
        field = realise(asked("cellular", smoothing=smoothing, fill=fill), 3)
        places = np.array([item.position for item in field.obstacles])
        assert (np.abs((places / 0.15 - 0.5).round() - (places / 0.15 - 0.5)) < 0.01).all()
        apart = np.abs(places[:, None] - places).max(axis=2)
        return np.mean((apart < 0.16).sum(axis=1) == 1)

    assert alone(0, fill=0.05) > 0.5
    assert alone(4, fill=0.2) < 0.02


# --- mazes


@settings(max_examples=40)
@given(st.tuples(st.integers(1, 12), st.integers(1, 12)), seeds)
def test_every_cell_of_a_maze_is_reached_by_exactly_one_way(cells, seed):
    upright, level = carve(cells, np.random.default_rng(seed))
    doors = (~upright).sum() + (~level).sum()
    assert doors == cells[0] * cells[1] - 1  # a tree, if all hangs together
    picture = np.zeros((2 * cells[0] - 1, 2 * cells[1] - 1), dtype=bool)
    picture[::2, ::2] = True
    picture[1::2, ::2] = ~upright
    picture[::2, 1::2] = ~level
    assert label(picture)[1] == 1


def test_walls_in_line_are_one():
    assert runs(np.array([True, True, False, True])) == [(0, 2), (3, 4)]
    assert runs(np.zeros(3, dtype=bool)) == []


def test_the_corridors_of_a_maze_are_as_wide_as_asked_for():
    for seed in range(2):
        narrow = realise(asked("maze", corridor=0.7, loops=0.0, margin=0.0), seed)
        assert feasible(narrow, 0.35 - 1e-3)
        tight = realise(asked("maze", corridor=0.5), seed)
        assert feasible(tight)
        assert len(tight.obstacles) > len(narrow.obstacles)


def test_loops_make_a_maze_shorter_until_nothing_is_left():
    mazes = [
        [realise(asked("maze", loops=loops), seed) for seed in range(4)]
        for loops in (0.0, 0.5, 1.0)
    ]
    lengths = [[shortest_path(maze).length for maze in same] for same in mazes]
    assert sum(lengths[0]) > sum(lengths[1]) > sum(lengths[2]) == pytest.approx(4 * 7.8)
    pieces = [[max(item.size) for maze in same for item in maze.obstacles] for same in mazes]
    assert sum(pieces[0]) > 1.5 * sum(pieces[1]) > 0.0 == sum(pieces[2])
    assert realise(asked("maze", loops=1.0)).obstacles == ()


@pytest.mark.slow
def test_a_maze_among_listed_obstacles_leaves_a_way_or_says_so():
    pillar = {"shape": "cylinder", "position": [5.0, 5.0], "radius": 0.8}
    assert all(feasible(realise(asked("maze", obstacles=[pillar]), seed)) for seed in range(2))
    barrier = {"shape": "box", "position": [2.5, 2.5], "size": [0.2, 5.0]}
    small = {"start": (1.0, 2.5), "goal": (4.0, 2.5), "arena": {"size": [5.0, 5.0]}}
    with pytest.raises(UserError, match="no way through a maze"):
        realise(asked("maze", obstacles=[barrier], **small))


# --- what is wrong with them, in words


HEAD = "name: x\nstart: {position: [1, 5]}\ngoal: {position: [9, 5]}\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{layout: semicirle}", "x:4: random.layout: no layout 'semicirle'; did you mean 'semi"),
        ("{layout: 3}", "x:4: random.layout: no layout '3'; allowed: scatter, semicircle, arc"),
        ("{layout: arc, angel: 2}", "x:4: random.angel: unknown key; did you mean 'angle'?"),
        ("{layout: arc, angle: 9.0}", "x:4: random.angle: must be at most 5.5, got 9.0"),
        ("{layout: rectangles}", "x:4: random.count: is required"),
        ("{layout: maze, corridor: 0.3}", "x:4: random.corridor: must be at least 0.5, got 0.3"),
        ("{layout: long-wall, position: [1]}", "x:4: random.position: needs 2 values"),
        ("{count: 3, coutn: 4}", "x:4: random.coutn: unknown key; did you mean 'count'?"),
        (
            "{count: 3, angle: 4}",
            "x:4: random.angle: unknown key; allowed: layout, movers, count, radius",
        ),
        ("{layout: scatter}", "x:4: random.count: is required"),
        ("{count: 3, scatter: 4}", "x:4: random.scatter: unknown key"),
        ("semicircle", "x:4: random: expected a mapping"),
        ("[1]", "x:4: random: expected a mapping"),
        (
            "{layout: rectangles, count: 3, shortest: 2.0}",
            "x:4: random.shortest: must be at most longest, 1, got 2",
        ),
        (
            "{layout: rectangles, count: 3, longest: 0.1}",
            "x:4: random.longest: must be at least sho",
        ),
        ("{layout: rectangles, count: 3, shortest: 20.0, longest: 30.0}", "random.shortest: must"),
    ],
)
def test_mistakes_are_named_with_line_key_and_what_is_allowed(text, message):
    with pytest.raises(UserError) as error:
        parse_scenario(f"{HEAD}random: {text}\n", "x")
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_too_fine_a_maze_is_refused_before_it_is_carved():
    scenario = asked("maze", arena={"size": [200.0, 200.0]}, corridor=0.6)
    assert [loc for loc, _ in find_conflicts(scenario)] == [("random", "corridor")]


def test_without_a_layout_it_is_scatter():
    plain = parse_scenario(f"{HEAD}random: {{count: 5}}\n")
    named = parse_scenario(f"{HEAD}random: {{layout: scatter, count: 5}}\n")
    assert plain == named
    validator = jsonschema.Draft202012Validator(scenario_schema())
    for text, fits in (
        ("{count: 5}", True),
        ("{layout: semicircle}", True),
        ("{layout: semicirle}", False),
        ("{layout: semicircle, count: 5}", False),
        ("{radius: 0.2}", False),
    ):
        assert validator.is_valid(yaml.safe_load(f"{HEAD}random: {text}\n")) is fits


# --- tasks for sweeps


def test_random_tasks_begin_and_end_at_any_two_corners():
    tasks = [random_task(seed) for seed in range(120)]
    assert tasks == [random_task(seed) for seed in range(120)]
    pairs = set()
    for task in tasks:
        ends = [np.array(p.position) for p in (task.start, task.goal)]
        for end in ends:
            assert np.abs(end - np.where(end > 5, 9.0, 1.0)).max() <= 0.3
        pairs.add(tuple(tuple(bool(v) for v in end > 5) for end in ends))
    assert len(pairs) == 12  # each of four corners to each of the others
    assert len({task.start.position for task in tasks}) == 120


def test_random_tasks_differ_in_their_obstacles_alone_where_only_those_are_asked_for():
    few, many = random_task(4, count=10), random_task(4, count=125)
    trap = random_task(4, count=None, layout="semicircle")
    for task in (few, many, trap):
        assert (task.start, task.goal) == (few.start, few.goal)
        check(task)
    assert len(realise(many).obstacles) == 125
    assert feasible(realise(trap))


@pytest.mark.parametrize("layout", ["semicircle", "arc", "u-shape", "long-wall", "maze"])
def test_random_tasks_with_traps_can_be_placed_for_every_seed(layout):
    for seed in range(6):
        task = random_task(seed, count=None, layout=layout)
        check(task)
        assert feasible(realise(task))
