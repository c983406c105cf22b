"""Whole episodes: what drives, what touches, what is recorded, and that it repeats."""

import math
from dataclasses import replace

import numpy as np
import pytest

from fuzzyq_bullet.drives.velocity_controller import Twist
from fuzzyq_bullet.episode import Episode, run, run_in
from fuzzyq_bullet.errors import PlannerError, UserError
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.ground_truth import shortest_path
from fuzzyq_bullet.physics.sensor_world import SensorWorld
from fuzzyq_bullet.physics.world import World
from fuzzyq_bullet.planning import Decision, FuzzySettings, ImprovedFuzzySettings
from fuzzyq_bullet.recording import metrics
from fuzzyq_bullet.recording.metrics import result_of
from fuzzyq_bullet.recording.trajectory import Trajectory
from fuzzyq_bullet.robots import FUZZYQ
from fuzzyq_bullet.scenario import (
    Arena,
    Box,
    Cylinder,
    Goal,
    Limits,
    Random,
    Robot,
    Scenario,
    Start,
    load_scenario,
    realise,
    with_options,
)

FAST = ImprovedFuzzySettings(weights=(1.0, 1.0))


def scenario(**changes):
    plain = {
        "name": "test",
        "arena": Arena(size=(5.0, 5.0)),
        "start": Start(position=(0.5, 2.5)),
        "goal": Goal(position=(4.5, 2.5)),
        "planner": FAST,
        "limits": Limits(time=40.0),
    }
    return Scenario(**{**plain, **changes})


def cylinder(x, y, radius=0.2):
    return Cylinder(shape="cylinder", position=(x, y), radius=radius)


def ahead_of(trajectory):
    """Return the true free distance straight ahead of the robot at every tick (m)."""
    field = Field.of(trajectory.scenario.obstacles, trajectory.scenario.arena)
    ticks = trajectory.ticks
    return np.array(
        [
            field.free_distance(position, [heading], FUZZYQ.radius, 5.0)[0]
            for position, heading in zip(ticks.position, ticks.heading, strict=True)
        ]
    )


@pytest.fixture(scope="module")
def crossing():
    return run(scenario(obstacles=(cylinder(2.5, 2.6), cylinder(3.6, 2.2)), seed=3))


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
@pytest.mark.parametrize("planner", [FuzzySettings(), ImprovedFuzzySettings()])
def test_an_open_field_is_crossed_straight(drive, planner):
    trajectory = run(scenario(drive=drive, planner=planner))
    result = result_of(trajectory)
    assert result.outcome == "goal"
    assert result.path_length_m == pytest.approx(4.0, abs=0.25)
    assert np.abs(trajectory.ticks.position[:, 1] - 2.5).max() < 0.02


def test_it_stops_within_the_goal(crossing):
    assert crossing.outcome == "goal"
    last = crossing.ticks.position[-1]
    assert math.dist(last, (4.5, 2.5)) <= 0.2 + 1e-9
    assert abs(crossing.ticks.speed[-1]) < 0.01


def test_it_goes_round_what_stands_in_the_way(crossing):
    assert crossing.ticks.clearance.min() > 0.0
    assert np.abs(crossing.ticks.position[:, 1] - 2.5).max() > 0.15
    assert crossing.decisions.difference.any()


def test_it_flows_and_does_not_stop_to_turn():
    plain = ImprovedFuzzySettings(weights=(1.0, 1.0), breakout=False)
    ticks = run(scenario(obstacles=(cylinder(2.5, 2.6), cylinder(3.6, 2.2)), planner=plain)).ticks
    under_way = (ticks.time > 1.0) & (np.hypot(*(ticks.position - (4.5, 2.5)).T) > 0.5)
    assert ticks.speed[under_way].min() > 0.03


def test_it_decides_several_times_a_second(crossing):
    taken = crossing.ticks.time[crossing.decisions.tick]
    assert np.diff(taken).max() <= 0.3 + 1e-9


@pytest.mark.slow
def test_it_never_outruns_its_braking_distance():
    field = scenario(
        arena=Arena(size=(10.0, 10.0)),
        start=Start(position=(1.0, 1.0)),
        goal=Goal(position=(9.0, 9.0)),
        random=Random(count=75),
        robot=Robot(max_speed=1.0, acceleration=0.8),
    )
    for seed in range(3):
        trajectory = run(with_options(field, seed=seed))
        braking = trajectory.ticks.speed**2 / (2 * 0.8)
        assert (braking <= ahead_of(trajectory) + 0.005).all()


