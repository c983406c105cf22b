"""The search that tunes the peers goes on where it was interrupted."""

from __future__ import annotations

import runpy
import sys
from pathlib import Path

EXAMPLE = Path(__file__).resolve().parents[3] / "examples" / "tune_peers.py"


def test_what_was_run_already_is_not_run_again(tmp_path, monkeypatch, capsys):
    def told(*more):
        arguments = ["dwa", "--fields", "1", "--time", "1", "--jobs", "1", *more]
        out = ["--out", str(tmp_path / "rows.jsonl")]
        monkeypatch.setattr(sys, "argv", ["tune_peers.py", *arguments, *out])
        runpy.run_path(str(EXAMPLE), run_name="__main__")
        return capsys.readouterr().out.splitlines()

    first = told("--settings", "1")
    assert first[0].startswith("1 episodes run")
    assert first[1].split() == ["0", "0", "1.0", "s", "{}"]  # in a second it gets nowhere
    assert told("--settings", "2")[0].startswith("1 episodes run")
    assert told("--settings", "2")[0].startswith("0 episodes run")
    [head, only] = told("--given", '{"heading": 2.0}')
    assert head.startswith("1 episodes run")
    assert only.endswith('{"heading": 2.0}')
