"""Claims about whole runs of the default planner among obstacles that stop for nobody."""

from __future__ import annotations

from dataclasses import replace

import pytest

from fuzzyq_bullet import Scenario, run
from fuzzyq_bullet.episode import Episode, planner_of, world_of
from fuzzyq_bullet.planning.base import RangeSensor
from fuzzyq_bullet.recording.fault import at_fault
from fuzzyq_bullet.scenario import load_scenario, random_task, realise
from fuzzyq_bullet.scenario.layouts import Wanderers
from fuzzyq_bullet.video.explanation import reason


def walk(motion, position, **more):
    return Scenario.model_validate(
        {
            "name": "walk",
            "start": {"position": (1.0, 5.0)},
            "goal": {"position": (8.0, 5.0)},
            "obstacles": [
                {"shape": "cylinder", "position": position, "radius": 0.25, "motion": motion}
            ],
            **more,
        }
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", ["crossing", "door", "oncoming"])
def test_nobody_stops_for_the_robot_and_it_touches_nobody(name):
    scenario = load_scenario(name)
    assert not any(one.motion.stops_for_robot for one in scenario.obstacles)
    assert run(scenario).outcome == "goal"


@pytest.mark.slow
@pytest.mark.parametrize("seed", [7_000_020, 7_000_057, 7_000_073])
def test_among_20_wanderers_it_is_not_at_fault(seed):
    # In these three fields it was: an obstacle turned round beside it.
    task = random_task(seed, count=25)
    random = task.random.model_copy(update={"movers": Wanderers(count=20)})
    assert at_fault(run(task.model_copy(update={"random": random}))) is not True


def test_who_comes_from_the_side_is_given_way():
    across = {"kind": "patrol", "points": [(3.0, 3.0), (3.0, 7.0)], "speed": 0.45}
    trajectory = run(walk(across, (3.0, 3.4)))
    assert trajectory.outcome == "goal"
    told = [reason(trajectory, k) for k in range(len(trajectory.decisions.tick))]
    assert "A moving obstacle comes from the right: gives way" in told


def test_who_comes_head_on_is_given_way():
    on = {"kind": "patrol", "points": [(0.5, 5.0), (9.0, 5.0)], "speed": 0.3}
    trajectory = run(walk(on, (5.0, 5.0)))
    assert trajectory.outcome == "goal"


def test_whom_it_cannot_give_way_it_meets_at_rest():
    on = {"kind": "patrol", "points": [(0.5, 0.75), (7.0, 0.75)], "speed": 0.3}
    corridor = {
        "arena": {"size": (8.0, 1.5)},
        "start": {"position": (1.0, 0.75)},
        "goal": {"position": (7.0, 0.75)},
        "obstacles": [
            {"shape": "box", "position": (4.0, 0.75), "size": (0.3, 1.2), "motion": on},
        ],
    }
    trajectory = run(Scenario.model_validate({**walk(on, (5.0, 0.75)).model_dump(), **corridor}))
    assert trajectory.outcome == "collision"
    assert at_fault(trajectory) is False


def closing_speeds(scenario):
    scenario = realise(scenario)
    with world_of(scenario) as world:
        return Episode(world, scenario).observe().closing_speed


def test_the_robot_is_told_how_fast_what_moves_is_and_nothing_where_all_stands():
    patrol = {"kind": "patrol", "points": [(3.0, 3.0), (3.0, 7.0)], "speed": 0.45}
    assert closing_speeds(walk(patrol, (3.0, 3.4))) == pytest.approx(0.45)
    assert closing_speeds(walk({"kind": "still"}, (3.0, 3.4))) == 0.0


def test_the_rim_of_what_turns_on_a_hinge_is_faster_than_its_centre():
    hinge = {"kind": "circle", "centre": (3.0, 3.0), "speed": 0.2}
    fastest = closing_speeds(walk(hinge, (3.5, 3.0)))
    assert fastest == pytest.approx(0.2 * (0.5 + 0.25) / 0.5, rel=0.01)


def test_where_all_stands_it_does_not_look_around():
    scenario = realise(walk({"kind": "still"}, (3.0, 3.4)))
    with world_of(scenario) as world:
        planner, observation = planner_of(scenario), Episode(world, scenario).observe()

        def looked(headings):
            raise AssertionError("it looked around")

        told = replace(observation, sensor=RangeSensor(observation.sensor.sense, looked))
        assert planner.decide(told) == planner_of(scenario).decide(observation)
        with pytest.raises(AssertionError, match="looked around"):
            planner.decide(replace(told, closing_speed=0.5))


@pytest.mark.slow
@pytest.mark.parametrize("speed", [0.45, 0.6])
def test_whom_it_meets_in_a_corridor_it_gets_out_of_the_way_backward(speed):
    # The box fills the corridor and is too near to turn round. It turns at x = 1.5 m.
    on = {"kind": "patrol", "points": [(1.5, 0.75), (6.0, 0.75)], "speed": speed}
    corridor = {
        "arena": {"size": (8.0, 1.5)},
        "start": {"position": (2.0, 0.75)},
        "goal": {"position": (7.0, 0.75)},
        "limits": {"time": 10.0},
        "obstacles": [
            {"shape": "box", "position": (3.0, 0.75), "size": (0.3, 1.2), "motion": on},
        ],
    }
    trajectory = run(Scenario.model_validate({**walk(on, (3.0, 0.75)).model_dump(), **corridor}))
    assert trajectory.outcome == "timeout"
    assert trajectory.ticks.speed.min() < -0.2
    told = [reason(trajectory, k) for k in range(len(trajectory.decisions.tick))]
    assert "A moving obstacle comes from ahead: backs up" in told
