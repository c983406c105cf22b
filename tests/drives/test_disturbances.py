"""Noise, errors of the pose, slip and latency: there only when asked for, the same for a seed."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from fuzzyq_bullet import Decision, Scenario, run
from fuzzyq_bullet.drives.disturbances import DRIFT, Localiser
from fuzzyq_bullet.episode import Episode, world_of
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.scenario import check, random_task, realise, with_options
from fuzzyq_bullet.sensors import ExactSensor

FIELD: dict[str, Any] = {
    "name": "disturbed",
    "seed": 4,
    "arena": {"size": (5.0, 3.0)},
    "start": {"position": (0.6, 1.5)},
    "goal": {"position": (4.4, 1.5)},
    "obstacles": [
        {"shape": "cylinder", "position": (2.0, 1.4), "radius": 0.2},
        {"shape": "box", "position": (3.2, 1.8), "size": (0.3, 0.6)},
    ],
}
ALL = {
    "sensor": {"noise": 0.01, "dropout": 0.01, "pose_noise": 0.01, "heading_noise": 0.0175},
    "robot": {"slip": 0.03, "latency": 0.1},
}
ONE_BY_ONE = [
    {"sensor": {"noise": 0.01}},
    {"sensor": {"quantisation": 0.02}},
    {"sensor": {"dropout": 0.05}},
    {"sensor": {"rate": 5.0}},
    {"sensor": {"pose_noise": 0.02}},
    {"sensor": {"heading_noise": 0.02}},
    {"robot": {"slip": 0.03}},
    {"robot": {"latency": 0.1}},
]


def field(**more: Any) -> Scenario:
    return Scenario.model_validate({**FIELD, **more})


def readings(scenario: Scenario, count: int = 400) -> np.ndarray[Any, Any]:
    """Return what single rays towards the cylinder tell at the start, again and again."""
    with world_of(scenario) as world:
        episode = Episode(world, scenario)
        told = []
        for k in range(count):
            [length] = episode.observe().look([1e-9 * k])
            told.append(length)
        return np.array(told)


def test_a_run_is_the_same_with_what_disturbs_nothing() -> None:
    plain = run(field())
    zeros = {"noise": 0.0, "dropout": 0.0, "quantisation": 0.0, "blind": 0.0, "pose_noise": 0.0}
    assert run(field(sensor=zeros, robot={"slip": 0.0, "latency": 0.0})).digest() == plain.digest()


@pytest.mark.parametrize("disturbed", [*ONE_BY_ONE, ALL], ids=str)
def test_each_disturbance_changes_the_run_and_is_that_of_its_seed(
    disturbed: dict[str, Any],
) -> None:
    short = {"time": 2.0}
    once, again, plain = (
        run(field(**one, limits=short)).digest() for one in (disturbed, disturbed, {})
    )
    assert once == again != plain


def test_noise_has_the_deviation_that_was_asked_for_and_no_bias() -> None:
    true = readings(field(), 1)[0]
    told = readings(field(sensor={"noise": 0.05, "range": 3.0}))
    assert told.std() == pytest.approx(0.05, rel=0.15)
    assert told.mean() == pytest.approx(readings(field(sensor={"range": 3.0}), 1)[0], abs=0.01)
    assert true <= 1.22  # it sees no farther without a range of its own


def test_lost_readings_are_as_many_as_were_asked_for() -> None:
    far = 3.0
    told = readings(field(sensor={"dropout": 0.2, "range": far}), 1000)
    assert (told >= far).mean() == pytest.approx(0.2, abs=0.05)


def test_steps_are_rounded_down_and_what_is_near_is_not_seen() -> None:
    true = readings(field(sensor={"range": 3.0}), 1)[0]
    [told] = readings(field(sensor={"range": 3.0, "quantisation": 0.25}), 1)
    assert told == pytest.approx(math.floor(true / 0.25) * 0.25)
    [blind] = readings(field(sensor={"range": 3.0, "blind": true + 0.01}), 1)
    assert blind > 3.0
    [seen] = readings(field(sensor={"range": 3.0, "blind": true - 0.01}), 1)
    assert seen == pytest.approx(true)


def test_a_sensor_with_a_rate_tells_the_reading_of_before() -> None:
    scenario = field(sensor={"rate": 2.0, "range": 3.0})
    with world_of(scenario) as world:
        episode = Episode(world, scenario)
        told, where = [], []
        while episode.now.time < 0.9:
            told.append(float(episode.observe().look([0.0])[0]))
            where.append(episode.now.x)
            episode.advance(Decision(heading=0.0, step=0.4))
    assert len({round(one, 6) for one in told}) == 2
    assert where[9] - where[0] > 0.05


def test_the_error_of_the_pose_drifts_and_is_as_large_as_was_asked_for() -> None:
    localiser = Localiser(0.01, 0.02, np.random.default_rng(1))
    errors = np.array([localiser.error(0.05 * k) for k in range(40_000)])
    assert errors.std(axis=0) == pytest.approx([0.01, 0.01, 0.02], rel=0.2)
    assert np.abs(np.diff(errors[:, 0])).max() < 0.01
    later = int(DRIFT / 0.05)
    kept = np.corrcoef(errors[:-later, 0], errors[later:, 0])[0, 1]
    assert kept == pytest.approx(math.exp(-1), abs=0.15)


def test_a_command_arrives_after_the_latency() -> None:
    first = []
    for latency in (0.0, 0.05, 0.12, 0.2):
        scenario = field(robot={"latency": latency}, limits={"time": 2.0})
        ticks = run(scenario).ticks
        first.append(float(ticks.time[np.argmax(ticks.speed > 0.01)]))
    waited = [one - first[0] for one in first]
    assert waited == pytest.approx([0.0, 0.05, 0.15, 0.2])  # 0.12 s are three ticks


@pytest.mark.parametrize(
    ("given", "place"),
    [
        ({"sensor": {"noise": 1.0}}, "sensor.noise"),
        ({"sensor": {"quantisation": 0.5, "range": 0.45}}, "sensor.quantisation"),
        ({"sensor": {"blind": 1.5}}, "sensor.blind"),
    ],
)
def test_noise_beyond_the_range_is_refused_in_one_line(given: dict[str, Any], place: str) -> None:
    with pytest.raises(UserError, match=f"{place}: must be less than the range") as error:
        check(field(**given))
    assert len(error.value.problems) == 1


def test_the_margin_grows_with_the_noise_in_both_drives() -> None:
    [wheels, point] = [
        Scenario.model_validate({**FIELD, "drive": drive, "sensor": {"noise": 0.03}})
        for drive in ("wheels", "kinematic")
    ]
    for scenario in (wheels, point):
        with world_of(scenario) as world:
            assert Episode(world, scenario).observe().uncertainty == pytest.approx(0.09)
    for seed in range(8):  # without the margin, 1, 3, 4 and 6 end in a contact
        task = realise(with_options(random_task(seed, count=60), drive="kinematic"))
        noisy = task.model_copy(update={"sensor": ExactSensor(noise=0.1)})
        assert run(noisy).collision is None, seed


@pytest.mark.slow
def test_nothing_is_touched_with_all_disturbances_at_once() -> None:
    for seed in range(6):
        task = realise(random_task(3000 + seed, count=50))
        assert run(Scenario.model_validate({**task.model_dump(), **ALL})).collision is None, seed


def test_the_point_robot_waits_for_a_reading_from_where_it_is() -> None:
    # It steps every 2/3 s: with a reading a second, each serves for two decisions.
    for seed in (
        1,
        4,
        10,
        11,
    ):  # else each ends in a contact at its second step
        task = with_options(random_task(seed, count=60), drive="kinematic")
        limits = task.limits.model_copy(update={"time": 8.0})
        slow = {"sensor": ExactSensor(rate=1.0), "limits": limits}
        record = run(realise(task).model_copy(update=slow))
        assert record.collision is None, seed
        moves = np.hypot(*np.diff(record.ticks.position, axis=0).T)
        assert moves[0] > 0.0
        assert (moves[1::2] == 0.0).all()
    quick = {"sensor": ExactSensor(rate=1.5), "limits": limits}
    plain = {"sensor": ExactSensor(), "limits": limits}
    fresh, usual = (run(realise(task).model_copy(update=one)).ticks for one in (quick, plain))
    assert np.array_equal(fresh.position, usual.position)
