"""The world: what stands in it is there, whatever its number, and every touch is noticed."""

import gc
import math
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.physics.engine import Engine
from fuzzyq_bullet.physics.sensor_world import SensorWorld
from fuzzyq_bullet.physics.world import World
from fuzzyq_bullet.robots import FUZZYQ
from fuzzyq_bullet.robots.jackal import JACKAL
from fuzzyq_bullet.scenario import MIN_RADIUS, Arena, Box, Cylinder
from fuzzyq_bullet.sensors import (
    SENSOR_MARGIN,
    SPREAD,
    WIDEST,
    CorridorSensor,
    ExactSensor,
    offsets,
)
from fuzzyq_bullet.shapes import thinnest
from fuzzyq_bullet.shapes.outlines import FINEST

FIELD = Arena(size=(6.0, 6.0))


@pytest.fixture(scope="module")
def engine():
    with Engine() as engine:
        yield engine


def cylinder(x, y, radius=0.2):
    return Cylinder(shape="cylinder", position=(x, y), radius=radius)


def box(x, y, length, width, yaw=0.0):
    return Box(shape="box", position=(x, y), size=(length, width), yaw=yaw)


def sensor_of(world, spacing=WIDEST):
    rng = np.random.default_rng(0)
    return CorridorSensor(ExactSensor(), world.cast, FUZZYQ, rng, spacing)


def run_into(world, x, y, heading, speed=0.3, steps=2000):
    world.robot.place(x, y, heading)
    world.robot.command(*FUZZYQ.wheel_commands(speed, 0.0))
    return world.advance(steps)


