"""Training: the same from the same seed, however often it is interrupted, killed and resumed."""

from __future__ import annotations

import io
import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from examples.exercises import CliffWalk, Corridor, RandomWalk
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.learning import (
    FuzzyQLambda,
    QLambda,
    QLearning,
    Schedule,
    Setup,
    episode_rng,
    train,
)
from fuzzyq_bullet.learning.checkpoint import Checkpoint, Curve
from fuzzyq_bullet.learning.learners import Floats

SETUP = Setup(
    30, seed=7, rate=Schedule(0.3), trace_decay=Schedule(0.8), max_steps=60, random_ties=True
)


def learner() -> QLambda:
    return QLambda(48, 4)


def whole() -> tuple[bytes, bytes]:
    """The table and curve of a training that nothing interrupts."""
    one = learner()
    curve = train(CliffWalk(), one, SETUP)
    return one.table.tobytes(), curve.tobytes()


class MixedWalk:
    """A random walk between 5 places, in each of which 3 rules fire to some degree."""

    def __init__(self, seed: int = 0) -> None:
        self._walk = RandomWalk(5, seed=seed)

    def reset(self, episode: int, /) -> Floats:
        return self.firing(self._walk.reset(episode))

    def step(self, actions: tuple[int, ...], /) -> tuple[Floats, float, bool]:
        place, reward, over = self._walk.step(actions[0])
        return self.firing(place), reward, over

    @property
    def outcome(self) -> str:
        return self._walk.outcome

    @staticmethod
    def firing(place: int) -> Floats:
        right = place / 4
        return np.array([max(0.0, 1 - 2 * right), 1 - abs(1 - 2 * right), max(0, 2 * right - 1)])


# The same again


def test_the_same_seed_gives_the_same_table_and_another_seed_another() -> None:
    table, curve = whole()
    assert (table, curve) == whole()
    one = learner()
    train(CliffWalk(), one, replace(SETUP, seed=8))
    assert one.table.tobytes() != table


def test_an_episode_s_chance_depends_on_seed_episode_and_stream_alone() -> None:
    def draw(seed: int, episode: int, stream: int) -> bytes:
        return episode_rng(seed, episode, stream).bytes(8)

    assert draw(1, 2, 0) == draw(1, 2, 0)
    others = {draw(s, e, k) for s in range(3) for e in range(3) for k in range(3)}
    assert len(others) == 27


def test_the_curve_tells_each_episode() -> None:
    told: list[int] = []
    curve = train(
        Corridor(4),
        QLearning(4, 2),
        Setup(20, exploration=Schedule(0.0), max_steps=50),
        on_episode=lambda so_far: told.append(len(so_far)),
    )
    assert told == list(range(1, 21))
    assert (curve["total"] == -curve["steps"]).all()
    assert (curve["outcome"] == b"door").all()
    assert curve["steps"].min() == 4


def test_rules_are_trained_as_tables_are() -> None:
    one = FuzzyQLambda(3, 1, discount=1.0)
    train(MixedWalk(), one, Setup(1000, rate=Schedule(0.2, 0.1995), trace_decay=Schedule(0.5)))
    values = [one.best(MixedWalk.firing(place)) for place in range(5)]
    assert values == pytest.approx([1 / 6, 2 / 6, 3 / 6, 4 / 6, 5 / 6], abs=0.06)


# An end that is none


class Treadmill:
    """One place, −1 a step, no end."""

    outcome = "walking"

    def reset(self, episode: int, /) -> int:
        return 0

    def step(self, action: int, /) -> tuple[int, float, bool]:
        return 0, -1.0, False


def test_an_episode_cut_short_still_counts_what_would_have_come() -> None:
    one = QLearning(1, 1, discount=0.5)
    curve = train(Treadmill(), one, Setup(20, rate=Schedule(1.0), max_steps=3))
    assert one.table == pytest.approx(-2.0)  # −1 / (1 − ξ); were it an end, −1.75
    assert set(curve["steps"].tolist()) == {3}


# Interrupted


class Interrupted(CliffWalk):
    """Ctrl-C in the middle of an episode."""

    def __init__(self, episode: int) -> None:
        super().__init__()
        self._fatal, self._episode, self._steps = episode, 0, 0

    def reset(self, episode: int, /) -> int:
        self._episode, self._steps = episode, 0
        return super().reset(episode)

    def step(self, action: int, /) -> tuple[int, float, bool]:
        self._steps += 1
        if self._episode == self._fatal and self._steps == 9:
            raise KeyboardInterrupt
        return super().step(action)


def test_interrupted_in_the_middle_of_episodes_it_ends_in_the_same_table(tmp_path: Path) -> None:
    path = tmp_path / "training.npz"
    for fatal in (1, 2, 2, 17, 30):
        with pytest.raises(KeyboardInterrupt):
            train(Interrupted(fatal), learner(), SETUP, checkpoint=path, resume=True)
        assert len(Checkpoint.load(path).curve) == fatal - 1  # only the running one is lost
    one = learner()
    curve = train(CliffWalk(), one, SETUP, checkpoint=path, resume=True)
    assert (one.table.tobytes(), curve.tobytes()) == whole()
    assert os.listdir(tmp_path) == ["training.npz"]  # noqa: PTH208


