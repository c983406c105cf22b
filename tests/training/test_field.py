"""Learning a field: every run is safe, the fastest is kept, and it is driven again exactly."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyq_bullet import UserError, load_scenario, run
from fuzzyq_bullet.cli import app
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.learning import load_policy
from fuzzyq_bullet.learning.checkpoint import Checkpoint
from fuzzyq_bullet.planning.escape.exploration import WaysOut
from fuzzyq_bullet.planning.escape.learned_exits import (
    Choice,
    LearnedExits,
    names_of,
    rows_of,
    seconds_of,
)
from fuzzyq_bullet.scenario import Limits, Scenario, Start, dump_scenario, random_task, realise
from fuzzyq_bullet.scenario.fields import field_digest
from fuzzyq_bullet.training.field import FieldMemory, FieldTask, field_setup, learn_field
from tests.helpers.commands import Call
from tests.helpers.exploring import observe

RUNS = 6


def a_field() -> Scenario:
    """A field in which the first way out that looks good is not the best."""
    return realise(random_task(9004, count=75)).model_copy(update={"drive": "kinematic"})


@pytest.fixture(scope="module")
def field_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("field") / "field.yaml"
    path.write_text(dump_scenario(a_field()))
    return path


@pytest.fixture(scope="module")
def learned(field_file: Path) -> Path:
    """What was learned in it; not to be changed."""
    policy = field_file.with_name("learned.json")
    assert call("train", "fuzzy-q-lambda", "--scenario", field_file, "--episodes", RUNS,
                "--out", policy) == 0  # fmt: skip
    return policy


def call(*args: object) -> int:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["fuzzyq", *map(str, args)])
        return app.call()


def using(field_file: Path, policy: Path, **changes: object) -> Path:
    """Write the field's scenario again, driven with a policy."""
    told = load_scenario(field_file, policies=False).model_dump(mode="json", exclude_none=True)
    told |= {"planner": {"name": "fuzzy-q-lambda", "policy": str(policy)}, **changes}
    path = policy.with_name("using.yaml")
    path.write_text(json.dumps(told))
    return path


def test_the_fastest_run_is_kept_and_driven_again_exactly(field_file: Path, learned: Path) -> None:
    curve = Checkpoint.load(learned.with_name("learned.checkpoint.npz")).curve
    assert len(curve) == RUNS
    assert set(curve["outcome"]) == {b"goal"}
    made = load_policy(learned).parameters
    assert made["first_s"] == -curve["total"][0] > made["fastest_s"] == -curve["total"].max()
    driven = run(load_scenario(using(field_file, learned)))
    assert driven.outcome == "goal"
    assert driven.ticks.time[-1] == made["fastest_s"]
    # The first run is that of a robot which has learned nothing yet.
    assert run(load_scenario(field_file)).ticks.time[-1] == made["first_s"]


def test_the_same_training_gives_the_same_bytes_and_goes_on_where_it_was(
    field_file: Path, learned: Path, tmp_path: Path
) -> None:
    task, checkpoint = FieldTask(realise(load_scenario(field_file))), tmp_path / "c.npz"
    command = load_policy(learned).command

    class EndedError(Exception):
        pass

    def end(curve: np.ndarray) -> None:
        if len(curve) == 3:
            raise EndedError

    with pytest.raises(EndedError):
        learn_field(
            task, field_setup(RUNS, 9004), command=command, checkpoint=checkpoint, on_episode=end
        )
    assert len(Checkpoint.load(checkpoint).curve) == 3
    policy, _ = learn_field(
        task, field_setup(RUNS, 9004), command=command, checkpoint=checkpoint, resume=True
    )
    assert policy.dumps() == learned.read_text()
    other = FieldTask(task.scenario.model_copy(update={"start": Start(position=(5.0, 5.0))}))
    with pytest.raises(UserError, match="belongs to another training: run was"):
        learn_field(
            other, field_setup(RUNS, 9004), command=command, checkpoint=checkpoint, resume=True
        )


