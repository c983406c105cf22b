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
from fuzzyq_bullet.planning.learned_exits import (
    Choice,
    LearnedExits,
    names_of,
    rows_of,
    seconds_of,
)
from fuzzyq_bullet.scenario import Scenario, Start, dump_scenario, random_task, realise
from fuzzyq_bullet.training.field import FieldMemory, FieldTask, field_setup, learn_field
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
            task, field_setup(RUNS, 0), command=command, checkpoint=checkpoint, on_episode=end
        )
    assert len(Checkpoint.load(checkpoint).curve) == 3
    policy, _ = learn_field(
        task, field_setup(RUNS, 0), command=command, checkpoint=checkpoint, resume=True
    )
    assert policy.dumps() == learned.read_text()
    other = FieldTask(task.scenario.model_copy(update={"start": Start(position=(5.0, 5.0))}))
    with pytest.raises(UserError, match="belongs to another training: tasks was"):
        learn_field(
            other, field_setup(RUNS, 0), command=command, checkpoint=checkpoint, resume=True
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
    costs = exits.judge(seen, points, ways, lambda: [3.6, 6.0])
    assert costs == pytest.approx([2.0 + 50.0, 4.0 + 10.0])  # at 0.6 m/s
    assert exits.choices == [Choice(3.0, (0, 4), costs[1], 10.0)]
    # What is walled in stays so, whatever was learned of its place.
    assert exits.judge(seen, points, ways, lambda: [1000.0, 6.0])[0] > 1000.0


def test_what_came_after_a_choice_is_learned_backwards() -> None:
    memory = FieldMemory()
    first, second = Choice(0.0, (0, 0), 10.0, 8.0), Choice(6.0, (1, 1), 12.0, 9.0)
    memory.learn([first, second], end=20.0, rate=0.5, trace=0.5)
    late = 14.0 - 12.0  # than it seemed at the second choice
    early = 6.0 + 0.5 * 12.0 + 0.5 * 14.0 - 10.0
    assert memory.seconds == pytest.approx({(1, 1): 9.0 + 0.5 * late, (0, 0): 8.0 + 0.5 * early})


def test_without_traces_a_choice_learns_from_the_next_alone() -> None:
    memory = FieldMemory()
    first, second = Choice(0.0, (0, 0), 10.0, 8.0), Choice(6.0, (1, 1), 12.0, 9.0)
    memory.learn([first, second], end=500.0, rate=1.0, trace=0.0)
    assert memory.seconds[0, 0] == 8.0 + (6.0 + 12.0 - 10.0)


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
