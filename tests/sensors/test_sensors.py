"""The range sensor: nothing is sensed twice, what was told can be stored, and models may differ."""

from __future__ import annotations

import math
import pickle
from dataclasses import replace
from typing import Literal

import numpy as np
import pytest

from fuzzyq_bullet.episode import Episode, run
from fuzzyq_bullet.errors import SensorError
from fuzzyq_bullet.physics.sensor_world import SensorWorld
from fuzzyq_bullet.planning import ImprovedFuzzyPlanner, ImprovedFuzzySettings, RangeSensor
from fuzzyq_bullet.robots import FUZZYQ
from fuzzyq_bullet.scenario import (
    Arena,
    Cylinder,
    load_scenario,
    parse_scenario,
    realise,
)
from fuzzyq_bullet.sensors import (
    SENSOR_MARGIN,
    SENSORS,
    SPREAD,
    CorridorSensor,
    ExactSensor,
    SensorModel,
    register_sensor,
)
from fuzzyq_bullet.sensors.noise import RayNoise

HEADINGS = [0.0, 1.0, 2.0, 0.0]


@pytest.fixture(scope="module")
def world():
    post = Cylinder(shape="cylinder", position=(3.0, 2.0), radius=0.3)
    with SensorWorld([post], Arena(size=(6.0, 4.0))) as world:
        yield world


def sensor_of(world, model=None):
    return CorridorSensor(model or ExactSensor(), world.cast, FUZZYQ, np.random.default_rng(0))


def test_a_line_is_cast_once_and_told_as_often_as_asked(world):
    exact, cast = sensor_of(world), []

    def sense(headings):
        cast.extend(headings)
        return exact.sense((2.0, 2.0), headings)

    sensor = RangeSensor(sense, sense)
    assert sensor.sense(HEADINGS) == exact.sense((2.0, 2.0), HEADINGS)
    assert sensor.sense([2.0, 0.5, 0.0]) == exact.sense((2.0, 2.0), [2.0, 0.5, 0.0])
    assert sensor.sense([]) == []
    assert sorted(cast) == [0.0, 0.5, 1.0, 2.0]


def test_what_was_told_cannot_be_changed_by_who_was_told(world):
    sensor = sensor_of(world).at((2.0, 2.0))
    first = sensor.look(HEADINGS)
    before = first.copy()
    first[:] = 0.0
    assert (sensor.look(HEADINGS) == before).all()
    assert sensor.look([]).size == 0


@pytest.mark.parametrize("wrong", [[math.nan], ["ahead"], [0.0] * 1001])
def test_what_is_no_heading_is_refused(world, wrong):
    sensor = sensor_of(world).at((2.0, 2.0))
    for ask in (sensor.sense, sensor.look):
        with pytest.raises(ValueError, match="heading"):
            ask(wrong)


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_an_observation_is_stored_and_decided_upon_again(drive):
    from fuzzyq_bullet.physics.world import World

    task = realise(load_scenario("semicircle").model_copy(update={"drive": drive}))
    settings = ImprovedFuzzySettings(weights=(1.0, 1.0))
    stored, decisions = [], []
    with World(task.obstacles, task.arena) as world:
        episode, planner = Episode(world, task), ImprovedFuzzyPlanner(settings)
        while episode.outcome is None and len(stored) < 300:
            seen = episode.observe()
            decisions.append(planner.decide(seen))
            stored.append(pickle.dumps(seen))
            assert pickle.loads(stored[-1]) == seen
            episode.advance(decisions[-1])
    again = ImprovedFuzzyPlanner(settings)
    # As text: what is left blank is NaN, which is not equal to itself.
    assert [repr(again.decide(pickle.loads(one))) for one in stored] == list(map(repr, decisions))
    assert {"breakout"} & {one.mode for one in decisions}
    old = pickle.loads(stored[0])
    assert old != pickle.loads(stored[5])
    assert replace(old, sensor=RangeSensor(list, list)) == old
    with pytest.raises(LookupError, match="stored sensor"):
        old.sense([0.12345])


@pytest.mark.slow
def test_every_ray_passes_the_model_and_the_same_seed_measures_the_same():
    class Noisy(SensorModel):
        model: Literal["noisy"]

        def measure(self, lengths, rng):
            return np.maximum(lengths + rng.normal(0.0, 0.01, lengths.shape), 0.0)

    register_sensor(Noisy)
    assert "noisy" in SENSORS.names()
    with pytest.raises(ValueError, match="registered already"):
        register_sensor(Noisy)
    text = (
        "name: noise\nstart: {position: [2, 5]}\ngoal: {position: [5, 5]}\nseed: SEED\n"
        "obstacles: [{shape: cylinder, position: [3.4, 4.9], radius: 0.2}]\n"
        "planner: {name: improved-fuzzy, weights: [1.0, 1.0]}\nsensor: {model: MODEL}\n"
    )
    one, same, other, exact = (
        run(parse_scenario(text.replace("SEED", seed).replace("MODEL", model))).digest()
        for seed, model in (("1", "noisy"), ("1", "noisy"), ("2", "noisy"), ("1", "exact"))
    )
    assert one == same
    assert len({one, other, exact}) == 3


@pytest.mark.parametrize(
    ("measure", "message"),
    [
        (lambda lengths: lengths[1:], "must return 14 lengths of at least 0"),
        (lambda lengths: lengths - 9.0, "must return 14 lengths of at least 0"),
        (lambda lengths: lengths * math.nan, "must return 14 lengths of at least 0"),
        (lambda lengths: 1 / 0, "stopped by ZeroDivisionError: division by zero"),
    ],
)
def test_a_sensor_that_fails_is_told_in_one_line(world, measure, message):
    class Broken(SensorModel):
        def measure(self, lengths, rng):
            return measure(lengths)

    with pytest.raises(SensorError, match=f"^sensor broken: .*{message}"):
        sensor_of(world, Broken(model="broken")).sense((2.0, 2.0), [0.0])


def test_whatever_a_model_tells_a_line_stays_within_the_range(world):
    class Blind(SensorModel):
        told: float

        def measure(self, lengths, rng):
            return np.full_like(lengths, self.told)

    for told, expected in ((0.0, 0.0), (7.0, FUZZYQ.sensor_range), (math.inf, FUZZYQ.sensor_range)):
        sensor = sensor_of(world, Blind(model="blind", told=told)).at((2.0, 2.0))
        assert sensor.sense([0.0, 1.0]) == [expected] * 2
        assert sensor.look([0.0])[0] == min(told, FUZZYQ.sensor_range + 0.22)


def test_what_is_too_near_for_a_ray_is_told_by_the_rays_farther_aside():
    near, blind, model = 0.25, 0.3, ExactSensor(model="exact", blind=0.3)

    def wall(starts, ends):
        """A wall across whichever way a line goes."""
        return [
            min(1.0, near / max(math.dist(a, b), 1e-9)) for a, b in zip(starts, ends, strict=True)
        ]

    rng = np.random.default_rng(0)
    noise = RayNoise(model, rng, rng)
    sensor = CorridorSensor(model, wall, FUZZYQ, rng, noise=noise)
    wide = FUZZYQ.radius + SENSOR_MARGIN
    aside = wide * SPREAD
    seen = aside[np.hypot(near, aside) >= blind]
    assert 0 < len(seen) < len(aside)
    expected = near - np.sqrt(wide**2 - seen**2).max()
    assert sensor.sense((0.0, 0.0), [0.3, 2.0]) == pytest.approx([expected] * 2)
