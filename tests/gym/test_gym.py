"""The Gymnasium door: what holds for each environment, and what each of the two means."""

from __future__ import annotations

import importlib.util
import inspect
import itertools
import json
import math
import subprocess
import sys
import warnings
from collections.abc import Iterator
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.error import ResetNeeded
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AsyncVectorEnv

import fuzzyq_bullet.gym
from fuzzyq_bullet import Decision
from fuzzyq_bullet.drives.velocity_controller import Twist
from fuzzyq_bullet.episode import Episode
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.ground_truth import feasible
from fuzzyq_bullet.gym.env import EpisodeEnv
from fuzzyq_bullet.gym.navigation import NavigationEnv
from fuzzyq_bullet.gym.tasks import TaskSource
from fuzzyq_bullet.gym.weights import WeightsEnv
from fuzzyq_bullet.physics.world import World
from fuzzyq_bullet.scenario import Scenario, load_scenario, parse_scenario, realise, with_options
from fuzzyq_bullet.video import style

ROOT = Path(__file__).resolve().parents[2]
WITHOUT = "the extra rl is not installed"
IDS = tuple(fuzzyq_bullet.gym.ENVIRONMENTS)
both = pytest.mark.parametrize("name", IDS)
DISTANCE_AT = {"fuzzyq_bullet/Navigation-v0": 8, "fuzzyq_bullet/Weights-v0": 9}
"""Where the distance to the goal is in an observation."""

ROOM = """\
name: room
arena: {size: [3.0, 2.0]}
start: {position: [0.6, 1.0], heading: 0.0}
goal: {position: [2.2, 1.0]}
limits: {time: 5.0}
"""


@pytest.fixture
def room() -> Scenario:
    """Nothing between the start and a goal 1.6 m ahead, and 5 s to get there."""
    return parse_scenario(ROOM)


@pytest.fixture
def make() -> Iterator[Any]:
    """Makes environments without wrappers, and closes them."""
    made = []

    def one(name: str, **options: Any) -> EpisodeEnv:
        env = gymnasium.make(name, **options).unwrapped
        assert isinstance(env, EpisodeEnv)
        made.append(env)
        return env

    yield one
    for env in made:
        env.close()


def played(env: Any, seed: int, steps: int) -> list[list[float]]:
    """All that a policy meets in some steps of random actions, through the ends of episodes."""
    env.action_space.seed(7)
    seen, info = env.reset(seed=seed)
    met = [[*seen.tolist(), info["seed"]]]
    for _ in range(steps):
        seen, reward, ended, cut, _ = env.step(env.action_space.sample())
        met.append([*seen.tolist(), reward, ended, cut])
        if ended or cut:
            seen, info = env.reset()
            met.append([*seen.tolist(), info["seed"]])
    return met


# --- both environments


