"""``fuzzyq train``: the same policy in the end whatever happens on the way, or one line."""

from __future__ import annotations

import json
import os
import runpy
import shlex
import signal
import subprocess
import sys
import time
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from PIL import Image

from fuzzyq_bullet import Trajectory, UserError, load_scenario, result_of, run, with_options
from fuzzyq_bullet.cli import app
from fuzzyq_bullet.figures.learning_curve import MARKS, picture
from fuzzyq_bullet.learning import load_policy
from fuzzyq_bullet.learning.checkpoint import ROW, Checkpoint, Curve, last_mean
from fuzzyq_bullet.planning.policies import shipped
from fuzzyq_bullet.platforms import asset
from fuzzyq_bullet.scenario import dump_scenario, parse_scenario
from fuzzyq_bullet.training.config import SHIPPED, TrainingConfig
from fuzzyq_bullet.training.registry import RECIPES
from fuzzyq_bullet.training.session import TrainingProgress
from tests.helpers.commands import FUZZYQ, Call

PLANNER = "q-lambda"
EPISODES = 12
ASKED = ("train", PLANNER, "--scenario", "open-field", "--episodes", str(EPISODES), "--seed", "5")


class Files(NamedTuple):
    """What a training wrote."""

    policy: Path
    picture: Path
    checkpoint: Path

    @classmethod
    def of(cls, policy: Path) -> Files:
        stem = policy.with_suffix("")
        return cls(policy, Path(f"{stem}.png"), Path(f"{stem}.checkpoint.npz"))

    def done(self) -> int:
        """How many episodes are safe on disk."""
        with suppress(OSError):
            if self.checkpoint.exists():
                return len(Checkpoint.load(self.checkpoint).curve)
        return 0


