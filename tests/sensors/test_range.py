"""How far the robot sees: a key of every sensor, up to 10 m, that all who ask the sensor follow."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
import pytest

from fuzzyq_bullet import load_scenario, run
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.physics.sensor_world import SensorWorld
from fuzzyq_bullet.planning import RangeSensor
from fuzzyq_bullet.planning.base import Observation
from fuzzyq_bullet.planning.scan import scan_360
from fuzzyq_bullet.robots import FUZZYQ
from fuzzyq_bullet.scenario import Arena, Cylinder, check, parse_scenario
from fuzzyq_bullet.sensors import CorridorSensor, ExactSensor, SensorModel, register_sensor
from fuzzyq_bullet.video.timeline import sensor_range

TEXT = """name: far
start: {position: [1, 5]}
goal: {position: [9, 5]}
sensor: SENSOR
"""
HERE = (2.0, 10.0)


def scenario(sensor, more=""):
    task = parse_scenario(TEXT.replace("SENSOR", sensor) + more)
    check(task)
    return task


@pytest.mark.parametrize("far", [0.5, 1.0, 3.0, 10.0])
def test_lines_rays_and_scans_reach_so_far_and_no_farther(far):
    posts = [
        Cylinder(shape="cylinder", position=(2.0 + 0.5 * k, 10.0 + (0.6 * k) ** 2), radius=0.1)
        for k in range(1, 8)
    ]
    with SensorWorld(posts, Arena(size=(20.0, 20.0))) as world:
        model = ExactSensor(range=far)
        sensor = CorridorSensor(model, world.cast, FUZZYQ, np.random.default_rng(0))
        headings = np.linspace(0.0, math.tau, 1000).tolist()
        lines, rays = np.array(sensor.sense(HERE, headings)), sensor.look(HERE, headings)
        truth = world.field.free_distance(HERE, headings, FUZZYQ.radius, far)
        seen = Observation(
            0.0,
            HERE,
            0.0,
            0.0,
            0.0,
            (9.0, 9.0),
            0.2,
            sensor.range,
            sensor.radius,
            RangeSensor(lambda some: sensor.sense(HERE, some), lambda s: sensor.look(HERE, s)),
        )
        scan = scan_360(seen)
    assert sensor.range == far
    assert lines.max() <= far
    assert rays.max() <= far + sensor.radius
    # No line is dropped from the greatest batch, and none passes a post.
    assert (lines <= truth + 0.02).all()
    assert scan.range == far
    assert max(scan.lengths) <= far
    beyond = [np.hypot(*(np.array(one.position) - HERE)) - one.radius for one in posts]
    met = np.hypot(*(scan.hits - HERE).T)
    for distance in beyond:
        assert (abs(met - distance) < 0.05).any() == (distance < far + sensor.radius)


def test_a_sensor_of_ones_own_has_a_range_without_doing_anything_for_it():
    class Plain(SensorModel):
        model: Literal["plain-with-range"]

        def measure(self, lengths, rng):
            return lengths

    register_sensor(Plain)
    task = scenario("{model: plain-with-range, range: 2.5}")
    assert task.sensor_range == 2.5
    assert scenario("{model: plain-with-range}").sensor_range == FUZZYQ.sensor_range


@pytest.mark.parametrize(
    ("range_", "what"),
    [
        ("10.1", "10"),
        ("0", "0"),
        ("-1", "0"),
        ("far", "number"),
        (".nan", "finite"),
        ("0.3", "0.4"),
    ],
)
def test_a_range_that_cannot_be_is_one_line_with_its_place(range_, what, tmp_path):
    file = tmp_path / "far.yaml"
    file.write_text(TEXT.replace("SENSOR", f"{{range: {range_}}}"))
    with pytest.raises(UserError) as caught:
        load_scenario(file)
    [line] = str(caught.value).splitlines()
    assert f"{file}:4" in line
    assert "sensor.range" in line
    assert what in line


def test_a_record_keeps_its_range_and_draws_lines_as_long(tmp_path):
    task = scenario("{range: 3.0}", "limits: {steps: 3}\n")
    record = run(task)
    assert sensor_range(record) == 3.0
    assert record.decisions.lengths.max() == 3.0
    record.save(tmp_path / "far.npz")
    assert type(record).load(tmp_path / "far.npz").scenario.sensor_range == 3.0


def test_the_usual_range_said_changes_nothing():
    usual, said = run(scenario("{model: exact}")), run(scenario("{range: 1.0}"))
    assert usual.digest() == said.digest()