def test_what_is_told_is_safe_already(tmp_path: Path) -> None:
    path = tmp_path / "training.npz"

    def stop(curve: Curve) -> None:
        if len(curve) == 5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        train(CliffWalk(), learner(), SETUP, checkpoint=path, on_episode=stop)
    assert len(Checkpoint.load(path).curve) == 5


def test_rules_too_are_resumed_to_the_same_table(tmp_path: Path) -> None:
    path = tmp_path / "training.npz"
    setup = Setup(20, trace_decay=Schedule(0.9))
    expected = FuzzyQLambda(3, 1)
    train(MixedWalk(), expected, setup)

    def stop(curve: Curve) -> None:
        if len(curve) == 11:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        train(MixedWalk(), FuzzyQLambda(3, 1), setup, checkpoint=path, on_episode=stop)
    one = FuzzyQLambda(3, 1)
    train(MixedWalk(), one, setup, checkpoint=path, resume=True)
    assert one.table.tobytes() == expected.table.tobytes()


class Slow(CliffWalk):
    """A training of a second or more."""

    def step(self, action: int, /) -> tuple[int, float, bool]:
        time.sleep(0.001)
        return super().step(action)


KILLED = f"""
import sys
from pathlib import Path
from {__name__} import SETUP, Slow, learner, train
train(Slow(), learner(), SETUP, checkpoint=Path(sys.argv[1]), resume=True)
"""


@pytest.mark.slow
def test_killed_again_and_again_it_ends_in_the_same_table(tmp_path: Path) -> None:
    path = tmp_path / "training.npz"
    script = tmp_path / "train.py"
    script.write_text(KILLED)
    found = (str(Path(__file__).parents[2]), os.environ.get("PYTHONPATH", ""))
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(found)}
    finished = -1  # the first writes a checkpoint of none
    for more in (1, 5):
        with subprocess.Popen([sys.executable, script, path], env=env) as process:
            while process.poll() is None and (
                not path.exists() or len(Checkpoint.load(path).curve) < finished + more
            ):
                time.sleep(0.005)
            process.kill()
        assert process.returncode == -signal.SIGKILL
        finished = len(Checkpoint.load(path).curve)
    assert 5 <= finished < 30
    one = learner()
    curve = train(CliffWalk(), one, SETUP, checkpoint=path, resume=True)
    assert (one.table.tobytes(), curve.tobytes()) == whole()


def test_a_finished_training_is_not_trained_on(tmp_path: Path) -> None:
    path = tmp_path / "training.npz"
    train(CliffWalk(), learner(), SETUP, checkpoint=path)
    one = learner()
    told: list[Curve] = []
    curve = train(CliffWalk(), one, SETUP, checkpoint=path, resume=True, on_episode=told.append)
    assert (one.table.tobytes(), curve.tobytes()) == whole()
    assert not told


# Mistakes


def test_another_training_s_checkpoint_is_refused_naming_what_differs(tmp_path: Path) -> None:
    path = tmp_path / "training.npz"
    short = Setup(2, max_steps=5)
    train(CliffWalk(), learner(), short, checkpoint=path, made={"drive": "wheels"})
    for other, one, made, complaint in (
        (Setup(3, max_steps=5), learner(), "wheels", "episodes was 2 and is 3 now"),
        (Setup(2, seed=1, max_steps=5), learner(), "wheels", "seed was 0 and is 1 now"),
        (short, QLambda(48, 4, discount=0.5), "wheels", "discount was 0.95 and is 0.5 now"),
        (short, QLambda(48, 4, kind="replacing"), "wheels", "traces was accumulating and is repl"),
        (short, QLearning(48, 4, discount=0.95), "wheels", "learner was q-lambda and is q-learn"),
        (short, QLambda(49, 4), "wheels", r"shape \(48, 4\)"),
        (short, learner(), "kinematic", "drive was wheels and is kinematic now"),
    ):
        with pytest.raises(UserError, match=complaint) as caught:
            train(CliffWalk(), one, other, checkpoint=path, resume=True, made={"drive": made})
        assert str(caught.value).startswith(str(path))
        assert len(caught.value.problems) == 1


def archive(**arrays: NDArray[Any]) -> bytes:
    content = io.BytesIO()
    np.savez(content, **arrays)
    return content.getvalue()


def head(**changes: object) -> NDArray[Any]:
    text = json.dumps({"format": 1, "plan": {"episodes": 2}, **changes})
    return np.frombuffer(text.encode(), np.uint8)


