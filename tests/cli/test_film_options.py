"""The options of a film, and races, through the command line."""

from __future__ import annotations

import io
import json
import shlex
import shutil
import signal
from pathlib import Path

import pytest
from PIL import Image
from rich.console import Console

from fuzzyq_bullet.errors import Stopped, UserError
from tests.helpers.commands import SHORT, Call

RACE_OF = ("race", "--planners", "fuzzy-q-lambda,fuzzy")
EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "extend" / "view.py"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--size", "big"), "'--size': must be WIDTHxHEIGHT, such as 1920x1080; got 'big'"),
        (("--size", "1921x1080"), "must be even numbers; got 1921x1080"),
        (("--size", "9000x9000"), "'--size': must be from 240x240"),
        (("--fps", "0"), "'--fps': must be a whole number from 1 to 120"),
        (("--from", "-1"), "'--from': must be a number of seconds"),
        (("--from", "3", "--to", "2"), "--to: must be later than --from (3 s); got 2"),
        (("--view", "upside"), "--view: must be one of explain, scene, follow, map"),
        (("--format", "avi"), "'--format': must be one of mp4, gif; got 'avi'"),
        (("--format", "gif", "--fps", "60"), "--fps: a GIF has at most 50; got 60"),
        (("--still", "2", "--fps", "5"), "--still: makes one picture"),
        (("--out", "film.avi"), "--out: film.avi must be a folder"),
        (("--from", "900"), "--from: 900 s is after the end of the run"),
    ],
)
def test_what_no_film_can_be_is_one_line_before_anything_is_written(
    words: tuple[str, ...], said: str, inside: Call, filmed: Path, tmp_path: Path
) -> None:
    record = tmp_path / "short.npz"
    shutil.copy(filmed / "short.npz", record)
    with pytest.raises(UserError) as caught:
        inside("replay", record, *words, cwd=tmp_path)
    (line,) = caught.value.problems
    assert said in line
    assert [path.name for path in tmp_path.iterdir()] == ["short.npz"]


def test_a_run_is_not_driven_for_a_film_that_cannot_be(
    inside: Call, short: Path, tmp_path: Path
) -> None:
    for words in (("--view", "upside"), ("--size", "1x1"), ("--format", "avi")):
        with pytest.raises(UserError):
            inside("run", short, "--out", tmp_path, *words)
    assert list(tmp_path.iterdir()) == []


def test_a_replay_is_named_by_how_it_is_filmed_and_leaves_the_usual_film(
    inside: Call, filmed: Path, tmp_path: Path
) -> None:
    for name in ("short.npz", "short.mp4"):
        shutil.copy(filmed / name, tmp_path)
    before = (tmp_path / "short.mp4").read_bytes()
    record = tmp_path / "short.npz"
    options = ("--view", "map", "--size", "320x240")
    done = inside("replay", record, *options, "--to", "0.5", "--format", "gif")
    assert done.stdout.strip() == str(tmp_path / "short-map-320x240-to0.5s.gif")
    with Image.open(done.stdout.strip()) as image:
        assert (image.format, image.size) == ("GIF", (320, 240))
    done = inside("replay", record, *options, "--still", "0.5")
    with Image.open(tmp_path / "short-map-320x240-at0.5s.png") as image:
        assert (image.format, image.size) == ("PNG", (320, 240))
    assert (tmp_path / "short.mp4").read_bytes() == before


def test_the_example_of_a_view_is_filmed(inside: Call, filmed: Path, tmp_path: Path) -> None:
    words = ("--plugin", EXAMPLE, "--view", "countdown", "--still", "1.95", "--out", tmp_path)
    inside("replay", filmed / "short.npz", *words)
    with pytest.raises(UserError, match=r"--still: 99 s is after the end of the run, 1\.95 s"):
        inside("replay", filmed / "short.npz", "--still", 99, "--out", tmp_path)
    with Image.open(tmp_path / "short-countdown-at1.95s.png") as image:
        bar = image.convert("RGB").crop((128, 490, 1152, 520))
        green = sum(1 for pixel in bar.get_flattened_data() if pixel == (20, 184, 138))
    assert green > 0.6 * 1024 * 24, "the robot is in the goal"