@both
def test_it_is_found_by_name_without_loading_physics(name: str) -> None:
    code = (
        "import sys, gymnasium, fuzzyq_bullet.gym\n"
        f"print(gymnasium.spec({name!r}).id, 'pybullet' in sys.modules)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == [name, "False"]


def test_the_installed_entry_point_registers_both_and_may_be_called_again() -> None:
    (found,) = entry_points(group="gymnasium.envs", name="__root__")
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # Gymnasium warns of ids that are overridden
        found.load()()
    assert set(IDS) <= set(gymnasium.registry)


@both
def test_gymnasiums_own_check_has_nothing_to_say(name: str, make: Any) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(make(name, count=5, render_mode="rgb_array"))


@pytest.fixture(scope="module")
def elsewhere() -> dict[str, Any]:
    """What a policy meets in each environment, in a process that imports nothing of ours."""
    code = (
        f"from __future__ import annotations\nimport json, gymnasium\n{inspect.getsource(played)}\n"
        "make = lambda name: gymnasium.make('fuzzyq_bullet.gym:' + name, count=60)\n"
        f"print(json.dumps({{name: played(make(name), 3, 40) for name in {IDS!r}}}))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    met: dict[str, Any] = json.loads(done.stdout)
    return met


@pytest.mark.slow
@both
def test_the_same_seed_gives_the_same_episodes_in_any_process(
    name: str, make: Any, elsewhere: dict[str, Any]
) -> None:
    here = played(make(name, count=60), 3, 40)
    used = make(name, count=60)
    used.reset(seed=11)
    assert played(used, 3, 40) == here, "what was run before must leave no trace"
    assert played(make(name, count=60), 4, 2) != here[:3]
    assert elsewhere[name] == json.loads(json.dumps(here))


@both
def test_without_a_seed_the_sequence_goes_on(name: str, make: Any) -> None:
    env, again = make(name, count=5), make(name, count=5)
    seeds = [env.reset(seed=1)[1]["seed"], *(env.reset()[1]["seed"] for _ in range(3))]
    assert len(set(seeds)) == 4
    assert seeds == [again.reset(seed=1)[1]["seed"], *(again.reset()[1]["seed"] for _ in range(3))]


@pytest.mark.slow
@both
def test_every_element_of_an_observation_says_something(name: str, make: Any) -> None:
    env = make(name, count=100)
    env.action_space.seed(0)
    seen = []
    for seed in range(4):
        seen.append(env.reset(seed=seed)[0])
        for _ in range(150):
            observation, _, ended, cut, _ = env.step(env.action_space.sample() / 2)
            seen.append(observation)
            if ended or cut:
                break
    assert all(env.observation_space.contains(one) for one in seen)
    assert not any(np.shares_memory(a, b) for a, b in itertools.combinations(seen[:30], 2))
    assert (np.ptp(seen, axis=0) > 0.0).all()


@both
def test_the_reward_is_the_sum_of_its_parts(name: str, make: Any, room: Scenario) -> None:
    env = make(name, scenario=room)
    env.reset(seed=0)
    ahead, total, info = np.array([1.0, 0.0], dtype=np.float32), 0.0, {}
    ended = False
    while not ended:
        _, reward, ended, cut, info = env.step(ahead)
        assert not cut
        assert set(info) == {"reward", "outcome", "is_success"}
        assert info["is_success"] == (info["outcome"] == "goal") == ended
        assert sum(info["reward"].values()) == reward
        assert info["reward"].keys() == {"time", "progress", "contact", "given_up"}
        total += reward
    # What was lost on the way: the time it took, less that of a straight way at full speed.
    record = env.record()
    nearer = 1.6 - math.dist(record.ticks.position[-1], (2.2, 1.0))
    assert total == pytest.approx(nearer / 0.6 - record.ticks.time[-1])
    with pytest.raises(ResetNeeded, match="over \\(goal\\)"):
        env.step(ahead)


@both
def test_standing_still_ends_as_stuck_or_is_cut_off_by_the_limits(
    name: str, make: Any, room: Scenario
) -> None:
    still = np.array([-1.0, 0.0])

    def last(scenario: Scenario) -> tuple[bool, bool, dict[str, Any], int]:
        env = make(name, scenario=scenario)
        env.reset()
        for step in itertools.count(1):
            _, _, ended, cut, info = env.step(still)
            if ended or cut:
                return ended, cut, info, step
        raise AssertionError

    ended, cut, info, steps = last(room)
    assert (ended, cut, info["outcome"], steps) == (False, True, "timeout", 17)
    assert info["reward"]["given_up"] < 0.0
    patient = room.model_copy(update={"limits": room.limits.model_copy(update={"time": 60.0})})
    ended, cut, info, steps = last(patient)
    assert (ended, cut, info["outcome"], steps) == (True, False, "stuck", 50)


@both
def test_workers_see_what_one_process_sees(name: str, make: Any) -> None:
    vector = gymnasium.make_vec(name, 2, vectorization_mode="async", count=20)
    assert isinstance(vector, AsyncVectorEnv)
    alone = [make(name, count=20), make(name, count=20)]
    try:
        seen, infos = vector.reset(seed=5)
        for k, env in enumerate(alone):
            observation, info = env.reset(seed=5 + k)
            assert (seen[k] == observation).all()
            assert infos["seed"][k] == info["seed"]
        action = np.array([[0.2, 0.3], [0.5, -0.4]], dtype=np.float32)
        for _ in range(4):
            seen, rewards, _, _, infos = vector.step(action)
            for k, env in enumerate(alone):
                observation, reward, _, _, info = env.step(action[k])
                assert (seen[k] == observation).all()
                assert rewards[k] == reward
                assert infos["reward"]["time"][k] == info["reward"]["time"]
    finally:
        vector.close()


@both
def test_a_picture_shows_the_robot_where_it_is(name: str, make: Any, room: Scenario) -> None:
    env = make(name, scenario=room, render_mode="rgb_array")
    env.reset()
    before = env.render()
    assert (before.shape, before.dtype) == ((384, 372, 3), np.uint8)
    assert (env.render() == before).all()
    assert (before == style.MIDDLE).all(axis=-1).any(), "what it senses is drawn from the start"
    for _ in range(6):
        seen, *_ = env.step(np.array([1.0, 0.0]))
    after = env.render()
    told = seen[DISTANCE_AT[name]]
    x = 2.2 - 5.0 * told / (1.0 - told)  # it drives along the middle of the room
    # The map shows 3 m between margins of 12 pixels. The rim of the robot's disc is white, above
    # the arrow that points where it faces.
    pixels = (372 - 24) / 3.0
    rim = (round(192 - 0.15 * pixels), round(12 + x * pixels))
    assert after[rim].min() > 240
    assert before[rim].max() < 100


@both
def test_a_closed_environment_may_be_closed_again_and_begun_anew(name: str, make: Any) -> None:
    env = make(name, count=0, render_mode="rgb_array")
    env.close()
    first, _ = env.reset(seed=2)
    env.close()
    env.close()
    for call in (env.render, env.record, lambda: env.step(np.zeros(2))):
        with pytest.raises(ResetNeeded, match="reset first"):
            call()
    assert (env.reset(seed=2)[0] == first).all()


@both
def test_an_action_is_two_numbers(name: str, make: Any, room: Scenario) -> None:
    env, other = make(name, scenario=room), make(name, scenario=room)
    env.reset()
    other.reset()
    for wrong in (np.zeros(3), np.array([0.0, math.nan]), 0.5):
        with pytest.raises(ValueError, match="two numbers from -1 to 1"):
            env.step(wrong)
    far, near = env.step(np.array([9.0, -math.inf])), other.step(np.array([1.0, -1.0]))
    assert (far[0] == near[0]).all(), "what lies beyond the bounds is moved to them"


@both
@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"count": 151}, "count: must be a number from 0 to 150"),
        ({"count": (5, 3)}, "smaller first, got \\(5, 3\\)"),
        ({"count": 5.0}, "count: must be a number"),
        ({"count": True}, "count: must be a number"),
        ({"count": 3, "scenario": "mixed"}, "count: is for random tasks"),
        ({"scenario": "mixd"}, "did you mean 'mixed'"),
        ({"scenario": 3}, "scenario: must be a Scenario, a path or a name, got int"),
    ],
)
def test_an_option_that_is_wrong_is_one_line(
    name: str, options: dict[str, Any], message: str
) -> None:
    with pytest.raises(UserError, match=message) as caught:
        gymnasium.make(name, **options)
    assert len(caught.value.problems) == 1


