"""Files are written whole or not at all, and what goes wrong is one clear line."""

import shutil

import pytest

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import write_text


def test_a_name_too_long_is_one_clear_line(tmp_path):
    with pytest.raises(UserError, match="cannot be written: File name too long"):
        write_text(tmp_path / ("a" * 300), "text")
    assert list(tmp_path.iterdir()) == []


def test_what_stood_there_is_kept_when_the_new_text_cannot_be_written(tmp_path):
    path = tmp_path / "kept.txt"
    write_text(path, "old")
    with pytest.raises(UnicodeEncodeError):
        write_text(path, "new \ud800")
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_an_interrupt_while_it_tidies_up_leaves_nothing(tmp_path, monkeypatch):
    rmtree, interrupted = shutil.rmtree, []

    def interrupted_once(folder, **more):
        if not interrupted:
            interrupted.append(folder)
            raise KeyboardInterrupt
        rmtree(folder, **more)

    monkeypatch.setattr("fuzzyq_bullet.files.shutil.rmtree", interrupted_once)
    with pytest.raises(KeyboardInterrupt):
        write_text(tmp_path / "a.txt", "whole")
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]