def test_every_one_of_many_obstacles_is_solid(engine):
    # An array of shapes silently keeps 16, and the robot drives through the rest.
    row = [cylinder(0.5 + 0.9 * (k % 10), 1.0 + 1.5 * (k // 10)) for k in range(40)]
    world = World(row, Arena(size=(10.0, 10.0)), engine=engine)
    field = Field.of(row, FIELD)
    for index in (0, 15, 16, 17, 25, 39):
        x, y = row[index].position
        taken, contact = run_into(world, x, y - 0.6, math.pi / 2)
        assert contact is not None
        assert taken < 1000
        assert int(field.distances(contact.point[:2]).argmin()) == index
        assert contact.force > 0.0


def test_obstacles_are_one_body_whatever_their_number(engine):
    for count in (1, 100, 1000):
        many = [cylinder(0.3 + 0.3 * (k % 32), 0.3 + 0.3 * (k // 32), 0.1) for k in range(count)]
        world = World(many, Arena(size=(12.0, 12.0)), engine=engine)
        bodies = engine.api.getNumBodies(physicsClientId=engine.client)
        # Ground, obstacles, walls, faces (a mesh holds about a thousand obstacles), robot.
        assert bodies <= 6
        assert world.walls is not None


def test_walls_stand_on_the_edges_and_only_where_they_are_wanted(engine):
    world = World([], FIELD, engine=engine)
    for heading in (0.0, math.pi / 2, math.pi, -math.pi / 2):
        _, contact = run_into(world, 3.0, 3.0, heading, speed=0.6, steps=4000)
        assert contact is not None
        assert contact.body == world.walls
        state = world.robot.state()
        gaps = [state.x, state.y, 6.0 - state.x, 6.0 - state.y]
        assert min(gaps) == pytest.approx(FUZZYQ.radius, abs=0.005)
    open_world = World([], Arena(size=(6.0, 6.0), walls=False), engine=engine)
    _, contact = run_into(open_world, 3.0, 3.0, 0.0, speed=0.6, steps=2400)
    assert contact is None
    assert open_world.robot.state().x > 8.0


def test_a_graze_of_a_few_steps_is_noticed(engine):
    # 2 mm of overlap beside a straight way: the touch lasts some hundredths of a second.
    world = World([cylinder(3.0, 3.0)], FIELD, engine=engine)
    _, contact = run_into(world, 2.0, 3.0 + 0.4 - 0.002, 0.0)
    assert contact is not None
    _, passed = run_into(world, 2.0, 3.0 + 0.4 + 0.003, 0.0)
    assert passed is None


@pytest.mark.parametrize(("overlap", "speed"), [(0.0002, 0.05), (0.0005, 0.05), (0.0005, 0.3)])
def test_the_lightest_graze_counts_where_it_begins(engine, overlap, speed):
    world = World([cylinder(3.0, 3.0)], FIELD, engine=engine)
    _, contact = run_into(world, 2.6, 3.0 + 0.4 - overlap, 0.0, speed=speed, steps=4000)
    assert contact is not None
    assert 0.0 < contact.force < 50.0  # less than the weight of the robot
    state = world.robot.state()
    assert math.hypot(state.x - 3.0, state.y - 3.0) == pytest.approx(0.4, abs=1e-4)


def test_wheels_and_ground_are_no_contact(engine):
    world = World([], FIELD, engine=engine)
    assert run_into(world, 2.0, 3.0, 0.0, steps=240) == (240, None)


size = st.floats(0.05, 1.5)
place = st.floats(0.0, 6.0)
obstacle = st.one_of(
    st.builds(cylinder, place, place, st.floats(0.025, 1.0)),
    st.builds(box, place, place, size, size, st.floats(-3.0, 3.0)),
)


@pytest.mark.slow
@settings(max_examples=150)
@given(
    obstacles=st.lists(obstacle, max_size=25),
    origin=st.tuples(st.floats(0.2, 5.8), st.floats(0.2, 5.8)),
    heading=st.floats(-3.2, 3.2),
)
def test_a_line_is_never_longer_than_the_way_to_contact(engine, obstacles, origin, heading):
    field = Field.of(obstacles, FIELD)
    if field.clearance([origin])[0] < FUZZYQ.radius + 0.001:  # it touches something already
        return
    world = World(obstacles, FIELD, engine=engine)
    headings = heading + np.linspace(0.0, 6.0, 12)
    sensed = np.array(sensor_of(world).sense(origin, headings))
    truth = field.free_distance(origin, headings, FUZZYQ.radius, FUZZYQ.sensor_range)
    assert (sensed <= truth + SENSOR_MARGIN).all()
    assert (sensed >= 0.0).all()
    assert (sensed <= FUZZYQ.sensor_range).all()


def test_lines_agree_with_exact_geometry_on_random_worlds(engine):
    rng = np.random.default_rng(7)
    errors = []
    for _ in range(25):
        obstacles = [
            cylinder(*rng.uniform(0, 6, 2), rng.choice([0.05, 0.1, 0.2, 0.4]))
            if rng.random() < 0.5
            else box(*rng.uniform(0, 6, 2), *rng.uniform(0.05, 1.0, 2), rng.uniform(-3, 3))
            for _ in range(40)
        ]
        field = Field.of(obstacles, FIELD)
        world = World(obstacles, FIELD, engine=engine)
        wide = FUZZYQ.radius + SENSOR_MARGIN
        for origin in rng.uniform(0.25, 5.75, (60, 2)):
            if field.clearance([origin])[0] < wide:
                continue
            headings = rng.uniform(-math.pi, math.pi, 9)
            truth = field.free_distance(origin, headings, wide, FUZZYQ.sensor_range)
            met = truth < FUZZYQ.sensor_range  # a free line is right of itself and proves nothing
            errors.append(np.abs(sensor_of(world).sense(tuple(origin), headings) - truth)[met])
    errors = np.concatenate(errors)
    assert errors.size > 1000
    assert np.median(errors) <= 0.01 * FUZZYQ.sensor_range


@pytest.mark.slow
def test_nothing_of_the_least_width_slips_between_two_rays(engine):
    least = 2 * MIN_RADIUS
    for shape in (lambda y: box(2.5, y, least, least), lambda y: cylinder(2.5, y, MIN_RADIUS)):
        for lateral in np.arange(-0.2, 0.2, 0.004):
            world = World([shape(3.0 + lateral)], FIELD, engine=engine)
            [ahead] = sensor_of(world, thinnest(world.obstacles)).sense((2.0, 3.0), [0.0])
            assert ahead < 0.5


@given(st.floats(0.07, 2.02), st.floats(0.0, 1.0))
def test_rays_are_as_near_to_each_other_as_is_asked_for(half, spacing):
    aside = half * offsets(half, spacing)
    both = np.concatenate([-aside[::-1], aside])
    assert np.diff(both).max() < min(max(spacing, FINEST), WIDEST) + 1e-9
    assert np.abs(aside[:, None] - half * SPREAD).min(axis=0).max() < 1e-9
    assert (offsets(FUZZYQ.radius + SENSOR_MARGIN) == SPREAD).all()  # the paper's robot


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("robot", [FUZZYQ, JACKAL])
def test_a_robot_of_any_size_is_stopped_by_what_would_graze_its_side(engine, robot, side):
    # What stands beside the robot takes the outermost ray; a flat graze ahead must be met without.
    beside = cylinder(3.0, 3.0 + side * (robot.radius + 0.01 + 0.1), 0.1)

    def ahead(clearance):
        aside = 3.0 + side * (robot.radius + clearance + 0.1)
        world = SensorWorld([beside, cylinder(4.0, aside, 0.1)], FIELD, engine=engine)
        sensor = CorridorSensor(ExactSensor(), world.cast, robot, np.random.default_rng(0))
        [free] = sensor.sense((3.0, 3.0), [0.0])
        return free

    assert ahead(-0.0005) < 1.0
    assert ahead(0.001) > 0.99 * robot.sensor_range


@pytest.mark.parametrize("length", [0.6, 4.0])
@pytest.mark.parametrize("side", [-1, 1])
def test_what_stands_beside_the_robot_does_not_stop_it(engine, side, length):
    # 1 cm beside its way, inside the margin of the line: it may go on, the geometry says so.
    world = World([box(3.0, 3.0 + side * 0.5, length, 1.0)], FIELD, engine=engine)
    [along] = sensor_of(world).sense((3.0, 3.0 - side * (FUZZYQ.radius + 0.01)), [0.0])
    assert along == FUZZYQ.sensor_range


def test_a_ray_meets_a_face_up_to_its_very_ends(engine):
    # A face is one triangle, as wide as the face at the height of the rays alone.
    corners = [(2.5, 2.5), (3.5, 2.5), (3.5, 3.5), (2.5, 3.5)]
    world = World([box(3.0, 3.0, 1.0, 1.0)], FIELD, engine=engine)
    for x, y in corners:
        for aside in (1e-6, 1e-3, 0.5, 1.0 - 1e-3, 1.0 - 1e-6):
            along = 2.5 + aside
            start = (along, y + math.copysign(0.5, y - 3.0))
            [down] = sensor_of(world).look(start, [math.copysign(math.pi / 2, 3.0 - y)])
            assert down == pytest.approx(0.5, abs=1e-6)
            start = (x + math.copysign(0.5, x - 3.0), along)
            [across] = sensor_of(world).look(start, [math.pi if x > 3.0 else 0.0])
            assert across == pytest.approx(0.5, abs=1e-6)


@pytest.mark.slow
def test_ten_thousand_obstacles_are_all_sensed(engine):
    grid = [cylinder(1.0 + 1.2 * (k % 100), 1.0 + 1.2 * (k // 100)) for k in range(10_000)]
    world = World(grid, Arena(size=(121.0, 121.0)), engine=engine)
    for index in (0, 99, 4321, 9999):
        x, y = grid[index].position
        [ahead] = sensor_of(world).sense((x - 0.9, y), [0.0])
        assert ahead == pytest.approx(0.9 - 0.2 - FUZZYQ.radius - SENSOR_MARGIN, abs=0.01)


def test_an_engine_is_closed_once_and_for_all():
    engine = Engine()
    engine.close()
    engine.close()
    with World([], Arena()) as world:
        client = world.engine.client
        assert world.engine.api.isConnected(client)
    assert not world.engine.api.isConnected(client)


def test_worlds_that_are_closed_leave_no_memory_behind():
    # PyBullet keeps the lists of a mesh: with 1600 corners 3200 blocks a world.
    many = [cylinder(0.6 + 0.5 * (k % 10), 0.6 + 0.5 * (k // 10), 0.1) for k in range(50)]

    def blocks_after(worlds):
        for _ in range(worlds):
            SensorWorld(many, FIELD).close()
        gc.collect()
        return sys.getallocatedblocks()

    before = blocks_after(3)
    assert (blocks_after(10) - before) / 10 < 100
