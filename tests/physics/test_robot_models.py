"""Every model drives like an ideal differential drive at its own limits, and a user's URDF too."""

import math
from pathlib import Path

import numpy as np
import pytest

from fuzzyq_bullet import run
from fuzzyq_bullet.drives.velocity_controller import STILL, Twist, limit_acceleration
from fuzzyq_bullet.drives.wheels import COMMAND_STEPS
from fuzzyq_bullet.physics.engine import TIME_STEP
from fuzzyq_bullet.physics.world import World
from fuzzyq_bullet.robots import FUZZYQ, robot_model, robot_names
from fuzzyq_bullet.scenario import Arena, Robot, load_scenario, parse_scenario
from fuzzyq_bullet.shapes.box import Box

ROOT = Path(__file__).resolve().parents[2]
CART = ROOT / "examples" / "robots" / "cart.urdf"


def drive(robot, wanted_at, seconds):
    """Drive; return how far the robot is from the ideal drive (m, rad), and the ideal path (m)."""
    x, y, heading, path, now = 50.0, 50.0, 0.3, 0.0, STILL
    with World([], Arena(size=(100.0, 100.0), walls=False), model=robot.spec) as world:
        world.robot.place(x, y, heading)
        for step in range(round(seconds / TIME_STEP)):
            if step % COMMAND_STEPS == 0:
                wanted = wanted_at(step * TIME_STEP)
                now = limit_acceleration(now, wanted, robot, COMMAND_STEPS * TIME_STEP)
                world.robot.command(*world.model.wheel_commands(*now))
            world.advance(1)
            half = heading + now.turn_rate * TIME_STEP / 2
            x += now.speed * math.cos(half) * TIME_STEP
            y += now.speed * math.sin(half) * TIME_STEP
            heading += now.turn_rate * TIME_STEP
            path += abs(now.speed) * TIME_STEP
        state = world.robot.state()
    turned = abs(math.remainder(state.heading - heading, math.tau))
    return math.hypot(state.x - x, state.y - y), turned, path


ROBOTS = {
    **{name: Robot(model=name) for name in robot_names()},
    "cart": Robot(model=str(CART)),
    "fast": Robot(max_speed=3.0, max_turn_rate=4.0, acceleration=2.0),
    "wide": Robot(radius=0.35, track=0.5, wheel_radius=0.07, mass=12.0),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", ROBOTS)
def test_thirty_seconds_of_random_commands_stay_within_a_hundredth(name):
    robot = ROBOTS[name]
    rng = np.random.default_rng(1)
    most = (robot.max_speed, robot.max_turn_rate)
    twists = rng.uniform((0.0, -most[1]), most, (60, 2))
    off, _, path = drive(robot, lambda t: Twist(*twists[int(t / 0.5)]), 30.0)
    assert path > 10 * robot.radius
    assert off < 0.01 * path


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("motion", ["straight", "turn", "arc"])
def test_straight_turn_and_arc_are_true(name, motion):
    robot = ROBOTS[name]
    v, w = 0.8 * robot.max_speed, 0.5 * robot.max_turn_rate
    twist = {"straight": (v, 0.0), "turn": (0.0, w), "arc": (v / 2, w / 2)}[motion]
    off, turned, path = drive(robot, lambda _: Twist(*twist), 4.0)
    assert off < 0.01 * path + 0.002
    assert turned < math.radians(2.0)


def test_a_rectangle_touches_with_its_corner_and_not_with_its_disc():
    jackal = robot_model("jackal")
    beside = Box(shape="box", position=(5.0, 5.0 + 0.215 + 0.02 + 0.1), size=(0.2, 0.2))
    with World([beside], Arena(), model=jackal) as world:
        world.robot.place(5.0, 5.0, 0.0)  # 2 cm from its side, within its disc
        assert world.advance(24)[1] is None
        world.robot.command(*jackal.wheel_commands(0.0, 1.0))
        assert world.advance(240)[1] is not None


def test_a_body_of_other_numbers_is_another_robot():
    assert Robot().spec is FUZZYQ
    wide = Robot(radius=0.35, mass=12.0).spec
    assert (wide.radius, wide.mass, wide.urdf_file) == (0.35, 12.0, None)


def test_a_urdf_is_measured():
    cart = Robot(model=str(CART)).spec
    assert cart.track == pytest.approx(0.28)
    assert cart.wheel_radius == pytest.approx(0.06)
    assert cart.mass == pytest.approx(4.1)
    assert cart.radius == pytest.approx(math.hypot(0.24, 0.12), abs=0.001)


def test_a_urdf_lies_beside_its_scenario():
    assert load_scenario(CART.with_suffix(".yaml")).robot.model == str(CART)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    ("robot", "side", "reached"),
    [  # a robot drives no faster than it could stop within the 1 m that the default one senses
        ("{model: jackal}", 24.0, 1.6),
        ("{max_speed: 3.0, acceleration: 2.0}", 16.0, 1.8),
    ],
)
def test_no_fast_robot_touches_anything_in_a_random_field(robot, side, reached, seed):
    far = side - 1.5
    scenario = parse_scenario(
        f"name: fast\nseed: {seed}\narena: {{size: [{side}, {side}], walls: true}}\n"
        f"start: {{position: [1.5, 1.5]}}\ngoal: {{position: [{far}, {far}], radius: 0.5}}\n"
        f"robot: {robot}\nrandom: {{count: 20, radius: 0.3}}\nlimits: {{time: 60.0}}\n"
    )
    trajectory = run(scenario)
    assert trajectory.collision is None
    assert trajectory.ticks.speed.max() > reached