CURVE_ROW = np.dtype([("total", "<f8"), ("steps", "<i4"), ("outcome", "S16")])
TABLE, CURVE = np.zeros((48, 4)), np.zeros(1, CURVE_ROW)
NAN = np.full((48, 4), np.nan)
NOT_CHECKPOINTS = {
    "empty": b"",
    "text": b"hello",
    "junk": bytes(range(256)) * 20,
    "truncated": archive(head=head(), table=TABLE, curve=CURVE)[:900],
    "no head": archive(table=TABLE, curve=CURVE),
    "no table": archive(head=head(), curve=CURVE),
    "format": archive(head=head(format=2), table=TABLE, curve=CURVE),
    "plan": archive(head=head(plan=[1]), table=TABLE, curve=CURVE),
    "head a list": archive(head=np.frombuffer(b"[1]", np.uint8), table=TABLE, curve=CURVE),
    "deep": archive(head=np.frombuffer(b"[" * 100_000, np.uint8), table=TABLE, curve=CURVE),
    "table of text": archive(head=head(), table=np.array([["a"]]), curve=CURVE),
    "flat table": archive(head=head(), table=np.zeros(4), curve=CURVE),
    "NaN": archive(head=head(), table=NAN, curve=CURVE),
    "curve": archive(head=head(), table=TABLE, curve=np.zeros(3)),
}


@pytest.mark.parametrize("content", NOT_CHECKPOINTS.values(), ids=NOT_CHECKPOINTS.keys())
def test_what_is_no_checkpoint_is_refused_in_a_line(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "training.npz"
    path.write_bytes(content)
    with pytest.raises(UserError) as caught:
        Checkpoint.load(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)
    with pytest.raises(UserError):
        train(CliffWalk(), learner(), SETUP, checkpoint=path, resume=True)
    assert path.read_bytes() == content


def test_a_checkpoint_of_too_many_episodes_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "training.npz"
    setup = Setup(2, max_steps=5)
    train(CliffWalk(), learner(), setup, checkpoint=path)
    saved = Checkpoint.load(path)
    Checkpoint(saved.plan, saved.table, np.repeat(saved.curve, 2)).save(path)
    with pytest.raises(UserError, match="more episodes"):
        train(CliffWalk(), learner(), setup, checkpoint=path, resume=True)


@pytest.mark.parametrize(
    ("name", "resume"),
    [("missing/t.npz", False), ("missing/t.npz", True), ("", False), ("", True), ("x" * 300, True)],
)
def test_a_place_that_cannot_be_written_is_told_before_anything_is_learned(
    tmp_path: Path, name: str, resume: bool
) -> None:
    class Untouched(CliffWalk):
        def reset(self, episode: int, /) -> int:
            raise AssertionError

    with pytest.raises(UserError, match=str(tmp_path)) as caught:
        train(Untouched(), learner(), SETUP, checkpoint=tmp_path / name, resume=resume)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "wrong",
    [{"episodes": 0}, {"episodes": -5}, {"episodes": 10**9}, {"seed": -1}, {"max_steps": 0}],
)
def test_a_setup_that_cannot_be_is_refused(wrong: dict[str, int]) -> None:
    with pytest.raises(UserError, match=next(iter(wrong))):
        Setup(**wrong)  # type: ignore[arg-type]


class Paying(Treadmill):
    """Pays whatever it is told to."""

    def __init__(self, reward: float, outcome: str = "walking") -> None:
        self.reward, self.outcome = reward, outcome

    def step(self, action: int, /) -> tuple[int, float, bool]:
        return 0, self.reward, False


class Waiting(Treadmill):
    """Twenty steps on the spot, then an end that pays 1."""

    def reset(self, episode: int, /) -> int:
        self.left = 20
        return 0

    def step(self, action: int, /) -> tuple[int, float, bool]:
        self.left -= 1
        over = self.left == 0
        return 0, float(over), over


def test_learning_that_diverges_is_told(tmp_path: Path) -> None:
    path = tmp_path / "training.npz"
    # The trace adds up to 20, so the last error is not mended but made twenty times as large.
    setup = Setup(50, rate=Schedule(1.0), trace_decay=Schedule(1.0))
    with pytest.raises(UserError, match="diverges") as caught:
        train(Waiting(), QLambda(1, 1, discount=1.0), setup, checkpoint=path)
    saved = Checkpoint.load(path)
    assert str(caught.value).startswith(f"episode {len(saved.curve) + 1}: ")
    # Replacing traces do not.
    train(Waiting(), QLambda(1, 1, discount=1.0, kind="replacing"), setup)


def test_a_problem_that_pays_or_says_nonsense_is_told() -> None:
    for problem, complaint in (
        (Paying(float("nan")), "rewards"),
        (Paying(float("inf")), "rewards"),
        (Paying(1.0, "far too long an outcome"), "outcome"),
    ):
        with pytest.raises(ValueError, match=complaint):
            train(problem, QLearning(1, 1), Setup(1, max_steps=2))