def call(*args: object) -> int:
    """Call the command in this process, which takes a second less than in one of its own."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["fuzzyq", *map(str, args)])
        return app.call()


def refused(*args: object) -> str:
    """Return the one line that a command is refused with."""
    with pytest.raises(UserError) as caught:
        call(*args)
    (line,) = caught.value.problems
    return line


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Files:
    """A training that nothing interrupts; not to be changed."""
    files = Files.of(tmp_path_factory.mktemp("whole") / f"{PLANNER}.json")
    assert call(*ASKED, "--out", files.policy) == 0
    return files


@pytest.fixture
def begun(whole: Files, tmp_path: Path) -> Files:
    """A training of which three episodes are done."""
    files = Files.of(tmp_path / "begun.json")
    saved = Checkpoint.load(whole.checkpoint)
    replace(saved, curve=saved.curve[:3]).save(files.checkpoint)
    return files


# --- interrupted, and the same in the end


@pytest.mark.slow
def test_ctrl_c_and_a_kill_cost_nothing_but_the_running_episode(
    whole: Files, tmp_path: Path, fuzzyq: Call
) -> None:
    files = Files.of(tmp_path / "mine.json")

    def stopped_after_another_episode(signum: int, *more: str) -> tuple[int, str]:
        before = files.done()
        process = subprocess.Popen(
            [FUZZYQ, *ASKED, "--out", files.policy, *more], stderr=subprocess.PIPE, text=True
        )
        deadline = time.monotonic() + 60
        while files.done() <= before:
            assert process.poll() is None, process.communicate()
            assert time.monotonic() < deadline
            time.sleep(0.002)
        os.kill(process.pid, signum)
        _, stderr = process.communicate(timeout=60)
        assert before < files.done() < EPISODES
        assert not files.policy.exists()
        return process.returncode, stderr

    status, stderr = stopped_after_another_episode(signal.SIGINT)
    told, last = stderr.splitlines()
    assert (status, last) == (130, "error: interrupted")
    assert told.startswith(f"{files.done()} of {EPISODES} episodes are kept; to go on: fuzzyq ")
    assert [path.name for path in tmp_path.iterdir()] == [files.checkpoint.name]
    status, _ = stopped_after_another_episode(signal.SIGKILL, "--resume")
    assert status == -signal.SIGKILL
    done = fuzzyq(*shlex.split(told.partition("to go on: fuzzyq ")[2]), "--json")
    assert done.returncode == 0, done.stderr
    summary = json.loads(done.stdout)
    assert summary["episodes_before"] + summary["episodes_now"] == EPISODES
    assert summary["episodes_before"] >= 2
    assert [one.read_bytes() for one in files] == [one.read_bytes() for one in whole]


@pytest.mark.parametrize("more", [["--resume"], []], ids=["resume", "again"])
def test_what_is_done_already_stays_as_it_is(
    more: list[str], whole: Files, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files = Files.of(tmp_path / "again.json")
    for copy, one in zip(files, whole, strict=True):
        copy.write_bytes(one.read_bytes())
    if more:  # ended when all was learned, and nothing written
        files.policy.unlink()
        files.picture.unlink()
    call(*ASKED, "--out", files.policy, *more, "--json")
    out, err = capsys.readouterr()
    summary = json.loads(out)
    assert summary["episodes_now"] == 0
    assert summary["episodes_per_s"] is None
    assert f"all {EPISODES} episodes were done already; --anew trains again" in err
    assert [one.read_bytes() for one in files] == [one.read_bytes() for one in whole]


def test_the_policy_of_another_version_is_not_replaced(whole: Files, tmp_path: Path) -> None:
    files = Files.of(tmp_path / "older.json")
    older = load_policy(whole.policy).model_copy(update={"version": "0.0.1"})
    older.save(files.policy)
    line = refused(*ASKED, "--out", files.policy)
    assert line.startswith(f"{files.policy}: is there already, and not of this training; --anew")
    assert load_policy(files.policy) == older


def test_the_command_in_a_policy_makes_its_bytes_again_over_whatever_was_begun(
    whole: Files, begun: Files, capsys: pytest.CaptureFixture[str]
) -> None:
    policy = load_policy(whole.policy)
    assert policy.command == (
        f"fuzzyq train {PLANNER} --episodes {EPISODES} --drive kinematic --seed 5 "
        "--scenario open-field"
    )
    call(*shlex.split(policy.command)[1:], "--out", begun.policy, "--anew")
    assert begun.policy.read_bytes() == whole.policy.read_bytes()
    out, err = capsys.readouterr()
    assert out == ""
    assert f"{PLANNER}: {EPISODES} episodes in " in err
    assert " episodes/s (kinematic, seed 5)" in err
    assert all(str(path) in err for path in begun)


def test_a_policy_says_how_it_was_made(whole: Files) -> None:
    policy = load_policy(whole.policy, RECIPES[PLANNER].spec)
    assert (policy.planner, policy.drive, policy.seed, policy.episodes) == (
        PLANNER,
        "kinematic",
        5,
        EPISODES,
    )
    assert len(policy.scenario) == 32


def test_a_path_of_any_letters_stands_in_the_command_as_a_shell_reads_it() -> None:
    config = TrainingConfig(PLANNER, scenario="my fields/it's one.yaml")
    assert shlex.split(config.command)[-1] == config.scenario


# --- mistakes

MISTAKES: dict[tuple[str, ...], list[str]] = {
    ("fuzzy-q-lamda",): ["PLANNER: ", "did you mean 'fuzzy-q-lambda'?", "those that learn: "],
    ("improved-fuzzy",): ["PLANNER: ", "improved-fuzzy does not learn", PLANNER],
    (PLANNER, "--episodes", "0"): ["--episodes: ", "1 to 1000000", "got 0"],
    (PLANNER, "--episodes", "-3"): ["--episodes: ", "got -3"],
    (PLANNER, "--episodes", "many"): ["--episodes", "whole number"],
    (PLANNER, "--drive", "kinematics"): ["--drive: ", "did you mean 'kinematic'?", "wheels"],
    (PLANNER, "--seed", "-1"): ["--seed: ", "from 0 to", "got -1"],
    (PLANNER, "--scenario", "opn-field"): ["opn-field", "did you mean 'open-field'?"],
    (PLANNER, "--out", ""): ["--out: ", ".json, got ''"],
    (PLANNER, "--out", "policy.npz"): ["--out: ", ".json", "'policy.npz'"],
    (PLANNER, "--out", "/proc/no/policy.json"): ["/proc/no: not a folder that can be written to"],
    (PLANNER, "--resume", "--anew"): ["--resume", "--anew"],
    ("q-learning", "--trace", "0.9"): ["--trace: ", "q-learning", "has no traces"],
    (PLANNER, "--scenario", "x/" * 1500): ["--scenario", "too long for the policy"],
}


def test_what_is_wrong_in_an_options_file_is_named_there(tmp_path: Path) -> None:
    path = tmp_path / "how.yaml"
    for text, told in (
        ("trace: 0.5\nepisodes: 0\n", f"{path}:2: episodes: must be from 1"),
        ("drive: weels\n", f"{path}:1: drive: "),
        ("seed: -1\n", f"{path}:1: seed: must be from 0"),
    ):
        path.write_text(text)
        assert refused("train", PLANNER, "--options", path).startswith(told)
    assert refused("train", PLANNER, "--options", path, "--seed", -2).startswith("--seed: ")


@pytest.mark.parametrize("args", MISTAKES, ids=lambda args: " ".join(args)[:60])
def test_a_mistake_on_the_command_line(
    args: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    line = refused("train", *args)
    assert all(word in line for word in MISTAKES[args])
    assert not list(tmp_path.iterdir())


def test_a_folder_in_a_files_place_is_noticed_before_anything_is_learned(tmp_path: Path) -> None:
    (tmp_path / "mine.png").mkdir()
    line = refused(*ASKED, "--out", tmp_path / "mine.json")
    assert line == f"{tmp_path}/mine.png: cannot be written: there is a folder of that name"
    assert [path.name for path in tmp_path.iterdir()] == ["mine.png"]


def test_a_training_that_was_begun_is_not_thrown_away(begun: Files) -> None:
    before = begun.checkpoint.read_bytes()
    line = refused(*ASKED, "--out", begun.policy)
    assert line.startswith(f"{begun.checkpoint}: a training was begun, 3 of {EPISODES} episodes")
    assert "--resume goes on, --anew begins again" in line
    line = refused(*ASKED, "--drive", "wheels", "--out", begun.policy, "--resume")
    assert "belongs to another training: drive was kinematic and is wheels now" in line
    assert begun.checkpoint.read_bytes() == before


@pytest.mark.parametrize("content", [b"", b"junk" * 99, None], ids=["empty", "junk", "truncated"])
def test_a_damaged_checkpoint_is_told_of(content: bytes | None, begun: Files) -> None:
    whole = begun.checkpoint.read_bytes()
    begun.checkpoint.write_bytes(whole[:900] if content is None else content)
    for more in ([], ["--resume"]):
        line = refused(*ASKED, "--out", begun.policy, *more)
        assert line.startswith(f"{begun.checkpoint}: not an archive of arrays")
        assert line.endswith("; --anew begins again")


# --- scenarios that name a policy

SCENARIO = """\
name: learned
start: {position: [1, 1]}
goal: {position: [9, 9]}
drive: kinematic
planner:
  name: q-lambda
  policy: POLICY