@pytest.mark.parametrize(
    ("words", "film"),
    [
        (("run", "--to", "0.2"), "short-map-320x240-5fps-2x-to0.2s.mp4"),
        (RACE_OF, "race-short-vs-short-fuzzy-map-320x240-5fps-2x.mp4"),
    ],
    ids=["run", "race"],
)
def test_a_film_that_is_interrupted_leaves_the_records_and_the_command_that_films_them(
    words: tuple[str, ...],
    film: str,
    inside: Call,
    short: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def stop(*_: object, **__: object) -> None:
        raise Stopped(signal.SIGINT)

    command, *more = words
    how = ("--view", "map", "--size", "320x240", "--fps", "5", "--speed", "2")
    said = io.StringIO()
    with monkeypatch.context() as patch:
        patch.setattr("fuzzyq_bullet.video.record", stop)
        patch.setattr("fuzzyq_bullet.cli.options.stderr", Console(file=said))
        with pytest.raises(Stopped):
            inside(command, short, *more, "--out", tmp_path, *how)
    [line] = [one for one in said.getvalue().splitlines() if "to film: " in one]
    kept, _, again = line.partition("; to film: fuzzyq ")
    names = ["short"] if command == "run" else ["short", "short-fuzzy"]
    records = [tmp_path / f"{name}.npz" for name in names]
    assert kept == f"kept: {', '.join(map(str, records))}"
    assert inside(*shlex.split(again)).returncode == 0
    assert [path.name for path in tmp_path.glob("*.mp4")] == [film]


RACE = ("--view", "map", "--size", "320x240", "--speed", "10")


def test_a_race_writes_the_records_that_run_would_and_one_film(
    inside: Call, short: Path, filmed: Path, tmp_path: Path
) -> None:
    done = inside("race", short, "--planners", "fuzzy-q-lambda,fuzzy", "--out", tmp_path, *RACE)
    assert done.returncode == 0
    film = tmp_path / "short-race-fuzzy-q-lambda-vs-fuzzy-map-320x240-10x.mp4"
    names = ["short-fuzzy.json", "short-fuzzy.npz", "short.json", "short.npz", film.name]
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(names)
    ran, raced = (json.loads((one / "short.json").read_text()) for one in (filmed, tmp_path))
    assert ran == raced, "the same run as by fuzzyq run"
    # The records race again without driving; and the same race again replaces what it made.
    records = [tmp_path / "short.npz", tmp_path / "short-fuzzy.npz"]
    done = inside("race", *records, *RACE, "--json")
    assert (tmp_path / "race-short-vs-short-fuzzy-map-320x240-10x.mp4").exists()
    assert [one["planner"] for one in json.loads(done.stdout)] == ["fuzzy-q-lambda", "fuzzy"]
    assert (
        inside("race", short, "--planners", "fuzzy-q-lambda,fuzzy", "--out", tmp_path, *RACE)
    ).returncode == 0


def test_records_of_one_name_are_told_apart_by_their_folders(
    inside: Call, filmed: Path, tmp_path: Path
) -> None:
    for way in ("{}.npz", "{}/short.npz"):
        records = [tmp_path / way.format(name) for name in ("first", "second")]
        for record in records:
            record.parent.mkdir(exist_ok=True)
            shutil.copy(filmed / "short.npz", record)
        inside("race", *records, "--still", "0.5", "--out", tmp_path)
    by_file, by_folder = ("race-first-vs-second-at0.5s.png", "race-short-vs-short-at0.5s.png")
    assert (tmp_path / by_file).read_bytes() == (tmp_path / by_folder).read_bytes()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ((), "--planners: must be 2 to 4 different planners"),
        (("--planners", "fuzzy"), "--planners: must be 2 to 4 different planners"),
        (("--planners", "fuzzy,fuzzy"), "--planners: must be 2 to 4 different planners"),
        (("--planners", "fuzzy,fuzzzy"), "--planner"),
        (("other.yaml", "--planners", "fuzzy,q-lambda"), "race: one scenario, or 2 to 4 records"),
        (("--planners", "fuzzy,q-lambda", "--view", "upside"), "--view: must be one of explain"),
    ],
)
def test_what_is_no_race_is_one_line(
    words: tuple[str, ...], said: str, inside: Call, short: Path, tmp_path: Path
) -> None:
    with pytest.raises(UserError) as caught:
        inside("race", short, *words, "--out", tmp_path)
    assert said in caught.value.problems[0]
    assert list(tmp_path.iterdir()) == []


def test_a_race_does_not_replace_its_records_or_another_run(
    inside: Call, filmed: Path, tmp_path: Path
) -> None:
    with pytest.raises(UserError, match="needs 2 to 4 records; got 1"):
        inside("race", filmed / "short.npz", *RACE)
    shutil.copy(filmed / "short.npz", tmp_path)
    before = (tmp_path / "short.npz").read_bytes()
    other = tmp_path / "short.yaml"
    other.write_text(SHORT + "limits: {time: 7.0}\n")
    with pytest.raises(UserError, match="is of another run"):
        inside("race", other, "--planners", "fuzzy-q-lambda,fuzzy", "--out", tmp_path, *RACE)
    assert (tmp_path / "short.npz").read_bytes() == before
