"""Whatever is wrong with what the user gave: one clear line, exit code 2, nothing half-written."""

from __future__ import annotations

import io
import json
import os
import resource
import zipfile
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from fuzzyq_bullet import Trajectory, UserError, load_scenario
from tests.helpers.commands import Call

if TYPE_CHECKING:
    import subprocess
    from collections.abc import Callable


def told(done: subprocess.CompletedProcess[str]) -> str:
    """Return the one line that a mistake is answered with."""
    assert done.returncode == 2, done.stderr
    assert done.stdout == ""
    (line,) = done.stderr.splitlines()
    assert line.startswith("error: ")
    return line


def refused(inside: Call, *args: object, cwd: Path | None = None) -> str:
    """Return the same line, without the process that ``told`` needs."""
    with pytest.raises(UserError) as caught:
        inside(*args, cwd=cwd)
    (line,) = caught.value.problems
    assert "\n" not in line
    return f"error: {line}"


USAGE = {
    ("rnu",): ["'rnu'", "Did you mean 'run'"],
    ("run",): ["SCENARIO"],
    ("run", "mixed", "--plannr", "x"): ["--plannr", "--planner"],
    ("run", "mixed", "--seed", "x"): ["--seed", "whole number"],
    ("run", "mixed", "--seed", "-1"): ["--seed: ", "0 to", "-1"],
    ("run", "mixed", "--speed", "nan"): ["--speed", "0.1 to 100"],
    ("run", "mixed", "--planner", "fuzy"): [
        "--planner: ",
        "'fuzy'",
        "did you mean 'fuzzy'?",
        "improved-fuzzy",
    ],
    ("run", "mixed", "--drive", "legs"): ["--drive: ", "'legs'", "wheels", "kinematic"],
    ("run", "mixd"): ["mixd", "did you mean 'mixed'?"],
    ("run", "mixed", "again"): ["again"],
    ("run", "mixed", "--out", ""): ["--out", "empty"],
    ("replay", "nowhere.npz", "--out", ""): ["--out", "empty"],
    ("figure", "4", "--out="): ["--out", "empty"],
    ("replay", "nowhere.npz"): ["nowhere.npz", "No such file"],
    ("figure", "99"): ["99", "4 ("],
    ("explain", "9", "0"): ["D: 9", "0 to 5"],
}


AS_A_PROCESS = (("rnu",), ("run", "mixd"))
"""One that the parser finds and one that a command finds."""


@pytest.mark.slow
@pytest.mark.parametrize("args", USAGE, ids=" ".join)
def test_a_mistake_on_the_command_line(
    args: tuple[str, ...], fuzzyq: Call, inside: Call, tmp_path: Path
) -> None:
    line = refused(inside, *args, cwd=tmp_path)
    if args in AS_A_PROCESS:
        assert told(fuzzyq(*args, cwd=tmp_path)) == line
    assert all(word in line for word in USAGE[args])
    assert not list(tmp_path.iterdir())


OPTIONS = {
    ("check", "mixed", "--repeat", "0"): "'--repeat': must be at least 1, got 0",
    ("check", "mixed", "--timeout", "nan"): "'--timeout': must be at most 86400, got nan",
    (
        "check",
        "mixed",
        "--video",
        "fail",
    ): "'--video': 'fail' is not one of 'failed', 'all', 'none'",
    ("bench", "field", "--runs", "0"): "'--runs': must be at least 1, got 0",
    ("bench", "speed", "--rounds", "101"): "'--rounds': must be at most 100, got 101",
    ("run", "mixed", "--seed", "1.5"): "'--seed': expected a whole number, got '1.5'",
    ("run", "mixed", "--speed", "0,5"): "'--speed': 0,5 has a decimal comma; write 0.5",
    ("explain", "abc", "1"): "'D': expected a number, got 'abc'",
}


