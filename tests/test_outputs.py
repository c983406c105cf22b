"""Nothing of the user's is lost: no output replaces an input, or what another run has made."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from fuzzyq_bullet import Trajectory, load_scenario, with_options
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import alone_at, own_parts, remove_parts, written_beside
from fuzzyq_bullet.outputs import run_name
from fuzzyq_bullet.platforms import asset
from tests.helpers.commands import FUZZYQ, SHORT, Call

pytestmark = pytest.mark.usefixtures("in_this_process")

GIVEN = "would be replaced, but is an input of this command"


def refused(call: Callable[[], object], words: str) -> None:
    with pytest.raises(UserError) as caught:
        call()
    (line,) = caught.value.problems
    assert words in line


def as_itself(path: Path) -> Path:
    return path


def as_link(path: Path) -> Path:
    link = path.with_name("link" + path.suffix)
    link.symlink_to(path.name)
    return link


def as_hard_link(path: Path) -> Path:
    link = path.with_name("hard" + path.suffix)
    os.link(path, link)
    return link


def by_another_path(path: Path) -> Path:
    (path.parent / "below").mkdir()
    return path.parent / "below" / ".." / path.name


OTHERWISE = [as_itself, as_link, as_hard_link, by_another_path]


@pytest.fixture
def short_here(tmp_path: Path) -> Path:
    path = tmp_path / "short.yaml"
    path.write_text(SHORT)
    return path


@pytest.mark.parametrize("ending", [".json", ".npz", ".mp4"])
def test_a_run_does_not_replace_its_scenario(ending: str, inside: Call, tmp_path: Path) -> None:
    path = tmp_path / f"short{ending}"
    path.write_text(SHORT)
    refused(lambda: inside("run", path, "--out", tmp_path), GIVEN)
    refused(lambda: inside("run", path, "--out", tmp_path, "--replace"), GIVEN)
    assert path.read_text() == SHORT


def test_a_run_does_not_replace_its_policy(inside: Call, tmp_path: Path) -> None:
    policy = tmp_path / "short.json"
    shutil.copy(asset("policies") / "q-learning.json", policy)
    before = policy.read_bytes()
    path = tmp_path / "s.yaml"
    path.write_text(SHORT + "planner: {name: q-learning, policy: short.json}\n")
    refused(lambda: inside("run", path, "--out", tmp_path), GIVEN)
    assert policy.read_bytes() == before


@pytest.mark.parametrize("otherwise", OTHERWISE)
def test_a_check_does_not_replace_a_scenario_by_its_report(
    otherwise: Callable[[Path], Path], inside: Call, short_here: Path
) -> None:
    other = otherwise(short_here)
    refused(lambda: inside("check", short_here, "--junit", other), GIVEN)
    assert short_here.read_text() == SHORT


def test_a_check_does_not_replace_what_was_recorded(
    inside: Call, short_here: Path, tmp_path: Path
) -> None:
    assert inside("check", short_here, "--record").returncode == 0
    record = tmp_path / "check-record.json"
    before = record.read_bytes()
    refused(lambda: inside("check", short_here, "--junit", record), GIVEN)
    assert record.read_bytes() == before


@pytest.mark.parametrize("otherwise", OTHERWISE)
def test_a_training_does_not_replace_its_scenario(
    otherwise: Callable[[Path], Path], inside: Call, tmp_path: Path
) -> None:
    path = tmp_path / "t.json"
    path.write_text(SHORT)
    out = otherwise(path)
    refused(lambda: inside("train", "q-learning", "--scenario", path, "--out", out), GIVEN)
    refused(
        lambda: inside("train", "q-learning", "--scenario", path, "--out", out, "--anew"), GIVEN
    )
    assert path.read_text() == SHORT


def test_a_replay_does_not_replace_its_record(inside: Call, filmed: Path, tmp_path: Path) -> None:
    record = tmp_path / "short.mp4"
    shutil.copy(filmed / "short.npz", record)
    refused(lambda: inside("replay", record), GIVEN)
    assert Trajectory.load(record).outcome == "goal"


def test_a_report_does_not_replace_a_sweep(inside: Call, tmp_path: Path) -> None:
    options = ("--counts", "0", "--runs", 1, "--traps", 0, "--rectangles", "none", "--jobs", 1)
    inside("bench", "escape", *options, "--drive", "kinematic", "--out", tmp_path / "escape")
    for name in ("settings.json", "journal.jsonl", "escape.csv"):
        path = tmp_path / "escape" / name
        before = path.read_bytes()
        refused(
            lambda path=path: inside(
                "report", tmp_path, "--no-videos", "--no-figures", "--out", path
            ),
            GIVEN,
        )
        assert path.read_bytes() == before


# What a run is called


def test_what_differs_from_the_scenario_is_part_of_the_name() -> None:
    given = load_scenario("mixed")
    for options, name in (
        ({}, "mixed"),
        ({"planner": given.planner.name, "seed": given.seed, "drive": given.drive}, "mixed"),
        ({"planner": "improved-fuzzy", "seed": 7}, "mixed-improved-fuzzy-seed7"),
        ({"drive": "kinematic"}, "mixed-kinematic"),
    ):
        assert run_name(given, with_options(given, **options)) == name


def test_runs_to_be_compared_lie_side_by_side(
    inside: Call, short_here: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    for options in ((), ("--planner", "fuzzy"), ("--drive", "kinematic", "--seed", 3)):
        inside("run", short_here, "--no-video", "--out", out, *options)
    assert sorted(path.stem for path in out.glob("*.npz")) == [
        "short",
        "short-fuzzy",
        "short-kinematic-seed3",
    ]


# What a run may replace


def test_the_same_run_may_be_done_again(inside: Call, short_here: Path, tmp_path: Path) -> None:
    again = lambda: inside("run", short_here, "--no-video", "--out", tmp_path / "out")  # noqa: E731
    assert again().returncode == again().returncode == 0
    short_here.write_text(SHORT + "description: The same in other words.\n")
    assert again().returncode == 0


def test_another_run_of_that_name_replaces_it_only_when_asked_to(
    inside: Call, short_here: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    inside("run", short_here, "--no-video", "--out", out)
    before = Trajectory.load(out / "short.npz")
    short_here.write_text(SHORT.replace("radius: 0.2", "radius: 0.3"))
    again = ("run", short_here, "--no-video", "--out", out)
    refused(lambda: inside(*again), "is of another run (obstacles differs); --replace replaces it")
    assert Trajectory.load(out / "short.npz") == before
    assert inside(*again, "--replace").returncode == 0
    assert Trajectory.load(out / "short.npz") != before


@pytest.mark.parametrize("name", ["short.mp4", "short.json", "short.npz"])
def test_a_file_that_no_run_has_made_stays(
    name: str, inside: Call, short_here: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / name).write_text("mine")
    refused(lambda: inside("run", short_here, "--out", out), "no record tells of which run")
    assert (out / name).read_text() == "mine"


def test_a_replay_elsewhere_keeps_the_film_of_another_run(
    inside: Call, filmed: Path, tmp_path: Path
) -> None:
    (tmp_path / "short.mp4").write_text("mine")
    refused(
        lambda: inside("replay", filmed / "short.npz", "--out", tmp_path),
        "no record tells of which run",
    )
    assert (tmp_path / "short.mp4").read_text() == "mine"


@pytest.mark.slow
def test_a_check_keeps_the_record_of_another_run_and_its_verdict(
    inside: Call, short_here: Path, tmp_path: Path
) -> None:
    out = tmp_path / "films"
    command = ("check", short_here, "--video", "all", "--out", out)
    assert inside(*command).returncode == 0
    before = (out / "short.npz").read_bytes()
    short_here.write_text(SHORT.replace("radius: 0.2", "radius: 0.3"))
    done = inside(*command)
    assert done.returncode == 0
    assert "no film: " in done.stdout
    assert "--replace replaces it" in done.stdout
    assert (out / "short.npz").read_bytes() == before


@pytest.mark.slow
def test_a_finished_policy_is_replaced_by_the_same_training_alone(
    inside: Call, short_here: Path, tmp_path: Path
) -> None:
    train = ("train", "q-learning", "--scenario", short_here, "--out", tmp_path / "p.json")
    train = (*train, "--episodes")
    inside(*train, 3)
    before = (tmp_path / "p.json").read_bytes()
    refused(lambda: inside(*train, 2, "--seed", 9), "not of this training; --anew replaces it")
    assert (tmp_path / "p.json").read_bytes() == before
    inside(*train, 3)
    assert (tmp_path / "p.json").read_bytes() == before
    inside(*train, 2, "--seed", 9, "--anew")
    assert (tmp_path / "p.json").read_bytes() != before


def test_a_picture_that_no_training_has_drawn_stays(inside: Call, tmp_path: Path) -> None:
    (tmp_path / "p.png").write_text("mine")
    refused(
        lambda: inside("train", "q-learning", "--episodes", 1, "--out", tmp_path / "p.json"),
        "p.png: is there already",
    )


# Two at once


@pytest.mark.slow
def test_two_checks_in_one_folder_both_have_their_films(short_here: Path, tmp_path: Path) -> None:
    short_here.write_text(SHORT.replace("[1.4, 0.7]", "[1.0, 0.6]"))
    command = [FUZZYQ, "check", str(short_here), "--video", "all", "--out", str(tmp_path / "films")]
    both = [subprocess.Popen(command, stderr=subprocess.PIPE, text=True) for _ in range(2)]
    said = [one.communicate(timeout=100)[1] for one in both]
    assert [one.returncode for one in both] == [0, 0]
    assert not any("no film" in one for one in said)
    assert sorted(path.name for path in (tmp_path / "films").iterdir()) == [
        "short.mp4",
        "short.npz",
    ]


def test_only_what_the_killed_process_left_is_tidied_away(tmp_path: Path) -> None:
    path = tmp_path / "film.mp4"
    mine = tmp_path / ".film.mp4.mine.part"
    mine.mkdir()
    own_parts("aaaa")
    try:
        with written_beside(path) as part:
            remove_parts(path, "bbbb")
            assert part.parent.is_dir()
            part.write_text("done")
            assert part.parent.name.startswith(".film.mp4.aaaa")
    finally:
        own_parts("")
    assert path.read_text() == "done"
    assert mine.is_dir()


def test_one_training_at_a_time_renews_a_checkpoint(inside: Call, tmp_path: Path) -> None:
    train = ("train", "q-learning", "--episodes", 1, "--out", tmp_path / "p.json")
    with alone_at(tmp_path / "p.checkpoint.npz"):
        refused(lambda: inside(*train), "another process is at work on it")
    assert inside(*train).returncode == 0
    assert not list(tmp_path.glob(".*"))


def test_a_sweep_leaves_the_users_dot_files_alone(inside: Call, tmp_path: Path) -> None:
    options = ("--counts", "0", "--runs", 1, "--traps", 0, "--rectangles", "none", "--jobs", 1)
    command = ("bench", "escape", *options, "--drive", "kinematic", "--out", tmp_path)
    inside(*command)
    mine = [tmp_path / ".mine.part", tmp_path / ".report.html.0123abcd.part"]
    ours = [tmp_path / ".escape.csv.0123abcd.part", tmp_path / "records" / ".x.npz.0123abcd.part"]
    for folder in (*mine, *ours):
        folder.mkdir()
    inside(*command)
    assert all(folder.is_dir() for folder in mine)
    assert not any(folder.exists() for folder in ours)


@pytest.mark.parametrize("kind", ["link", "pipe"])
@pytest.mark.parametrize("name", ["journal.jsonl", "settings.json"])
def test_a_sweep_follows_no_link_and_waits_for_no_pipe(
    name: str, kind: str, inside: Call, tmp_path: Path
) -> None:
    elsewhere, out = tmp_path / "elsewhere", tmp_path / "sweep"
    options = ("--counts", "0", "--runs", 1, "--traps", 0, "--rectangles", "none", "--jobs", 1)
    command = ("bench", "escape", *options, "--drive", "kinematic", "--out", out)
    inside(*command)
    if kind == "link":
        if name == "settings.json":  # only read
            return
        elsewhere.write_text("mine\n")
        (out / name).unlink()
        (out / name).symlink_to(elsewhere)
        refused(lambda: inside(*command), "is a link; use another --out")
        assert elsewhere.read_text() == "mine\n"
    else:
        (out / name).unlink()
        (out / "escape.csv").unlink()
        os.mkfifo(out / name)
        refused(lambda: inside(*command), "is not a")
        refused(lambda: inside("report", out, "--no-videos", "--no-figures"), "is not a file")


def test_a_record_of_checks_that_is_a_pipe_keeps_nobody_waiting(
    inside: Call, short_here: Path, tmp_path: Path
) -> None:
    os.mkfifo(tmp_path / "check-record.json")
    done = inside("check", short_here)
    assert done.returncode == 2
    assert "check-record.json: is not a file; give a record of fuzzyq check" in done.stderr