def test_what_was_learned_in_another_field_is_one_line(
    field_file: Path, learned: Path, tmp_path: Path
) -> None:
    mine = tmp_path / "mine.json"
    mine.write_text(learned.read_text())
    for changes in (
        {"goal": {"position": [5.0, 5.0]}},
        {"robot": {"max_speed": 0.5}},
        {"obstacles": []},
    ):
        path = using(field_file, mine, **changes)
        with pytest.raises(UserError) as caught:
            load_scenario(path)
        [line] = caught.value.problems
        assert line.startswith(f"{path}:")
        assert "planner.policy" in line
        assert "was learned in another field" in line
    # Who drives there, from where and for how long is of no matter.
    path = using(field_file, mine, start={"position": [5.0, 5.2]}, limits={"time": 30.0})
    assert load_scenario(path).limits.time == 30.0


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"states": ["elsewhere", *(f"x{k}" for k in range(100))]}, "is no place"),
        ({"states": [f"{k} {k}" for k in range(101)]}, "states begin with '0 0'"),
        ({"actions": ["metres"]}, "actions with 'metres'"),
        ({"table": -1.0}, "no time is less than 0, got -1"),
    ],
)
def test_a_policy_of_a_field_that_cannot_be_used_is_one_line(
    changes: dict[str, object], words: str, learned: Path, tmp_path: Path
) -> None:
    data = json.loads(learned.read_text())
    rows = 101
    data |= {"states": ["elsewhere", *(f"{k} {-k}" for k in range(rows - 1))]}
    data |= {"table": [[0.0]] * rows}
    changes = {"table": [[0.0]] + [[-1.0]] * (rows - 1)} if "table" in changes else changes
    path = tmp_path / "bad.json"
    path.write_text(json.dumps({**data, **changes}))
    with pytest.raises(UserError) as caught:
        seconds_of(load_policy(path), str(path))
    [line] = caught.value.problems
    assert line.startswith(f"{path}: ")
    assert words in line


@pytest.mark.parametrize("option", ["--epsilon", "--discount", "--reward"])
def test_what_a_field_is_learned_without_is_refused(option: str, field_file: Path) -> None:
    value = "hit=3" if option == "--reward" else "0.5"
    with pytest.raises(UserError) as caught:
        call("train", "fuzzy-q-lambda", "--scenario", field_file, option, value)
    assert caught.value.problems[0].startswith(f"{option}: ")
    assert "--rate and --trace" in caught.value.problems[0]


def test_a_place_that_was_learned_counts_and_another_looks_as_it_did() -> None:
    exits = LearnedExits({(4, 0): 50.0})
    seen = observe(Field(), (0.0, 0.0), goal=(6.0, 0.0), time=3.0)
    points, ways = [(2.2, 0.2), (0.0, 2.2)], [1.2, 2.4]
    costs = exits.judge(WaysOut(seen, points, ways, lambda: [3.6, 6.0]))
    assert costs == pytest.approx([2.0 + 50.0, 4.0 + 10.0])  # at 0.6 m/s
    assert exits.choices == [Choice(3.0, (0, 4), costs[1], 10.0)]
    # What is walled in stays so, whatever was learned of its place.
    assert exits.judge(WaysOut(seen, points, ways, lambda: [1000.0, 6.0]))[0] > 1000.0


def test_what_came_after_a_choice_is_learned_backwards() -> None:
    memory = FieldMemory()
    first, second = Choice(0.0, (0, 0), 10.0, 8.0), Choice(6.0, (1, 1), 12.0, 9.0)
    memory.learn([first, second], 20.0, rate=0.5, trace=0.5)
    late = 14.0 - 12.0  # than it seemed at the second choice
    early = 6.0 + 0.5 * 12.0 + 0.5 * 14.0 - 10.0
    assert memory.seconds == pytest.approx({(1, 1): 9.0 + 0.5 * late, (0, 0): 8.0 + 0.5 * early})


def test_without_traces_a_choice_learns_from_the_next_alone() -> None:
    memory = FieldMemory()
    first, second = Choice(0.0, (0, 0), 10.0, 8.0), Choice(6.0, (1, 1), 12.0, 9.0)
    memory.learn([first, second], 500.0, rate=1.0, trace=0.0)
    assert memory.seconds[0, 0] == 8.0 + (6.0 + 12.0 - 10.0)


@given(
    st.lists(st.tuples(st.floats(0.1, 9.0), st.floats(1.0, 99.0), st.floats(0.0, 1.0)), min_size=1)
)
def test_where_a_run_did_not_arrive_no_exit_looks_better_than_before(
    chosen: list[tuple[float, float, float]],
) -> None:
    choices, time = [], 0.0
    for k, (later, seems, share) in enumerate(chosen):
        time += later
        choices.append(Choice(time, (k, 0), seems, share * seems))
    memory = FieldMemory()
    memory.learn(choices, time + 1.0, ahead=100.0, rate=0.3, trace=1.0)
    assert all(memory.seconds[one.place] >= one.beyond for one in choices)


def test_a_run_that_times_out_is_worth_its_limit_and_more(field_file: Path, tmp_path: Path) -> None:
    scenario = realise(load_scenario(field_file))
    hurried = scenario.model_copy(update={"limits": Limits(time=8.0)})
    policy, curve = learn_field(FieldTask(hurried), field_setup(2, 0), command="")
    assert set(curve["outcome"]) == {b"timeout"}
    assert curve["total"].tolist() == [-8.0, -8.0]
    assert policy.parameters["fastest_run"] is policy.parameters["first_s"] is None
    assert policy.states == ("elsewhere",)