@pytest.mark.parametrize("args", OPTIONS, ids=" ".join)
def test_an_option_of_a_wrong_value_is_told_in_the_words_of_the_project(
    args: tuple[str, ...], inside: Call, tmp_path: Path
) -> None:
    told = f"error: Invalid value for {OPTIONS[args]} (see fuzzyq "
    assert refused(inside, *args, cwd=tmp_path).startswith(told)


def test_a_plugin_that_is_not_there_is_told_without_an_exception(
    inside: Call, tmp_path: Path
) -> None:
    line = refused(inside, "run", "mixed", "--plugin", "nop.py", cwd=tmp_path)
    assert line == "error: --plugin: nop.py: there is no such file"


def bomb() -> str:
    layers = [f"a{i + 1}: &a{i + 1} [{', '.join([f'*a{i}'] * 9)}]" for i in range(12)]
    return "a0: &a0 [1]\n" + "\n".join(layers)


HEAD = "name: bad\nstart: {position: [1, 1]}\ngoal: {position: [9, 9]}\n"
FILES: dict[str, tuple[bytes, list[str]]] = {
    "junk": (bytes(range(256)) * 40, ["bad.yaml"]),
    "null bytes": (b"\0" * 100, ["bad.yaml:1"]),
    "empty": (b"", ["bad.yaml:1", "empty"]),
    "a list": (b"- 1\n", ["bad.yaml:1", "mapping"]),
    "wrong type": (HEAD.encode() + b"seed: soon\n", ["bad.yaml:4", "seed", "whole number"]),
    "nan": (HEAD.encode() + b"limits: {time: .nan}\n", ["bad.yaml:4", "limits.time", "finite"]),
    "infinity": (
        HEAD.encode() + b"arena:\n  size: [.inf, 10]\n",
        ["bad.yaml:5", "arena.size[0]", "finite"],
    ),
    "negative": (
        HEAD.encode() + b"obstacles:\n  - {shape: box, position: [5, 5], size: [-1, 1]}\n",
        ["bad.yaml:5", "obstacles[0].size[0]", "at least", "-1"],
    ),
    "too many": (
        HEAD.encode() + b"random: {count: 1000000}\n",
        ["bad.yaml:4", "random.count", "10000"],
    ),
    "a tab": (
        b"name: bad\nstart:\n\tposition: [1, 1]\n",
        ["bad.yaml:3", "tabs cannot indent; use spaces"],
    ),
    "a tab further on": (
        HEAD.encode() + b"arena:\n  walls: true\n\tsize: [9, 9]\n",
        ["bad.yaml:6", "tabs cannot indent; use spaces"],
    ),
    "twice": (HEAD.encode() + b"seed: 1\nseed: 2\n", ["bad.yaml:5", "'seed'", "line 4"]),
    "anchors": (bomb().encode(), ["bad.yaml:", "values"]),
    "no planner": (
        HEAD.encode() + b"planner: {name: fuzy}\n",
        ["bad.yaml:4", "planner.name", "'fuzzy'"],
    ),
    "misspelt": (HEAD.encode() + b"goall: 1\n", ["bad.yaml:4", "goall", "did you mean 'goal'?"]),
}