@pytest.mark.slow
@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
@pytest.mark.parametrize("weight", [0.5, 1.0])
def test_the_guarded_planner_touches_nothing_even_where_it_gets_stuck(drive, weight):
    for seed in range(4):
        trajectory = run(
            scenario(
                arena=Arena(size=(6.0, 6.0)),
                start=Start(position=(0.6, 0.6)),
                goal=Goal(position=(5.4, 5.4)),
                random=Random(count=45),
                planner=ImprovedFuzzySettings(weights=(weight, weight)),
                drive=drive,
                seed=seed,
            )
        )
        assert trajectory.collision is None
        assert trajectory.outcome in {"goal", "stuck", "timeout"}
        assert trajectory.ticks.clearance.min() > 0.0


class Onward:
    """A planner that drives straight on, whatever it might see."""

    def __init__(self, heading=0.0):
        self.heading = heading

    def decide(self, observation):
        return Decision(heading=self.heading, step=0.4)


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
@pytest.mark.parametrize("away", [*np.linspace(0.3, 0.41, 12), 1.0, 2.5, 4.5])
def test_a_touch_is_noticed_at_once_from_wherever_the_robot_came(drive, away):
    task = realise(
        scenario(
            arena=Arena(size=(12.0, 9.0)),
            start=Start(position=(8.0 - 0.4 - away, 4.5)),
            goal=Goal(position=(11.0, 4.5)),
            obstacles=(cylinder(8.0, 4.5),),
            drive=drive,
        )
    )
    with World(task.obstacles, task.arena) as world:
        trajectory = run_in(world, task, Onward())
    assert trajectory.collision is not None
    # At full speed a physics step is 2.5 mm long.
    assert abs(trajectory.ticks.clearance[-1]) < 0.003


@pytest.mark.slow
def test_whatever_the_twists_the_robot_is_never_inside_of_anything_unnoticed():
    # Wild twists among posts and boxes, from one contact to the next.
    rng = np.random.default_rng(3)
    obstacles = [cylinder(*at, radius=0.15) for at in rng.uniform(0.5, 5.5, (14, 2))]
    obstacles += [
        Box(shape="box", position=tuple(at), size=(0.4, 0.3), yaw=at[0])
        for at in rng.uniform(0.5, 5.5, (8, 2))
    ]
    arena, told = Arena(size=(6.0, 6.0)), Decision(heading=0.0, step=0.0)
    with World(obstacles, arena) as world:
        free = [
            at for at in rng.uniform(0.3, 5.7, (60, 2)) if world.field.clearance([at])[0] > 0.22
        ]
        collisions = 0
        for start in free:
            task = scenario(
                arena=arena,
                start=Start(position=tuple(start), heading=rng.uniform(-3.0, 3.0)),
                goal=Goal(position=(100.0, 100.0)),
                obstacles=world.obstacles,
                robot=Robot(max_speed=0.9, acceleration=0.6, turn_acceleration=8.0),
                limits=Limits(steps=20),
            )
            episode = Episode(world, task, rate=1.0 / 0.3)
            while episode.outcome is None:
                episode.steer(Twist(*rng.uniform((0.2, -2.0), (0.9, 2.0))), told)
            ticks = episode.record().ticks
            # Where it touched, by no more than a physics step; before, by no more than its margin.
            assert ticks.clearance[-1] > -0.004
            assert ticks.clearance[:-1].min() > -0.001
            collisions += episode.outcome == "collision"
    assert collisions > 15


def test_lines_of_another_shape_are_refused_and_not_told_of_other_decisions():
    class Uneven:
        def decide(self, observation):
            count = 2 if observation.time < 0.5 else 4
            return Decision(heading=0.0, step=0.4, lines=(0.0,) * count, lengths=(1.0,) * 3)

    task = realise(scenario(limits=Limits(time=1.2)))
    with (
        World(task.obstacles, task.arena) as world,
        pytest.raises(PlannerError, match=r"the lines .*, which must be of size 3"),
    ):
        run_in(world, task, Uneven())


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_a_touch_is_a_collision_that_says_when_where_and_what(drive):
    obstacles = (cylinder(1.5, 4.0), cylinder(3.0, 2.5), cylinder(4.0, 1.0))
    task = realise(scenario(obstacles=obstacles, drive=drive))
    with World(task.obstacles, task.arena) as world:
        trajectory = run_in(world, task, Onward())
    assert trajectory.outcome == "collision"
    hit = trajectory.collision
    assert hit.obstacle == 1
    assert hit.time == pytest.approx(trajectory.ticks.time[-1])
    assert trajectory.ticks.position[-1][0] == pytest.approx(3.0 - 0.4, abs=0.02)
    assert hit.point == pytest.approx((2.8, 2.5), abs=0.02)
    assert result_of(trajectory).collisions == 1


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_a_wall_is_named_as_a_wall(drive):
    task = realise(scenario(drive=drive))
    with World(task.obstacles, task.arena) as world:
        trajectory = run_in(world, task, Onward(math.pi / 2))
    assert trajectory.outcome == "collision"
    assert trajectory.collision.obstacle == -1
    assert trajectory.ticks.position[-1][1] == pytest.approx(4.8, abs=0.02)