def test_a_finished_training_is_not_replaced_by_that_of_another_start(
    field_file: Path, learned: Path, tmp_path: Path
) -> None:
    mine = tmp_path / "learned.json"
    mine.write_bytes(learned.read_bytes())
    told = load_scenario(field_file).model_dump(mode="json", exclude_none=True)
    file = tmp_path / field_file.name
    file.write_text(json.dumps({**told, "limits": {"time": 9.0}}))
    with pytest.raises(UserError, match="is there already, and not of this training"):
        call("train", "fuzzy-q-lambda", "--scenario", file, "--episodes", RUNS, "--out", mine)
    assert mine.read_bytes() == learned.read_bytes()


def test_the_seed_says_where_the_obstacles_of_the_field_lie(tmp_path: Path) -> None:
    file = tmp_path / "drawn.yaml"
    file.write_text(
        "name: drawn\nseed: 3\nstart: {position: [1, 1]}\ngoal: {position: [9, 9]}\n"
        "drive: kinematic\nrandom: {count: 20}\n"
    )
    for seed in (3, 4):
        asked = () if seed == 3 else ("--seed", seed)
        call("train", "fuzzy-q-lambda", "--scenario", file, "--episodes", 1, *asked,
             "--out", tmp_path / f"{seed}.json")  # fmt: skip
        policy = load_policy(tmp_path / f"{seed}.json")
        assert f"--seed {seed}" in policy.command
        assert policy.scenario == field_digest(realise(load_scenario(file), seed))
    with pytest.raises(UserError, match=r"learned in another field.* --seed 3"):
        load_scenario(using(file, tmp_path / "4.json"))


@pytest.mark.parametrize("off", ["breakout", "following"])
def test_without_ways_out_what_was_learned_of_them_is_refused(
    off: str, field_file: Path, learned: Path, tmp_path: Path
) -> None:
    mine = tmp_path / "mine.json"
    mine.write_bytes(learned.read_bytes())
    planner = {"name": "fuzzy-q-lambda", "policy": str(mine), off: False}
    with pytest.raises(UserError, match="leave breakout and following on"):
        load_scenario(using(field_file, mine, planner=planner))


@pytest.mark.parametrize("command", [("explain", "--policy"), ("figure", "weights")])
def test_who_asks_for_the_weights_of_rules_is_told_that_there_are_none(
    command: tuple[str, ...], learned: Path
) -> None:
    with pytest.raises(UserError) as caught:
        call(*command, learned)
    [line] = caught.value.problems
    assert line == f"{learned}: tells what the ways out of a field are worth, not how rules weigh"


def test_by_default_the_files_are_called_by_planner_and_field(
    field_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    call("train", "fuzzy-q-lambda", "--scenario", field_file, "--episodes", 1)
    assert (tmp_path / "out/train/fuzzy-q-lambda-scatter-9004.json").exists()


@pytest.mark.slow
def test_the_fastest_run_is_driven_again_in_physics_in_another_process(
    field_file: Path, tmp_path: Path, fuzzyq: Call
) -> None:
    policy = tmp_path / "wheels.json"
    call("train", "fuzzy-q-lambda", "--scenario", field_file, "--episodes", 3, "--drive", "wheels",
         "--out", policy)  # fmt: skip
    file = using(field_file, policy, drive="wheels")
    done = fuzzyq("run", file, "--no-video", "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["time_s"] == load_policy(policy).parameters["fastest_s"]


@given(
    st.dictionaries(
        st.tuples(st.integers(-99, 99), st.integers(-99, 99)), st.floats(0.0, 1e4), max_size=20
    ),
    st.dictionaries(
        st.tuples(st.integers(-99, 99), st.integers(-99, 99)), st.floats(0.0, 1e4), max_size=20
    ),
)
def test_a_memory_reads_back_from_its_table(
    seconds: dict[tuple[int, int], float], kept: dict[tuple[int, int], float]
) -> None:
    memory = FieldMemory(seconds, 12.5, kept)
    curve = np.array([(-30.0, 1, b"goal"), (-12.5, 1, b"goal"), (-3.0, 1, b"stuck")],
                     [("total", "<f8"), ("steps", "<i4"), ("outcome", "S16")])  # fmt: skip
    assert FieldMemory.of_table(memory.as_table(), curve) == memory
    assert len(names_of(seconds)) == len(rows_of(seconds)) == 1 + len(seconds)