"""


def scenario_in(folder: Path, policy: str) -> Path:
    folder.mkdir(exist_ok=True)
    path = folder / "learned.yaml"
    path.write_text(SCENARIO.replace("POLICY", policy))
    return path


def test_a_policy_is_found_from_its_scenarios_folder_and_no_path_is_in_the_trajectory(
    whole: Files, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, inside: Call
) -> None:
    digests = []
    for name in ("one", "other"):
        path = scenario_in(tmp_path / name, "learned/mine.json")
        (tmp_path / name / "learned").mkdir()
        (tmp_path / name / "learned" / "mine.json").write_bytes(whole.policy.read_bytes())
        monkeypatch.chdir(tmp_path)
        scenario = load_scenario(path.relative_to(tmp_path))
        monkeypatch.chdir("/")
        trajectory = run(scenario)
        assert result_of(trajectory).outcome == "goal"
        digests.append(trajectory.digest())
        # It means the same file wherever the scenario is written to.
        assert parse_scenario(dump_scenario(scenario)) == scenario
    assert digests[0] == digests[1]
    assert digests[0] != run(with_options(scenario, planner="improved-fuzzy")).digest()
    done = inside("run", "one/learned.yaml", "--no-video", "--json", cwd=tmp_path)
    assert json.loads(done.stdout)["digest"] == digests[0], done.stderr
    (tmp_path / "one" / "learned" / "mine.json").unlink()
    # A record needs no policy any more.
    assert Trajectory.load(tmp_path / "out" / "learned.npz").digest() == digests[0]


@pytest.fixture
def unfit(whole: Files, tmp_path: Path) -> dict[str, str]:
    """Policy files that cannot be used, by name, and what is said of each."""
    text = whole.policy.read_text()
    data: dict[str, Any] = json.loads(text)
    contents = {
        "truncated": (text[: len(text) // 2].encode(), "not valid JSON"),
        "junk": (bytes(range(256)) * 9, "is not text"),
        "checkpoint": (whole.checkpoint.read_bytes(), "is not text"),
        "empty": (b"", "is empty; it should hold a policy"),
        "nan": (text.replace("[\n  [", "[\n  [NaN, ", 1).encode(), "NaN is not allowed"),
        "deep": (b"[" * 100_000, "is nested too deeply"),
        "foreign": (
            json.dumps({**data, "planner": "q-learning"}).encode(),
            "is a policy of the planner 'q-learning'; one of 'q-lambda' is needed",
        ),
        "renamed": (
            json.dumps({**data, "actions": [f"a{i}" for i in range(24)]}).encode(),
            "actions",
        ),
    }
    for name, (content, _) in contents.items():
        (tmp_path / name).write_bytes(content)
    return {
        **{name: words for name, (_, words) in contents.items()},
        "nowhere": "No such file or directory; make one with fuzzyq train q-lambda",
        ".": "is not a file; give",
    }


def test_a_policy_that_cannot_be_used_is_one_line_with_its_place_in_the_scenario(
    unfit: dict[str, str], tmp_path: Path, fuzzyq: Call
) -> None:
    for name, words in unfit.items():
        path = scenario_in(tmp_path, name)
        for command in (("validate", path), ("run", path, "--out", tmp_path / "out")):
            line = refused(*command)
            assert line.startswith(f"{path}:7: planner.policy: {tmp_path}")
            assert words in line
        assert len(line) < 400
    assert not (tmp_path / "out").exists()
    done = fuzzyq("validate", path)
    assert (done.returncode, done.stdout, done.stderr) == (2, "", f"error: {line}\n")


def test_who_learns_needs_no_policy_to_begin_with(
    whole: Files, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = scenario_in(tmp_path, "nowhere.json").rename(tmp_path / "$x^ \N{SNOWMAN}\udcff.yaml")
    monkeypatch.chdir(tmp_path)
    call("train", PLANNER, "--scenario", path.name, "--episodes", "1")
    policy = load_policy(tmp_path / f"out/train/{PLANNER}.json")
    assert str(tmp_path) not in policy.dumps()
    # Nor does it matter in which folder its file would have been.
    before = load_policy(whole.policy)
    assert policy.scenario != before.scenario
    again = scenario_in(tmp_path / "elsewhere", "other.json")
    call("train", PLANNER, "--scenario", again, "--episodes", "1", "--out", "other.json")
    assert load_policy(tmp_path / "other.json").scenario == policy.scenario


@pytest.mark.parametrize(
    ("planner", "place"),
    [("fuzzy-q-lambda", "4: planner.policy: "), ('{name: fuzzy-q-lambda, policy: ""}', "4: ")],
)
def test_a_policy_that_nobody_named_has_a_place_too(
    planner: str, place: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fuzzyq_bullet.planning.policies.shipped", lambda name: tmp_path / name)
    text = "name: bad\nstart: {position: [1, 1]}\ngoal: {position: [9, 9]}\n"
    with pytest.raises(UserError) as caught:
        parse_scenario(f"{text}planner: {planner}\n", policies=True)
    assert caught.value.problems[0].startswith(f"scenario:{place}")
    assert parse_scenario(text + "planner: fuzzy-q-lambda\n").name == "bad"


# --- what is shown


def a_curve(*episodes: tuple[float, bytes]) -> Curve:
    return np.array([(total, 10, outcome) for total, outcome in episodes], ROW)


MIXED = a_curve(
    *[(-5.0, b"goal"), (-40.0, b"collision"), (-60.0, b"stuck"), (-300.0, b"timeout")] * 30,
    (-200.0, b"going on"),
)


def test_the_learning_curve_is_a_picture(whole: Files) -> None:
    with Image.open(whole.picture) as image:
        image.verify()
        assert (image.format, image.size) == ("PNG", (1152, 792))


def test_the_picture_shows_every_episode_and_both_means() -> None:
    above, below = picture(MIXED, "a title").axes
    marks = [np.asarray(marks.get_offsets()) for marks in above.collections]
    assert [len(one) for one in marks] == [30, 30, 30, 30, 1]
    assert len(marks) == len(MARKS)
    shown = np.concatenate(marks)
    assert (shown[np.argsort(shown[:, 0]), 1] == MIXED["total"]).all()
    assert (above.lines[0].get_ydata() == last_mean(MIXED["total"])).all()
    assert (below.lines[0].get_ydata() == last_mean(MIXED["outcome"] == b"goal")).all()


def test_one_episode_that_takes_forever_does_not_press_all_others_into_a_line() -> None:
    curve = a_curve(*[(-5.0 - i % 9, b"goal") for i in range(199)], (-3000.0, b"timeout"))
    above, _ = picture(curve, "a title").axes
    low, high = above.get_ylim()
    assert low > -200.0
    lowest = np.asarray(above.collections[-1].get_offsets())[0, 1]
    assert low <= lowest < high  # its mark is there nonetheless
    assert any("down to \N{MINUS SIGN}3000 s" in text.get_text() for text in above.texts)


def test_a_running_mean_looks_back_at_what_there_is() -> None:
    values = np.array([4.0, 0.0, 2.0, 6.0])
    assert last_mean(values, 2).tolist() == [4.0, 2.0, 1.0, 4.0]
    assert last_mean(values, 9).tolist() == [4.0, 2.0, 2.0, 3.0]


def test_the_bar_tells_success_and_rate() -> None:
    notes: list[tuple[str, int]] = []
    progress = TrainingProgress(before=100)
    update = progress.shown(200, lambda note, done: notes.append((note, done)))
    time.sleep(0.01)
    update(MIXED[:120])
    ((note, done),) = notes
    assert done == 120
    assert note.startswith("episode 120 of 200, ")
    assert note.endswith("/s, goal in 24 % of the last 50")  # 12 of them
    assert (progress.ran, progress.before) == (20, 100)
    assert 0.0 < (progress.rate or 0.0) < 2000.0


# --- the policies that are shipped


@pytest.mark.parametrize("planner", SHIPPED)
def test_a_shipped_policy_is_what_its_command_makes(planner: str) -> None:
    if not shipped(planner).exists():
        pytest.skip("not shipped yet")
    config = SHIPPED[planner]
    policy = load_policy(shipped(config.planner), RECIPES[config.planner].spec)
    assert policy.command == config.command
    assert (policy.episodes, policy.drive, policy.seed) == (
        config.episodes,
        config.drive,
        config.seed,
    )
    assert config.scenario is None
    assert policy.scenario == RECIPES[planner].tasks(config.drive, config.seed).digest()


def test_every_shipped_policy_has_a_command_and_every_command_a_planner_that_learns() -> None:
    assert {path.stem for path in asset("policies").glob("*")} <= SHIPPED.keys()
    assert RECIPES.keys() <= SHIPPED.keys()


def test_make_reads_the_commands_from_where_they_are(capsys: pytest.CaptureFixture[str]) -> None:
    runpy.run_path(sys.modules["fuzzyq_bullet.training.config"].__file__ or "", None, "__main__")
    assert capsys.readouterr().out.splitlines() == [config.command for config in SHIPPED.values()]


@pytest.mark.parametrize(
    ("column", "value"),
    [("outcome", b"\xff\xfe"), ("outcome", b"go\x1b[2J"), ("total", 1e308), ("steps", -1)],
)
def test_a_curve_that_no_training_has_left_is_one_line(
    column: str, value: object, begun: Files
) -> None:
    saved = Checkpoint.load(begun.checkpoint)
    curve = saved.curve.copy()
    curve[column][0] = value
    replace(saved, curve=curve).save(begun.checkpoint)
    line = refused(*ASKED, "--out", begun.policy, "--resume")
    assert "damaged: its table or curve cannot be one of a training" in line
