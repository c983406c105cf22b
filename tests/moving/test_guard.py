"""Claims about the key ``guard`` among moving obstacles, and about ``closing_speed``."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyq_bullet import (
    CommandSettings,
    Decision,
    Scenario,
    TwistCommand,
    WheelCommand,
    run,
)
from fuzzyq_bullet.episode import Episode, run_with, world_of
from fuzzyq_bullet.planning import QLambdaSettings, settings_for
from fuzzyq_bullet.planning.base import RangeSensor
from fuzzyq_bullet.planning.traffic.guard import Guard
from fuzzyq_bullet.planning.traffic.tracker import Traffic
from fuzzyq_bullet.planning.traffic.twist_safety import rollout_twists, safe_twists
from fuzzyq_bullet.planning.twist_filter import twist_filter
from fuzzyq_bullet.recording.fault import at_fault
from fuzzyq_bullet.scenario import Limits, random_task, realise
from fuzzyq_bullet.scenario.layouts import Wanderers
from tests.helpers.commands import Call
from tests.moving.test_tracking import pillar, reading
from tests.planning.peers.helpers import MOTION

EXAMPLE = Path(__file__).parents[2] / "examples" / "closing_speed.py"
ACROSS = {"kind": "patrol", "points": [(3.0, 7.0), (3.0, 3.0)], "speed": 0.45}
STANDS = {"kind": "still"}


class Settings(CommandSettings):
    name: Literal["own"] = "own"


class Always:
    """Gives the same answer always."""

    def __init__(self, answer: Any) -> None:
        self.answer = answer

    def decide(self, _: object, /) -> Any:
        return self.answer


def crossing(motion=ACROSS, heading=0.0, planner=None, **keys):
    """A way of 7 m, in the middle of which somebody crosses."""
    told = {
        "name": "crossing",
        "start": {"position": (1.0, 5.0), "heading": heading},
        "goal": {"position": (8.0, 5.0)},
        "obstacles": [
            {"shape": "cylinder", "position": (3.0, 3.4), "radius": 0.25, "motion": motion}
        ],
        "limits": {"time": 6.0},
        **keys,
    }
    scenario = realise(Scenario.model_validate(told))
    return scenario.model_copy(update={"planner": planner or Settings(guard=True)})


@pytest.mark.parametrize(
    ("answer", "heading"),
    [
        (TwistCommand(0.6, 0.0), 0.0),
        (TwistCommand(-0.6, 0.0), math.pi),
        (WheelCommand(12.0, 12.0), 0.0),
        (Decision(0.0, 0.4), 0.0),
    ],
    ids=["twist", "backwards", "wheels", "heading"],
)
def test_who_drives_straight_on_is_at_fault_only_without_the_guard(answer, heading):
    alone = crossing(heading=heading, planner=Settings(guard=False))
    assert at_fault(run_with(Always(answer), alone)) is True
    guarded = run_with(Always(answer), crossing(heading=heading))
    assert at_fault(guarded) is not True
    assert guarded.ticks.position[-1, 0] > 2.0  # it does drive


def test_the_point_robot_waits_too():
    told = {"drive": "kinematic", "limits": {"steps": 20}}
    for guard, fault in ((False, True), (True, False)):  # it stands when it is hit
        scenario = crossing(planner=Settings(guard=guard), **told)
        assert at_fault(run_with(Always(Decision(0.0, 0.4)), scenario)) is fault


@pytest.mark.slow
@pytest.mark.parametrize("name", ["dwa", "vfh", "apf", "tangent-bug"])
def test_a_peer_is_at_fault_among_wanderers_only_without_the_guard(name):
    task = random_task(7, count=25)
    random = task.random.model_copy(update={"movers": Wanderers(count=10)})
    ends = []
    for guard in (False, True):
        planner = settings_for(name)(guard=guard)
        update = {"random": random, "planner": planner, "limits": Limits(time=6.0)}
        ends.append(at_fault(run(task.model_copy(update=update))))
    assert ends[0] is True
    assert ends[1] is not True


def test_a_table_of_headings_with_the_guard_is_not_at_fault_either():
    slowly = {**ACROSS, "speed": 0.24}
    for guard, fault in ((False, True), (True, None)):
        planner = QLambdaSettings(guard=guard)
        assert at_fault(run(crossing(slowly, planner=planner, limits={"time": 10.0}))) is fault


def test_towards_who_comes_head_on_it_brakes_and_away_it_may_go_as_fast_as_it_likes():
    towards, away, guard = TwistCommand(0.5, 0.0), TwistCommand(-0.5, 0.0), Guard()
    for k in range(12):
        seen = reading(0.05 * k, (0.0, 0.0), [pillar(1.1 - 0.025 * k, 0.0)])
        seen = replace(seen, motion=MOTION, speed=0.4)
        limited, _ = guard.limit_twist(towards, seen, MOTION)
    assert limited.speed == 0.0
    seen = replace(seen, time=0.6, speed=-0.2)
    assert guard.limit_twist(away, seen, MOTION)[0] == away


def test_beside_who_goes_straight_on_it_slows_down_because_he_may_turn():
    guard = Guard()
    for k in range(12):
        seen = reading(0.05 * k, (0.0, 0.0), [pillar(0.6 - 0.025 * k, 0.62)])
        seen = replace(seen, motion=MOTION, speed=0.5)
        limited, _ = guard.limit_twist(TwistCommand(0.5, 0.0), seen, MOTION)
    assert limited.speed < 0.3


def test_who_brakes_before_one_that_comes_from_behind_goes_on_as_it_was_safe_last():
    guard, flees, brakes = Guard(), TwistCommand(0.6, 0.0), TwistCommand(0.0, 0.0)
    for k in range(13):
        seen = reading(0.05 * k, (0.0, 0.0), [pillar(-0.65 - 0.02 * (11 - k), 0.0)])
        seen = replace(seen, motion=MOTION, speed=0.4)
        limited, _ = guard.limit_twist(flees if k < 12 else brakes, seen, MOTION)
        if k == 11:
            assert limited == flees
    assert limited == flees


def one_that_moves(place, velocity, standing=()):
    """Return the traffic of one point that goes straight on."""
    speed = np.array([math.hypot(*velocity)])
    empty = np.empty((0, 2))
    stands = np.array(standing, dtype=float).reshape(-1, 2)
    course = {"velocities": np.array([velocity]), "straight_for": np.array([math.inf])}
    return Traffic((), np.array([place]), max_speeds=speed, moving=empty, standing=stands, **course)


def is_safe(speed, now, traffic):
    seen = replace(reading(0.0, (0.0, 0.0), [pillar(5.0, 5.0)]), speed=now)
    return safe_twists([TwistCommand(speed, 0.0)], seen, MOTION, traffic).item()


def test_to_whom_it_goes_may_turn_towards_it_whether_it_goes_ahead_or_backwards():
    for sign in (1.0, -1.0):
        crosses = one_that_moves((0.6 * sign, 0.0), (0.0, 0.5))
        assert not is_safe(0.5 * sign, 0.4 * sign, crosses)
        assert is_safe(-0.5 * sign, -0.4 * sign, crosses)


def test_from_who_comes_behind_it_flees_only_where_nothing_stands_ahead():
    behind = (-0.35, 0.0), (0.4, 0.0)
    assert is_safe(0.6, 0.4, one_that_moves(*behind))
    assert not is_safe(0.6, 0.4, one_that_moves(*behind, standing=[(0.6, 0.0)]))
    assert is_safe(0.6, 0.4, one_that_moves(*behind, standing=[(0.6, 0.3)]))


@given(st.floats(-0.6, 0.6), st.floats(0.1, 2.0), st.floats(-math.pi, math.pi))
def test_a_twist_that_is_held_is_an_arc_and_ends_where_the_robot_has_braked(speed, rate, heading):
    seen = replace(
        reading(0.0, (1.0, 2.0), [pillar(5.0, 5.0)]), heading=heading, speed=speed, turn_rate=rate
    )
    held = {"seconds": 2.0, "dt": 0.005, "brakes_after": np.array([1.0])}
    [path] = np.swapaxes(
        rollout_twists(seen, MOTION, np.array([speed]), np.array([rate]), **held), 0, 1
    )
    angle = heading + rate * 1.0
    x = 1.0 + speed / rate * (math.sin(angle) - math.sin(heading))
    y = 2.0 - speed / rate * (math.cos(angle) - math.cos(heading))
    assert path[200] == pytest.approx((x, y), abs=0.01)
    braked = np.hypot(*np.diff(path[200:], axis=0).T).sum()
    assert braked == pytest.approx(MOTION.way_to_stop(speed), abs=0.01)
    assert (path[-1] == path[-2]).all()


def looks_around(planner, motion):
    """Return whether the guard scans all around."""
    scenario = crossing(motion, planner=planner)
    with world_of(scenario) as world:
        seen = Episode(world, scenario).observe()
        looked: list[int] = []

        def look(headings):
            looked.append(len(headings))
            return seen.sensor.look(headings)

        told = replace(seen, sensor=RangeSensor(seen.sensor.sense, look))
        limited = Guard().limit_twist(TwistCommand(0.3, 0.1), told, told.motion)
        if not looked:
            assert limited == twist_filter(TwistCommand(0.3, 0.1), told, told.motion)
        return bool(looked)


def test_where_nothing_is_to_be_reckoned_with_the_guard_is_the_safety_filter_alone():
    assert not looks_around(Settings(), STANDS)
    assert not looks_around(Settings(closing_speed=0.0), ACROSS)
    assert looks_around(Settings(), ACROSS)
    assert looks_around(Settings(closing_speed=0.5), STANDS)


@pytest.mark.parametrize("name", ["fuzzy-q-lambda", "improved-fuzzy", "q-lambda", "dwa"])
def test_the_planner_reckons_with_the_speed_that_its_settings_say(name):
    for said, told in ((None, 0.45), (0.0, 0.0), (1.5, 1.5)):
        planner = settings_for(name)(closing_speed=said)
        scenario = crossing(planner=planner)
        with world_of(scenario) as world:
            assert Episode(world, scenario).observe().closing_speed == pytest.approx(told)


def test_the_guard_that_takes_everything_to_stand_is_at_fault():
    planner = Settings(guard=True, closing_speed=0.0)
    assert at_fault(run_with(Always(TwistCommand(0.6, 0.0)), crossing(planner=planner))) is True


def test_the_example_has_a_planner_for_each_closing_speed(tmp_path, fuzzyq: Call):
    told = {**crossing(ACROSS).model_dump(mode="json"), "planner": "closing-0.2"}
    (tmp_path / "s.json").write_text(json.dumps({**told, "limits": {"time": 0.2}}))
    done = fuzzyq("run", "s.json", "--plugin", EXAMPLE, "--no-video", cwd=tmp_path)
    assert done.returncode == 1, done.stderr  # its time is over
    [record] = tmp_path.rglob("*.npz")
    with np.load(record) as arrays:
        meta = json.loads(str(arrays["meta"]))
    assert meta["scenario"]["planner"] == {"name": "closing-0.2", "closing_speed": 0.2}


def test_a_record_says_the_closing_speed_only_if_it_was_said():
    assert "closing_speed" not in crossing().model_dump_json()
    assert '"closing_speed":0.3' in crossing(planner=Settings(closing_speed=0.3)).model_dump_json()
