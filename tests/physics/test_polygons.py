"""Polygons in the physics: contact, rays and a way out agree with the plane geometry."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fuzzyq_bullet import run
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.ground_truth import feasible, shortest_path
from fuzzyq_bullet.physics.engine import Engine
from fuzzyq_bullet.physics.world import World
from fuzzyq_bullet.robots import FUZZYQ
from fuzzyq_bullet.scenario import Arena, load_scenario, parse_scenario, realise
from fuzzyq_bullet.shapes import Box, Polygon

FIELD = Arena(size=(12.0, 12.0), origin=(-6.0, -6.0))


def polygon(points):
    return Polygon(shape="polygon", points=[(float(x), float(y)) for x, y in points])


COMB = polygon(
    [
        (0, 0),
        (3, 0),
        (3, 2),
        (2.5, 2),
        (2.5, 0.5),
        (1.8, 0.5),
        (1.5, 1.9),
        (1.2, 0.5),
        (0.5, 0.5),
        (0.5, 2),
        (0, 2),
    ]
)


@pytest.fixture(scope="module")
def engine():
    with Engine() as engine:
        yield engine


@pytest.mark.slow
def test_the_body_touches_where_geometry_says_to_a_millimetre(engine):
    world, field = World([COMB], FIELD, engine=engine), Field.of([COMB])
    rng = np.random.default_rng(5)
    gaps = []
    starts = [(1.5, 3.0), (0.85, 1.2), (2.15, 1.2), (2.15, 3.2), (-0.8, 1.0)]
    for start in starts:
        for heading in rng.uniform(-math.pi, math.pi, 12):
            [free] = field.free_distance(start, [heading], FUZZYQ.radius, 1.0)
            if free >= 1.0:
                continue
            world.robot.place(*start, heading)
            world.robot.command(*FUZZYQ.wheel_commands(0.05, 0.0))
            _, contact = world.advance(20_000)
            assert contact is not None
            state = world.robot.state(0.0)
            gaps.append(field.distances((state.x, state.y))[0] - FUZZYQ.radius)
            assert abs(field.distances(contact.point[:2])[0]) < 0.001
    assert len(gaps) > 25
    assert np.abs(gaps).max() < 0.001


def test_rays_meet_outer_faces_only_and_where_they_are(engine):
    world, field = World([COMB], FIELD, engine=engine), Field.of([COMB], FIELD)
    angle = np.linspace(0.0, math.tau, 100, endpoint=False)
    z = FUZZYQ.sensor_height
    for x, y in ((1.5, 3.0), (0.85, 1.2), (2.15, 1.2)):
        ends = [(x + 5 * math.cos(a), y + 5 * math.sin(a), z) for a in angle]
        told = np.array(world.cast([(x, y, z)] * len(ends), ends)) * 5.0
        want = field.free_distance((x, y), angle, 0.0, 5.0)
        np.testing.assert_allclose(told, want, atol=1e-5)


U_TRAP = """\
name: u
seed: 1
arena: {size: [10.0, 8.0], origin: [-4.0, -4.0]}
start: {position: [-3.0, 0.3]}
goal: {position: [5.0, 0.0]}
obstacles:
  - shape: polygon
    points: [[0.0, -1.5], [2.2, -1.5], [2.2, 1.5], [0.0, 1.5], [0.0, 1.3], [2.0, 1.3], [2.0, -1.3],
             [0.0, -1.3]]
"""


def test_the_robot_gets_out_of_a_concave_polygon():
    scenario = parse_scenario(U_TRAP)
    inside = scenario.model_copy(
        update={"start": scenario.start.model_copy(update={"position": (1.5, 0.3)})}
    )
    for one in (scenario, inside):
        went = run(one)
        assert went.outcome == "goal"
        assert went.ticks.clearance.min() > 0.0
        assert feasible(one)


def test_the_shortest_path_round_a_polygon_is_that_round_the_boxes_it_is_made_of():
    scenario = parse_scenario(U_TRAP)
    boxes = [((1.1, 1.4), (2.2, 0.2)), ((1.1, -1.4), (2.2, 0.2)), ((2.1, 0.0), (0.2, 3.0))]
    alike = scenario.model_copy(
        update={"obstacles": tuple(Box(shape="box", position=p, size=s) for p, s in boxes)}
    )
    one, other = shortest_path(scenario), shortest_path(alike)
    assert one.length == pytest.approx(other.length, abs=1e-8)
    closed = polygon([(-5, -3.7), (7, -3.7), (7, 1), (6.5, 1), (6.5, 3.9), (-5, 3.9)])
    ring = scenario.model_copy(update={"obstacles": (closed,)})
    assert not feasible(ring)


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
@pytest.mark.parametrize("name", ["u-shape", "paper-50"])
def test_a_moved_scenario_drives_the_same_path(name, drive):
    scenario = realise(load_scenario(name)).model_copy(update={"drive": drive})
    x, y = -37.3, 12.9
    here, there = run(scenario), run(scenario.moved(x, y))
    assert there.outcome == here.outcome
    assert len(there.ticks.time) == len(here.ticks.time)
    np.testing.assert_allclose(there.ticks.position - (x, y), here.ticks.position, atol=1e-6)
    np.testing.assert_allclose(there.ticks.clearance, here.ticks.clearance, atol=1e-6)


def test_drawn_obstacles_move_with_the_arena():
    scenario = load_scenario("paper-50")
    assert scenario.random is not None
    there = realise(scenario.moved(-37.3, 12.9))
    want = realise(scenario).moved(-37.3, 12.9)
    assert there == want
