"""Whole episodes of the peers: bundled scenarios, other robots, noise, via points, both drives."""

from __future__ import annotations

import importlib.util

import pytest

from fuzzyq_bullet import result_of
from fuzzyq_bullet.errors import UserError
from tests.planning.peers.helpers import drive, drive_bundled

NAVGROUND = pytest.param(
    "navground",
    marks=pytest.mark.skipif(
        importlib.util.find_spec("navground") is None, reason="navground is not installed"
    ),
)
DECIDING = ["vfh", "apf", "tangent-bug"]
OWN = ["dwa", *DECIDING]
ALL = [*OWN, NAVGROUND]
CYLINDERS = [
    {"shape": "cylinder", "position": [3.0, 5.1], "radius": 0.25},
    {"shape": "cylinder", "position": [5.0, 4.6], "radius": 0.25},
    {"shape": "box", "position": [7.0, 5.6], "size": [0.5, 0.5], "yaw": 0.4},
]


@pytest.mark.parametrize("planner", ALL)
def test_the_same_run_twice_is_the_same_to_the_last_bit(planner):
    first, second = (result_of(drive(planner, CYLINDERS)) for _ in range(2))
    assert first.outcome == "goal"
    assert first.digest == second.digest


@pytest.mark.slow
@pytest.mark.parametrize("planner", ALL)
@pytest.mark.parametrize("name", ["open-field", "sparse", "mixed"])
def test_it_reaches_the_goal_of_bundled_scenarios(planner, name):
    record = drive_bundled(name, planner)
    assert record.outcome == "goal"


@pytest.mark.slow
@pytest.mark.parametrize("planner", ALL)
def test_it_passes_via_points_in_their_order(planner):
    via = [{"position": [5.0, 7.5], "radius": 0.4}, {"position": [3.0, 2.5], "radius": 0.4}]
    record = drive(planner, CYLINDERS, via=via)
    assert record.outcome == "goal"
    assert record.via_passed[-1] == 2


@pytest.mark.slow
@pytest.mark.parametrize("planner", ALL)
@pytest.mark.parametrize("model", ["turtlebot3-burger", "jackal"])
def test_it_drives_other_robots(planner, model):
    record = drive(planner, CYLINDERS, robot={"model": model}, limits={"time": 200.0})
    assert record.outcome == "goal"


@pytest.mark.slow
@pytest.mark.parametrize("planner", ALL)
def test_it_touches_nothing_with_a_noisy_sensor(planner):
    noisy = {"noise": 0.02, "pose_noise": 0.02}
    assert drive(planner, CYLINDERS, sensor=noisy).outcome != "collision"


@pytest.mark.slow
@pytest.mark.parametrize("planner", ["dwa", "vfh", "tangent-bug"])  # apf has no braking of its own
def test_its_own_care_is_enough_in_a_simple_field(planner):
    record = drive({"name": planner, "guard": False}, CYLINDERS)
    assert record.outcome == "goal"


@pytest.mark.parametrize("planner", DECIDING)
def test_what_answers_with_decisions_drives_the_papers_point_robot(planner):
    record = drive(planner, CYLINDERS, drive="kinematic")
    assert record.outcome == "goal"


@pytest.mark.parametrize("planner", ["dwa", NAVGROUND])
def test_what_answers_with_twists_refuses_it_in_one_line(planner):
    with pytest.raises(UserError, match="needs wheels, not kinematic") as error:
        drive(planner, drive="kinematic")
    assert "\n" not in str(error.value)