def test_other_options_that_are_wrong(make: Any, room: Scenario) -> None:
    outside = room.model_copy(
        update={"goal": room.goal.model_copy(update={"position": (9.0, 1.0)})}
    )
    with pytest.raises(UserError, match=r"room: goal\.position: .*outside the arena"):
        NavigationEnv(scenario=outside)
    with pytest.raises(UserError, match=r"drive: .*kinematic"):
        WeightsEnv(drive="wings")
    with pytest.raises(UserError, match="render_mode: must be rgb_array or None, got 'human'"):
        NavigationEnv(render_mode="human")
    with pytest.raises(UserError, match="options: there are none, got speed"):
        make(IDS[0], count=0).reset(options={"speed": 1})


# --- tasks


def test_drawn_worlds_have_a_way_and_obey_the_count() -> None:
    rng, drive = np.random.default_rng(0), "kinematic"
    source = TaskSource(scenario=None, count=(130, 150), drive=drive)
    counts = set()
    for _ in range(6):
        scenario = source.draw(rng)
        assert feasible(scenario, 0.22)
        counts.add(len(scenario.obstacles))
        assert scenario.drive == drive
    assert len(counts) > 1
    assert counts <= set(range(130, 151))
    closed = parse_scenario(
        "name: closed\nstart: {position: [1.0, 1.0]}\ngoal: {position: [9.0, 1.0]}\n"
        "obstacles: [{shape: box, position: [5.0, 5.0], size: [0.2, 10.0]}]\n"
        "random: {count: 1}\n"
    )
    with pytest.raises(UserError, match="closed: none of 100 worlds drawn has a way to the goal"):
        TaskSource(scenario=closed, count=50, drive="wheels").draw(rng)