def test_the_kinematic_drive_moves_by_equation_17_exactly():
    trajectory = run(scenario(drive="kinematic", obstacles=(cylinder(2.5, 2.6),)))
    position, decisions = trajectory.ticks.position, trajectory.decisions
    assert len(position) == len(decisions.step) + 1
    direction = np.column_stack([np.cos(decisions.heading), np.sin(decisions.heading)])
    assert np.diff(position, axis=0) == pytest.approx(
        decisions.step[:, None] * direction, abs=1e-12
    )


def test_the_kinematic_touch_is_swept_and_not_only_looked_for_at_the_end():
    # A step of 0.4 m over an obstacle of 0.1 m: both its ends are free.
    task = realise(
        scenario(
            drive="kinematic",
            start=Start(position=(0.5, 2.5)),
            obstacles=(cylinder(0.5 + 0.35, 2.5 + 0.22, 0.025),),
        )
    )
    with World(task.obstacles, task.arena) as world:
        trajectory = run_in(world, task, Onward())
    assert trajectory.outcome == "collision"


@pytest.mark.parametrize("gap", [0.02, 0.21, 0.38, 0.399])
def test_a_step_a_little_longer_than_what_is_free_ends_at_the_touch(gap):
    start = Start(position=(2.0, 2.5))
    obstacles = (cylinder(2.0 + 2.0 * FUZZYQ.radius + gap, 2.5),)
    task = realise(scenario(drive="kinematic", start=start, obstacles=obstacles))
    with SensorWorld(task.obstacles, task.arena) as world:
        trajectory = run_in(world, task, Onward())
    assert trajectory.outcome == "collision"
    assert trajectory.ticks.position[:, 0] == pytest.approx([2.0, 2.0 + gap], abs=1e-3)


def test_wheels_need_a_world_that_can_be_touched():
    task = realise(scenario(drive="wheels"))
    with (
        SensorWorld(task.obstacles, task.arena) as world,
        pytest.raises(ValueError, match="wheels needs a world that can be touched"),
    ):
        run_in(world, task, Onward())


def test_a_dead_end_ends_as_stuck_and_a_short_limit_as_timeout():
    trap = (
        Box(shape="box", position=(2.6, 2.5), size=(0.2, 2.0)),
        Box(shape="box", position=(2.2, 3.4), size=(0.8, 0.2)),
        Box(shape="box", position=(2.2, 1.6), size=(0.8, 0.2)),
    )
    plain = ImprovedFuzzySettings(weights=(1.0, 1.0), breakout=False)
    assert run(scenario(obstacles=trap, planner=plain)).outcome == "stuck"
    short = run(scenario(limits=Limits(time=2.0)))
    assert short.outcome == "timeout"
    assert short.ticks.time[-1] == pytest.approx(2.0, abs=0.2)
    few = run(scenario(limits=Limits(steps=5)))
    assert (few.outcome, len(few.decisions.tick)) == ("timeout", 5)


def test_everything_that_a_picture_needs_is_recorded(crossing):
    decisions = crossing.decisions
    for name in ("lines", "lengths", "near", "side", "rules", "weights", "step", "turn", "guard"):
        assert np.isfinite(getattr(decisions, name)).all(), name
    assert decisions.rules == pytest.approx(decisions.near[:, :, None] * decisions.side[:, None])
    ticks = crossing.ticks
    assert (np.diff(ticks.time) > 0).all()
    assert decisions.tick[-1] < len(ticks.time)
    ideal = ticks.wheel_speeds.mean(axis=1) * 0.05
    assert np.abs(ideal - ticks.speed).max() < 0.03


def least_distance_of_bodies(world):
    """Return the distance (m) that PyBullet sees from the robot's body to obstacles and walls."""
    robot, client = world.robot.body, world.engine.client
    return min(
        point[8]
        for body in (world.obstacle_body, world.walls)
        for point in world.engine.api.getClosestPoints(
            robot, body, 10.0, -1, -1, physicsClientId=client
        )
    )


def test_the_recorded_clearance_is_that_of_the_bodies_in_the_physics(crossing):
    ticks = crossing.ticks
    with World(crossing.scenario.obstacles, crossing.scenario.arena) as world:
        seen = zip(ticks.position, ticks.heading, ticks.clearance, strict=True)
        for (x, y), heading, told in seen:
            world.robot.place(x, y, heading)
            assert told == pytest.approx(least_distance_of_bodies(world), abs=0.002)


