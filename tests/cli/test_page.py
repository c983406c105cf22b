"""``fuzzyq page``: what it writes, where, and what it refuses."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from fuzzyq_bullet.errors import UserError
from tests.helpers import synthetic
from tests.helpers.commands import Call


@pytest.fixture(scope="module")
def record(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("record") / "drive.npz"
    synthetic.drive(seconds=3.0).save(path)
    return path


def test_a_page_lies_beside_its_record_and_is_made_anew(record: Path, inside: Call) -> None:
    done = inside("page", record)
    page = record.with_suffix(".html")
    assert (done.returncode, done.stdout) == (0, f"{page}\n")
    assert page.read_text(encoding="utf-8").startswith("<!doctype html>")
    assert inside("page", record).returncode == 0


def test_two_records_and_a_lesson_have_names_of_their_own(
    record: Path, inside: Call, tmp_path: Path
) -> None:
    other = tmp_path / "other.npz"
    synthetic.drive(seconds=2.0).save(other)
    assert inside("page", record, other, "--out", "new", cwd=tmp_path).returncode == 0
    assert (tmp_path / "new" / "drive-and-other.html").exists()
    assert inside("page", "--lesson", cwd=tmp_path).stdout == "out/lesson.html\n"
    inside("explain", "--export", "mine.fll", cwd=tmp_path)
    own = inside("page", "--lesson", "--rules", "mine.fll", cwd=tmp_path)
    assert own.stdout == "out/lesson-mine.html\n"


def test_somebody_elses_page_is_kept(record: Path, inside: Call, tmp_path: Path) -> None:
    mine = tmp_path / "drive.html"
    mine.write_text("my own")
    with pytest.raises(
        UserError, match=r"drive\.html: is there already, and not made by fuzzyq page"
    ):
        inside("page", record, "--out", tmp_path)
    assert mine.read_text() == "my own"
    assert inside("page", record, "--out", tmp_path, "--replace").returncode == 0


@pytest.mark.parametrize(
    ("given", "line"),
    [
        (lambda record: [], "RECORD: missing; give a record, or two, or --lesson"),
        (lambda record: [record, "--lesson"], "--lesson: takes no record"),
        (lambda record: [record, record, record], "RECORD: 3 are too many"),
        (lambda record: ["none.npz"], "none.npz: "),
    ],
)
def test_a_mistake_is_one_line(
    record: Path, inside: Call, given: Callable[[Path], list[object]], line: str, tmp_path: Path
) -> None:
    with pytest.raises(UserError) as caught:
        inside("page", *given(record), cwd=tmp_path)
    (problem,) = caught.value.problems
    assert problem.startswith(line)
    assert "\n" not in problem
    assert list(tmp_path.iterdir()) == []


def test_a_mistake_is_exit_code_2(fuzzyq: Call, tmp_path: Path) -> None:
    done = fuzzyq("page", cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