def test_a_scenario_stays_and_what_it_draws_is_drawn_anew() -> None:
    rng = np.random.default_rng(0)
    boxes = load_scenario("boxes")
    assert boxes.random is None
    always = TaskSource(scenario="boxes", count=50, drive="kinematic")
    assert always.draw(rng) == always.draw(rng) == with_options(boxes, drive="kinematic")
    field = load_scenario("paper-50")
    assert field.random is not None
    drawing = TaskSource(scenario=field, count=50, drive="wheels")
    first, second = drawing.draw(rng), drawing.draw(rng)
    assert first.obstacles != second.obstacles
    assert (first.start, first.goal) == (second.start, second.goal) == (field.start, field.goal)
    assert realise(field, first.seed).obstacles == first.obstacles, "its seed tells which it was"


# --- Navigation-v0


def test_a_twist_is_held_within_the_robots_acceleration(make: Any) -> None:
    empty = parse_scenario(
        "name: empty\nstart: {position: [2.0, 5.0], heading: 0.0}\ngoal: {position: [2.0, 9.0]}\n"
        "robot: {max_speed: 0.8, max_turn_rate: 1.0, acceleration: 0.5, turn_acceleration: 2.0}\n"
    )
    env = make("fuzzyq_bullet/Navigation-v0", scenario=empty)
    seen, _ = env.reset()
    names = ("left", "middle", "right", "ahead_left", "ahead", "ahead_right")
    assert seen[:6].tolist() == [1.0] * 6, names
    # The goal is 4 m to the left.
    assert seen[6:9] == pytest.approx([0.0, 1.0, 4 / 9], abs=1e-6)
    assert seen[9:].tolist() == [0.0, 0.0]
    halfway = np.array([0.0, 0.0])  # half of the greatest speed, straight on
    for decisions in (1, 2):
        seen, *_ = env.step(halfway)
        assert seen[9] * 0.8 == pytest.approx(0.5 * 0.3 * decisions, abs=0.01)
    seen, *_ = env.step(halfway)
    assert seen[9:] == pytest.approx([0.5, 0.0], abs=0.02)
    for _ in range(8):
        seen, *_ = env.step(np.array([-1.0, 1.0]))  # on the spot, to the left
    assert seen[9:] == pytest.approx([0.0, 1.0], abs=0.03)
    assert seen[7] < 0.99, "the goal is no longer to the left"
    for _ in range(4):
        seen, *_ = env.step(np.array([-1.0, -1.0]))
    assert seen[10] == pytest.approx(-1.0, abs=0.03)


def test_navigation_sees_what_it_faces(make: Any) -> None:
    wall = parse_scenario(
        "name: wall\narena: {size: [4.0, 4.0]}\n"
        "start: {position: [3.3, 2.0], heading: 0.0}\ngoal: {position: [1.0, 2.0]}\n"
    )
    env = make("fuzzyq_bullet/Navigation-v0", scenario=wall)
    seen, _ = env.reset()
    assert seen[:3].tolist() == [1.0] * 3, "nothing towards the goal"
    # 0.7 m to the wall, less the robot's radius and the margin of a detection line.
    assert seen[4] == pytest.approx(0.48, abs=0.003)
    assert seen[3] == pytest.approx(seen[5], abs=1e-6)
    outcome = None
    while outcome is None:
        seen, reward, _, _, info = env.step(np.array([1.0, 0.0]))
        outcome = info["outcome"]
    assert (outcome, info["is_success"]) == ("collision", False)
    assert reward < -29.0
    assert seen[4] < 0.01


def test_navigation_tells_left_from_right(make: Any) -> None:
    along_a_wall = parse_scenario(
        "name: along\narena: {size: [4.0, 4.0]}\n"
        "start: {position: [2.0, 0.7], heading: 0.0}\ngoal: {position: [0.5, 0.7]}\n"
    )
    seen, _ = make("fuzzyq_bullet/Navigation-v0", scenario=along_a_wall).reset()
    left, middle, right, ahead_left, ahead, ahead_right = seen[:6].tolist()
    # The wall is to the right of where the robot faces, and to the left of the way to the goal.
    assert ahead_right < ahead_left == ahead == 1.0
    assert left == pytest.approx(ahead_right)
    assert middle == right == 1.0


