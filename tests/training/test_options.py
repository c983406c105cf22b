"""Schedules, discount and reward as a user asks for them, and rewards of a user's own."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.learning import Setup
from fuzzyq_bullet.physics.robot import RobotState
from fuzzyq_bullet.training import rewards
from fuzzyq_bullet.training.options import LearningOptions, read_options
from fuzzyq_bullet.training.rewards import USUAL, RewardSettings, Transition, register_reward

UNIT = st.floats(0.0, 1.0)


def step(seconds: float = 1.0, nearer: float = 0.3, outcome: str | None = None) -> Transition:
    before, after = (RobotState(t, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0) for t in (1.0, 1.0 + seconds))
    return Transition(before, after, nearer, 0.6, outcome)  # type: ignore[arg-type]


@given(UNIT, UNIT, UNIT, UNIT, st.floats(0.0, 100.0))
def test_what_is_asked_for_is_written_out_so_that_it_is_asked_for_again(
    start: float, end: float, trace: float, discount: float, hit: float
) -> None:
    asked = LearningOptions.parse(
        {
            "rate": f"{start!r}:{end!r}",
            "trace": str(trace),
            "discount": str(discount),
            "reward": f"hit={hit!r}",
        }
    )
    words = shlex.split(shlex.join(asked.words()))
    again = {
        name.removeprefix("--"): text for name, text in zip(words[::2], words[1::2], strict=True)
    }
    assert LearningOptions.parse(again) == asked
    setup = asked.setup(Setup(episodes=100))
    assert setup.rate.at(0, 100) == start
    assert setup.rate.at(100, 100) == pytest.approx(end)
    assert setup.trace_decay.at(7, 100) == trace
    assert setup.exploration == Setup().exploration  # which was not asked for


def test_a_reward_in_parts_counts_what_it_is_told_to() -> None:
    assert USUAL.of(step()).total == pytest.approx(-1.0 + 0.5)
    assert USUAL.of(step(outcome="collision")).total == pytest.approx(-0.5 - 30.0)
    assert USUAL.of(step(outcome="timeout")).total == pytest.approx(-0.5 - 10.0)
    sparse = RewardSettings.parse("progress=0,hit=7")
    assert sparse.of(step(outcome="collision")).total == -1.0 - 7.0
    assert str(sparse) == "hit=7,given_up=10,progress=0"


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("trace", "2", "--trace: a schedule must stay between 0 and 1"),
        ("trace", "0.5:0.1:0.2", "--trace: expected a number from 0 to 1, or two with a colon"),
        ("rate", "nan", "--rate: expected a number"),
        ("discount", "1.5", "--discount: must be a number from 0 to 1, got '1.5'"),
        ("reward", "hti=3", "--reward: 'hti': no part of the reward; did you mean 'hit'"),
        ("reward", "hit=3, hit=4", "--reward: hit: is given twice"),
        ("reward", "hit=inf", "--reward: hit: must be a number from 0 to"),
        ("reward", "kind", "--reward: no reward 'kind'; .* --plugin"),
    ],
)
def test_what_cannot_be_asked_for_is_one_line_that_names_it(
    name: str, text: str, words: str
) -> None:
    with pytest.raises(UserError, match=words) as caught:
        LearningOptions.parse({name: text})
    assert len(caught.value.problems) == 1


def test_a_file_says_the_same_as_the_command_line(tmp_path: Path) -> None:
    path = tmp_path / "how.yaml"
    path.write_text("episodes: 30\nseed: 4\ntrace: 0.9\nepsilon: [0.5, 0.1]\nreward: {hit: 40}\n")
    options, plain, places = read_options(path)
    assert plain == {"episodes": 30, "seed": 4}
    assert places["seed"] == f"{path}:2: seed"
    assert options == LearningOptions.parse(
        {"trace": "0.9", "epsilon": "0.5:0.1", "reward": "hit=40"}
    )
    changed = options.changed_by(LearningOptions.parse({"trace": "0.1"}))
    assert changed.words()[:4] == ["--trace", "0.1", "--epsilon", "0.5:0.1"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("episodes: 3\ntrce: 1\n", r"how.yaml:2: trce: unknown key; did you mean 'trace'"),
        ("\ntrace: much\n", r"how.yaml:2: trace: expected a number"),
        ("episodes: many\n", r"how.yaml:1: episodes: expected a whole number, got 'many'"),
        ("episodes: true\n", r"how.yaml:1: episodes: expected a whole number"),
        ("trace:\n", r"how.yaml:1: trace: expected a number, text, or numbers in"),
        ("discount: true\n", r"how.yaml:1: discount: expected a number, text, or"),
        ("reward: {hit: '3,progress=0'}\n", r"how.yaml:1: reward: expected a number, text, or"),
        ("", r"how.yaml: is empty; it may have the keys rate"),
        ("- 1\n", r"how.yaml:1: expected a mapping"),
    ],
)
def test_a_mistake_in_the_file_is_named_with_its_line(
    text: str, words: str, tmp_path: Path
) -> None:
    path = tmp_path / "how.yaml"
    path.write_text(text)
    with pytest.raises(UserError, match=words):
        read_options(path)


def test_a_reward_of_ones_own_that_goes_wrong_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rewards, "REWARDS", {})
    register_reward("lost")(lambda step: float("nan"))
    register_reward("broken")(lambda step: 1 / 0)
    with pytest.raises(ValueError, match="'lost'"):
        register_reward("lost")
    with pytest.raises(ValueError, match="'hit=3'"):
        register_reward("hit=3")
    with pytest.raises(UserError, match="reward lost: returned nan at 2 s; a number from"):
        RewardSettings.parse("lost").of(step())
    with pytest.raises(UserError, match="reward broken: stopped by ZeroDivisionError"):
        RewardSettings.parse("broken").of(step())