def test_a_record_survives_the_disk(crossing, tmp_path):
    path = tmp_path / "run.npz"
    crossing.save(path)
    again = Trajectory.load(str(path))
    assert again.digest() == crossing.digest()
    assert again.scenario == crossing.scenario
    assert (again.outcome, again.collision) == (crossing.outcome, crossing.collision)
    assert result_of(again) == result_of(crossing)


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_the_same_run_has_the_same_digest_and_another_seed_another(drive):
    task = scenario(random=Random(count=15), drive=drive)
    first = run(task).digest()
    assert run(task).digest() == first
    assert run(with_options(task, seed=5)).digest() != first


@pytest.mark.slow
def test_a_world_used_before_gives_the_same_run():
    task = realise(scenario(obstacles=(cylinder(2.5, 2.6),)))
    with World(task.obstacles, task.arena) as world:
        digests = {
            run_in(world, task, FuzzyOrImproved()).digest() for FuzzyOrImproved in [make] * 3
        }
    assert digests == {run(task).digest()}


def make():
    from fuzzyq_bullet.planning import ImprovedFuzzyPlanner

    return ImprovedFuzzyPlanner(FAST)


def test_a_scenario_that_cannot_be_is_refused_before_anything_runs():
    with pytest.raises(UserError, match="start"):
        run(scenario(obstacles=(cylinder(0.5, 2.5),)))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["open-field", "sparse", "paper-50", "boxes", "mixed"])
def test_the_bundled_scenarios_keep_what_they_expect(name):
    task = load_scenario(name)
    result = result_of(run(task))
    assert result.outcome == task.expect.outcome
    assert result.collisions == 0
    if task.expect.max_time is not None:
        assert result.time_s <= task.expect.max_time


def test_every_decision_is_counted_in_its_mode(crossing):
    result = result_of(crossing)
    modes = result.modes
    assert modes.routine + modes.breakout + modes.following == result.decisions


def test_a_result_compares_the_driven_path_with_the_shortest(crossing):
    result = result_of(crossing)
    assert result.shortest_path_m == pytest.approx(shortest_path(crossing.scenario).length)
    assert 3.8 < result.shortest_path_m < result.path_length_m
    assert result.spl == pytest.approx(result.shortest_path_m / result.path_length_m, abs=1e-6)


def test_a_run_that_failed_where_there_was_a_way_weighs_nothing():
    result = result_of(run(scenario(limits=Limits(time=1.0))))
    assert result.outcome == "timeout"
    assert result.shortest_path_m == pytest.approx(3.8)
    assert result.spl == 0.0
    assert "no_shortest_path" not in result.model_dump()


def test_where_there_is_no_way_there_is_nothing_to_weigh_by():
    wall = Box(shape="box", position=(2.5, 2.5), size=(0.2, 5.0))
    result = result_of(run(scenario(obstacles=(wall,), limits=Limits(time=1.0))))
    assert result.outcome != "goal"
    assert result.shortest_path_m is None
    assert result.spl is None
    assert result.model_dump()["no_shortest_path"] == "there is no way"


@pytest.mark.parametrize(
    ("item", "each"), [(cylinder(2.5, 1.0), 1), (Box(shape="box", position=(2, 1), size=(1, 1)), 4)]
)
def test_among_too_many_obstacles_nobody_waits_for_the_shortest_path(item, each, monkeypatch):
    asked = []
    monkeypatch.setattr(metrics, "shortest_path", asked.append)
    trajectory = run(scenario(limits=Limits(time=0.5)))
    for count in (metrics.MOST_ROUND // each, metrics.MOST_ROUND // each + 1):
        task = trajectory.scenario.model_copy(update={"obstacles": (item,) * count})
        result = result_of(replace(trajectory, scenario=task))
        assert (result.shortest_path_m, result.spl) == (None, None)
    assert len(asked) == 1
    assert result.no_shortest_path == "not looked for among more than 1500 corners and cylinders"


def test_decisions_may_come_more_often():
    task = realise(scenario(obstacles=(cylinder(2.5, 2.6),), limits=Limits(time=3.0)))
    with World(task.obstacles, task.arena) as world:
        episode = Episode(world, task, rate=20)
        while episode.outcome is None:
            episode.advance(make().decide(episode.observe()))
        taken = episode.record()
        assert np.diff(taken.ticks.time[taken.decisions.tick]) == pytest.approx(0.05)
        for rate in (7, 120):
            with pytest.raises(ValueError, match="no whole number of physics steps"):
                Episode(world, task, rate=rate)