def test_a_drive_of_navigation_can_be_kept_and_filmed(make: Any, room: Scenario) -> None:
    env = make("fuzzyq_bullet/Navigation-v0", scenario=with_options(room, drive="kinematic"))
    env.reset()
    with pytest.raises(ValueError, match="not over"):
        env.record()
    ended = False
    while not ended:
        _, _, ended, _, _ = env.step(np.array([1.0, 0.01]))
    record = env.record()
    assert record.scenario.drive == "wheels"
    assert record.outcome == "goal"
    assert record.decisions.step.max() == pytest.approx(0.6 * 0.3)
    assert np.isfinite(record.decisions.lengths).all()
    assert np.isnan(record.decisions.rules).all()


def test_a_twist_needs_wheels_and_stays_within_the_robots_limits(room: Scenario) -> None:
    told = Decision(heading=0.0, step=0.1)
    with World(room.obstacles, room.arena) as world:
        episode = Episode(world, room)
        for _ in range(20):
            episode.steer(Twist(9.0, 0.0), told)
        assert episode.now.speed == pytest.approx(room.robot.max_speed, abs=0.01)
        point = Episode(world, with_options(room, drive="kinematic"))
        with pytest.raises(ValueError, match="needs the drive wheels, not kinematic"):
            point.steer(Twist(0.1, 0.0), told)


# --- Weights-v0


@pytest.mark.slow
@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_constant_weights_are_the_improved_planner(drive: str, make: Any) -> None:
    settings = {"name": "improved-fuzzy", "weights": (1.25, 0.75), "turn_unit": 0.8}
    trap = realise(load_scenario("u-shape")).model_dump()
    scenario = Scenario.model_validate({**trap, "planner": settings, "drive": drive})
    env = make("fuzzyq_bullet/Weights-v0", scenario=scenario, drive=drive)
    env.reset()
    ended, modes = False, set()
    while not ended:
        seen, _, ended, _, _ = env.step(np.array([0.25, -0.25]))
        modes.add(tuple(seen[12:].tolist()))
    assert env.record().digest() == fuzzyq_bullet.run(scenario).digest()
    assert len(modes) > 1
    assert all(sorted(mode) == [0.0, 0.0, 1.0] for mode in modes)


def test_weights_sees_what_the_controller_is_told_and_proposes(make: Any) -> None:
    post = parse_scenario(
        "name: post\nstart: {position: [2.0, 5.0]}\ngoal: {position: [8.0, 5.0]}\n"
        "obstacles: [{shape: cylinder, position: [3.0, 5.2], radius: 0.5}]\n"
    )
    seen, _ = make("fuzzyq_bullet/Weights-v0", scenario=post).reset()
    left, middle, right, distance, difference, turn, stride = seen[:7].tolist()
    assert 0.29 < middle < 0.31  # 0.5 m of post, 0.22 m of robot and margin, and a slant
    assert middle < left < right == 1.0
    assert distance == pytest.approx(middle)
    assert difference == pytest.approx(left - right)
    assert turn < 0.0 < stride, "the right side is freer"
    assert seen[7:10] == pytest.approx([1.0, 0.0, 6 / 11])


# --- Stable-Baselines3


@both
def test_stable_baselines_check_has_nothing_to_say(name: str, make: Any) -> None:
    checker = pytest.importorskip("stable_baselines3.common.env_checker", reason=WITHOUT)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        checker.check_env(make(name, count=5))


def test_the_example_trains(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    pytest.importorskip("stable_baselines3", reason=WITHOUT)
    spec = importlib.util.spec_from_file_location("train_sb3", ROOT / "examples" / "train_sb3.py")
    assert spec is not None
    assert spec.loader is not None
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    saved = tmp_path / "policy.zip"
    example.main(["--steps", "32", "--count", "5", "--episodes", "1", "--out", str(saved)])
    before, after, last = capsys.readouterr().out.splitlines()
    assert before.startswith("before: goal reached in ")
    assert after.startswith("after 32 steps: goal reached in ")
    assert last == f"saved to {saved}"
    assert saved.stat().st_size > 0
