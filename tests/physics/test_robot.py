"""The robot drives like an ideal differential drive, moved by its wheels alone."""

import math

import numpy as np
import pytest

from fuzzyq_bullet.drives.velocity_controller import STILL, Twist, limit_acceleration
from fuzzyq_bullet.drives.wheels import COMMAND_STEPS
from fuzzyq_bullet.physics.engine import TIME_STEP
from fuzzyq_bullet.physics.world import World
from fuzzyq_bullet.platforms import asset
from fuzzyq_bullet.robots import FUZZYQ, RobotModel, register_robot
from fuzzyq_bullet.scenario import Arena, Robot

LIMITS = Robot()


@pytest.fixture
def world():
    with World([], Arena(size=(100.0, 100.0), walls=False)) as world:
        world.robot.place(50.0, 50.0, 0.3)
        yield world


def drive(world, wanted_at, seconds):
    """Drive by changing twists; return the ideal pose, the real state and the ideal path."""
    x, y, heading, path = 50.0, 50.0, 0.3, 0.0
    now = STILL
    for step in range(round(seconds / TIME_STEP)):
        if step % COMMAND_STEPS == 0:
            wanted = wanted_at(step * TIME_STEP, path, heading - 0.3, now)
            now = limit_acceleration(now, wanted, LIMITS, COMMAND_STEPS * TIME_STEP)
            world.robot.command(*world.model.wheel_commands(*now))
        world.advance(1)
        half = heading + now.turn_rate * TIME_STEP / 2
        x += now.speed * math.cos(half) * TIME_STEP
        y += now.speed * math.sin(half) * TIME_STEP
        heading += now.turn_rate * TIME_STEP
        path += abs(now.speed) * TIME_STEP
    return (x, y, heading), world.robot.state(), path


def off(ideal, state):
    turned = math.remainder(state.heading - ideal[2], math.tau)
    return math.hypot(state.x - ideal[0], state.y - ideal[1]), abs(turned)


@pytest.mark.parametrize("seed", range(4))
def test_thirty_seconds_of_random_commands_stay_on_the_ideal_path(world, seed):
    rng = np.random.default_rng(seed)
    times = np.arange(0.0, 30.0, 0.5)
    twists = [Twist(*twist) for twist in rng.uniform((0.0, -2.0), (0.6, 2.0), (times.size, 2))]
    ideal, state, path = drive(world, lambda t, *_: twists[int(t / 0.5)], 30.0)
    assert path > 6.0
    assert off(ideal, state)[0] < 0.002 * path


def stop_at(goal, now, reached, limit, acceleration):
    """Drive at ``limit`` and brake in time to stand at ``goal``."""
    return max(0.0, min(limit, math.sqrt(max(0.0, 2 * acceleration * (goal - reached)))))


def test_five_metres_straight_are_five_metres(world):
    def wanted(_, path, __, now):
        return Twist(stop_at(5.0, now, path, 0.6, 0.9), 0.0)

    ideal, state, path = drive(world, wanted, 12.0)
    assert path == pytest.approx(5.0, abs=0.02)
    distance, turned = off(ideal, state)
    assert distance < 0.001 * path
    assert turned < math.radians(0.1)


@pytest.mark.parametrize("degrees", [90, 360])
def test_a_turn_on_the_spot_is_true_and_stays_on_the_spot(world, degrees):
    goal = math.radians(degrees)

    def wanted(_, __, turned, now):
        return Twist(0.0, stop_at(goal, now, turned, 2.0, 5.0))

    ideal, state, _ = drive(world, wanted, 6.0)
    assert ideal[2] - 0.3 == pytest.approx(goal, abs=0.02)
    distance, turned = off(ideal, state)
    assert turned < 0.001 * goal
    assert distance < 0.001


def test_an_arc_is_true(world):
    ideal, state, path = drive(world, lambda *_: Twist(0.4, 0.5), 12.0)
    distance, turned = off(ideal, state)
    assert distance < 0.001 * path
    assert turned < 0.001 * (ideal[2] - 0.3)


def test_nothing_but_the_wheels_moves_the_robot(world):
    world.advance(480)
    state = world.robot.state()
    assert math.hypot(state.x - 50.0, state.y - 50.0) < 1e-4


def test_it_keeps_its_limits_of_acceleration(world):
    speeds = []
    now = STILL
    for step in range(240):
        if step % COMMAND_STEPS == 0:
            now = limit_acceleration(now, Twist(0.6, 0.0), LIMITS, COMMAND_STEPS * TIME_STEP)
            world.robot.command(*FUZZYQ.wheel_commands(*now))
        world.advance(1)
        speeds.append(world.robot.state().speed)
    gained = np.diff(speeds[::24]) / (24 * TIME_STEP)
    assert gained.max() < 1.05 * LIMITS.acceleration
    assert speeds[-1] == pytest.approx(0.6, abs=0.002)


def test_placing_the_robot_sets_its_centre_and_its_heading(world):
    for x, y, heading in [(1.0, 2.0, 0.0), (-3.0, 4.5, 2.5), (7.0, 0.0, -1.2)]:
        world.robot.place(x, y, heading)
        state = world.robot.state()
        assert (state.x, state.y) == pytest.approx((x, y), abs=1e-9)
        assert state.heading == pytest.approx(heading, abs=1e-9)
        assert (state.speed, state.turn_rate) == (0.0, 0.0)


def test_the_urdf_loads_without_a_word_from_pybullet(capfd):
    with World([], Arena()):
        pass
    out, err = capfd.readouterr()
    assert out == ""
    assert err == ""


def test_a_robot_made_from_its_numbers_drives_as_truly_as_one_from_a_file(capfd):
    small = RobotModel(name="small", radius=0.12, track=0.18, wheel_radius=0.03, mass=1.5)
    for model in (FUZZYQ.model_copy(update={"urdf_file": None}), small):
        with World([], Arena(size=(100.0, 100.0), walls=False), model=model) as world:
            world.robot.place(50.0, 50.0, 0.3)
            ideal, state, path = drive(world, lambda *_: Twist(0.4, 0.5), 8.0)
        distance, turned = off(ideal, state)
        assert distance < 0.002 * path
        assert turned < 0.002 * (ideal[2] - 0.3)
    assert capfd.readouterr() == ("", "")


def test_a_robot_is_registered_once_and_only_with_wheels_that_fit():
    with pytest.raises(ValueError, match="registered already"):
        register_robot(FUZZYQ)
    with pytest.raises(ValueError, match="do not fit under its body"):
        register_robot(RobotModel(name="wide", radius=0.1, track=0.3))


def test_another_reader_sees_the_same_robot():
    yourdfpy = pytest.importorskip("yourdfpy")
    robot = yourdfpy.URDF.load(str(asset("robot.urdf")))
    assert robot.validate()
    assert robot.base_link == "chassis"
    assert set(robot.actuated_joint_names) == {"left_axle", "right_axle"}
    [body] = robot.link_map["chassis"].collisions
    assert body.geometry.cylinder.radius == FUZZYQ.radius