def test_a_mistake_in_a_scenario_is_one_line_that_names_its_place(
    fuzzyq: Call, tmp_path: Path
) -> None:
    files = []
    for number, (content, _) in enumerate(FILES.values()):
        (tmp_path / str(number)).mkdir()
        files.append(f"{number}/bad.yaml")
        (tmp_path / files[-1]).write_bytes(content)
    done = fuzzyq("validate", *files, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    lines = done.stderr.splitlines()
    assert len(lines) == len(FILES)
    for line, file, (name, (_, words)) in zip(lines, files, FILES.items(), strict=True):
        assert line.startswith(f"error: {file}"), name
        assert all(word in line for word in words), line


def test_a_run_of_a_wrong_scenario_writes_nothing(fuzzyq: Call, tmp_path: Path) -> None:
    (tmp_path / "bad.yaml").write_bytes(FILES["nan"][0])
    assert "bad.yaml:4: limits.time" in told(fuzzyq("run", "bad.yaml", "--json", cwd=tmp_path))
    assert [path.name for path in tmp_path.iterdir()] == ["bad.yaml"]


def test_obstacles_that_find_no_place_are_told_before_a_folder_is_made(
    inside: Call, tmp_path: Path
) -> None:
    crowd = "random: {count: 5000, radius: 0.2, overlap: false}\n"
    (tmp_path / "bad.yaml").write_text(HEAD + crowd)
    refused(inside, "run", "bad.yaml", cwd=tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["bad.yaml"]


def test_a_million_obstacles_are_refused_at_once(inside: Call, tmp_path: Path) -> None:
    item = "  - {shape: cylinder, position: [5, 5], radius: 0.2}\n"
    (tmp_path / "bad.yaml").write_text(HEAD + "obstacles:\n" + item * 1_000_000)
    assert "too large" in refused(inside, "validate", "bad.yaml", cwd=tmp_path)


def test_what_is_no_file_is_no_scenario_and_no_record(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path, tmp_path / "pipe", Path("/dev/zero"), Path("x" * 5000)):
        refusal(path)
        with pytest.raises(UserError, match=str(path)[:20]):
            load_scenario(path)


def test_the_name_of_a_file_cannot_forge_a_line(fuzzyq: Call, tmp_path: Path) -> None:
    assert r"a\nb\x1b[2J" in told(fuzzyq("replay", "a\nb\x1b[2J", cwd=tmp_path))


@pytest.mark.parametrize("out", ["file", "file/below", "/proc/nowhere", "/sys", "/dev/full"])
def test_a_folder_that_cannot_be_written(
    out: str, inside: Call, short: Path, tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("kept")
    line = refused(inside, "run", short, "--out", out, cwd=tmp_path)
    assert out in line
    assert "cannot be written" in line or "can be written" in line
    assert (tmp_path / "file").read_text() == "kept"
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_a_folder_in_the_place_of_a_file_is_told_before_the_drive(
    inside: Call, short: Path, tmp_path: Path
) -> None:
    (tmp_path / "short.mp4").mkdir()
    assert "short.mp4" in refused(inside, "run", short, "--out", tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["short.mp4"]


def limited(size: int) -> Callable[[], None]:
    """Return what makes every file of a child end at ``size`` bytes, as on a disk that is full."""

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

    return limit


@pytest.mark.slow
def test_no_room_for_the_record_leaves_nothing(
    installed: Call, short: Path, tmp_path: Path
) -> None:
    done = installed("run", short, "--no-video", "--out", tmp_path, preexec_fn=limited(3000))
    assert f"{tmp_path / 'short.npz'}: cannot be written: File too large" in told(done)
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_no_room_for_anything_is_told_in_one_line_too(
    installed: Call, short: Path, tmp_path: Path
) -> None:
    told(installed("run", short, "--no-video", "--out", tmp_path, preexec_fn=limited(0)))
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_no_room_for_the_video_leaves_the_older_one(
    installed: Call, filmed: Path, tmp_path: Path
) -> None:
    record, video = tmp_path / "short.npz", tmp_path / "short.mp4"
    record.write_bytes((filmed / "short.npz").read_bytes())
    video.write_bytes(b"an older one")
    line = told(installed("replay", record, preexec_fn=limited(20_000)))
    assert str(video) in line
    assert ".part" not in line
    assert video.read_bytes() == b"an older one"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["short.mp4", "short.npz"]


# --- records that nobody vouches for


def arrays_of(record: Path) -> dict[str, np.ndarray[Any, Any]]:
    with np.load(record) as archive:
        return dict(archive)


def written(path: Path, arrays: dict[str, Any]) -> Path:
    np.savez(path, **arrays)
    return path


def refusal(path: Path) -> str:
    with pytest.raises(UserError) as caught:
        Trajectory.load(path)
    (line,) = caught.value.problems
    assert "\n" not in line
    assert str(path) in line
    return line


def test_the_record_of_a_run_is_read_back_as_it_was(filmed: Path, tmp_path: Path) -> None:
    record = Trajectory.load(filmed / "short.npz")
    assert record.digest() == json.loads((filmed / "short.json").read_text())["digest"]
    record.save(tmp_path / "again.npz")
    assert Trajectory.load(tmp_path / "again.npz").digest() == record.digest()


def test_a_record_cut_short_anywhere_is_refused(filmed: Path, tmp_path: Path) -> None:
    content = (filmed / "short.npz").read_bytes()
    path = tmp_path / "cut.npz"
    for size in (0, 1, 100, len(content) // 2, len(content) - 30, len(content) - 1):
        path.write_bytes(content[:size])
        assert "damaged" in refusal(path)


def test_a_record_with_any_bit_turned_is_refused_or_read_without_a_crash(
    filmed: Path, tmp_path: Path
) -> None:
    content = (filmed / "short.npz").read_bytes()
    path = tmp_path / "turned.npz"
    rng = np.random.default_rng(0)
    for _ in range(150):
        turned = bytearray(content)
        turned[rng.integers(len(content))] ^= 1 << rng.integers(8)
        path.write_bytes(turned)
        with suppress(UserError):  # and nothing else; a bit that carries no meaning may turn
            Trajectory.load(path)


def test_other_files_are_no_records(inside: Call, filmed: Path, tmp_path: Path) -> None:
    foreign = tmp_path / "foreign.npz"
    np.savez(foreign, a=np.arange(3))
    assert "not a trajectory" in refusal(foreign)
    array = tmp_path / "array.npz"
    with array.open("wb") as stream:
        np.save(stream, np.arange(3))
    assert "damaged" in refusal(array)
    assert "is a video, not a record" in refused(inside, "replay", filmed / "short.mp4")


def test_nothing_in_a_record_is_executed(filmed: Path, tmp_path: Path) -> None:
    trap = tmp_path / "trap"

    class Trap:
        def __reduce__(self) -> tuple[Any, ...]:
            return (Path.touch, (trap,))

    arrays: dict[str, Any] = arrays_of(filmed / "short.npz")
    arrays["ticks.time"] = np.array([Trap()], dtype=object)
    refusal(written(tmp_path / "pickle.npz", arrays))
    assert not trap.exists()


@pytest.mark.slow
def test_a_record_that_unpacks_to_gigabytes_is_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "bomb.npz"
    header = io.BytesIO()
    np.lib.format.write_array_header_1_0(  # type: ignore[no-untyped-call, unused-ignore]
        header, {"descr": "<f8", "fortran_order": False, "shape": (1 << 28,)}
    )
    with (
        zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive,
        archive.open("ticks.time.npy", "w", force_zip64=True) as stream,
    ):
        stream.write(header.getvalue())
        for _ in range(65):
            stream.write(bytes(1 << 24))
    assert "too large" in refusal(path)
    # The same claim with nothing behind it.
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("ticks.time.npy", header.getvalue())
    assert "damaged" in refusal(path)


SPOILED: dict[str, Callable[[dict[str, Any]], dict[str, Any]]] = {
    "ticks.time is missing": lambda a: {k: v for k, v in a.items() if k != "ticks.time"},
    "ticks.position is of the wrong shape": lambda a: {"ticks.position": a["ticks.position"].T},
    "ticks.speed is of the wrong shape": lambda a: {"ticks.speed": a["ticks.speed"][:-1]},
    "decisions.rules is of the wrong shape": lambda a: {"decisions.rules": a["decisions.near"]},
    "ticks.time is of the wrong shape": lambda a: {"ticks.time": np.empty(0)},
    "ticks.heading holds float32": lambda a: {"ticks.heading": a["ticks.heading"].astype("f4")},
    "ticks.position holds": lambda a: {"ticks.position": a["ticks.position"] * np.nan},
    "ticks.position holds a": lambda a: {"ticks.position": a["ticks.position"] * 1e300},
    "ticks.time does not increase": lambda a: {"ticks.time": a["ticks.time"][::-1].copy()},
    "ticks.time spans more": lambda a: {"ticks.time": a["ticks.time"] * 1e5},
    "ticks.clearance holds": lambda a: {"ticks.clearance": a["ticks.clearance"] * np.nan},
    "decisions.tick does not run": lambda a: {"decisions.tick": a["decisions.tick"] + 10**6},
    "decisions.mode leaves": lambda a: {"decisions.mode": a["decisions.mode"] - 1},
    "decisions.step holds": lambda a: {"decisions.step": a["decisions.step"] + np.inf},
}


@pytest.mark.parametrize("words", SPOILED)
def test_arrays_that_no_run_leaves_are_refused(words: str, filmed: Path, tmp_path: Path) -> None:
    arrays = arrays_of(filmed / "short.npz")
    spoiled = SPOILED[words](arrays)
    whole = spoiled if "meta" in spoiled else {**arrays, **spoiled}
    assert words in refusal(written(tmp_path / "spoiled.npz", whole))


HEADS: dict[str, tuple[dict[str, Any], list[str]]] = {
    "format": ({"format": 99}, ["format 99", "reads 2"]),
    "outcome": ({"outcome": "victory"}, ["outcome"]),
    "steps": ({"physics_steps": -1}, ["physics_steps"]),
    "collision": ({"collision": {"time": 1.0}}, ["collision"]),
    "scenario": ({"scenario": None}, ["scenario"]),
    "no obstacle": (
        {"collision": {"time": 1.0, "point": [0, 0], "obstacle": 9, "normal_force": 0}},
        ["no obstacle 9"],
    ),
    "infinite": (
        {"collision": {"time": 1e999, "point": [0, 0], "obstacle": 0, "normal_force": 0}},
        ["collision", "finite"],
    ),
}


@pytest.mark.parametrize("name", HEADS)
def test_a_head_that_no_run_leaves_is_refused(name: str, filmed: Path, tmp_path: Path) -> None:
    change, words = HEADS[name]
    arrays = arrays_of(filmed / "short.npz")
    meta = {**json.loads(str(arrays["meta"])), **change}
    path = written(tmp_path / "head.npz", {**arrays, "meta": np.array(json.dumps(meta))})
    line = refusal(path)
    assert all(word in line for word in words), line


def test_a_scenario_inside_a_record_is_held_to_the_same_rules(filmed: Path, tmp_path: Path) -> None:
    arrays = arrays_of(filmed / "short.npz")
    for spoil, word in (
        (lambda s: s["goal"].update(position=[float("nan"), 0.0]), "goal.position"),
        (lambda s: s["planner"].update(name=7), "planner"),
        (lambda s: s["obstacles"].append({"shape": "box"}), "obstacles"),
        (lambda s: s.update(name="../../etc/passwd"), "name"),
    ):
        meta = json.loads(str(arrays["meta"]))
        spoil(meta["scenario"])
        path = written(tmp_path / "head.npz", {**arrays, "meta": np.array(json.dumps(meta))})
        assert f"scenario.{word}" in refusal(path)


@pytest.mark.slow
def test_an_explanation_may_be_odd_but_not_absurd(
    inside: Call, filmed: Path, tmp_path: Path
) -> None:
    """A planner of the user's own explains itself as it likes, within what a picture can show."""
    arrays = arrays_of(filmed / "short.npz")
    never_blank = {f"decisions.{name}" for name in ("tick", "mode", "heading", "step")}
    rng = np.random.default_rng(0)
    for name in sorted(set(arrays) - never_blank):
        if name.startswith("decisions."):
            arrays[name] = rng.choice([np.nan, 1e6, -1e6, 0.0, -3.0], arrays[name].shape)
            absurd = {**arrays, name: np.full(arrays[name].shape, 1e300)}
            assert f"{name} holds" in refusal(written(tmp_path / "absurd.npz", absurd))
    done = inside("replay", written(tmp_path / "odd.npz", arrays), "--speed", "20")
    assert (done.returncode, done.stderr) == (0, "")
