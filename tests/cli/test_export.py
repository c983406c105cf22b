"""``fuzzyq export``: a record as tables that any spreadsheet reads."""

from __future__ import annotations

import csv
import sys
from pathlib import Path

import numpy as np
import pytest

from fuzzyq_bullet import Trajectory, UserError, load_scenario, run, with_options
from fuzzyq_bullet.recording.trajectory import DECISIONS, TICKS
from tests.helpers.commands import Call


@pytest.fixture(scope="module")
def record(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("record") / "sparse.npz"
    run(with_options(load_scenario("sparse"), drive="kinematic")).save(path)
    return path


def test_both_tables_read_back_with_their_units(record: Path, inside: Call, tmp_path: Path) -> None:
    done = inside("export", record, "--csv", "--out", "tables", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    paths = [Path(line) for line in done.stdout.splitlines()]
    assert [path.name for path in paths] == ["sparse-ticks.csv", "sparse-decisions.csv"]
    trajectory = Trajectory.load(record)
    ticks, decisions = (
        list(csv.reader((tmp_path / path).read_text().splitlines())) for path in paths
    )
    assert ticks[0][:5] == ["time [s]", "position_x [m]", "position_y [m]", "heading [rad]",
                            "speed [m/s]"]  # fmt: skip
    assert [float(row[4]) for row in ticks[1:]] == trajectory.ticks.speed.tolist()
    for table, columns in ((ticks, TICKS), (decisions, DECISIONS)):
        named = [(name, one.unit) for key, one in columns.items() for name in one.names(key)]
        assert table[0] == [f"{name} [{unit}]" if unit else name for name, unit in named]
    mode = [row[decisions[0].index("mode")] for row in decisions[1:]]
    assert set(mode) <= {"routine", "breakout", "following"}
    assert len(mode) == np.size(trajectory.decisions.heading)


def test_without_out_the_tables_lie_beside_the_record(record: Path, inside: Call) -> None:
    assert inside("export", record, "--csv").returncode == 0
    assert record.with_name("sparse-ticks.csv").exists()


def test_both_forms_at_once(record: Path, inside: Call, tmp_path: Path) -> None:
    done = inside("export", record, "--csv", "--mcap", "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    names = [Path(line).name for line in done.stdout.splitlines()]
    assert names == ["sparse-ticks.csv", "sparse-decisions.csv", "sparse.mcap"]
    assert sorted(names) == sorted(path.name for path in tmp_path.iterdir())
    assert (tmp_path / "sparse.mcap").read_bytes().startswith(b"\x89MCAP0\r\n")
    assert inside("export", record, "--mcap", "--out", tmp_path / "alone").returncode == 0
    assert [path.name for path in (tmp_path / "alone").iterdir()] == ["sparse.mcap"]


def test_without_the_extra_one_line_says_what_to_install(
    record: Path, inside: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in [name for name in sys.modules if name.startswith("fuzzyq_bullet.export.")]:
        monkeypatch.delitem(sys.modules, name)
    for name in ("foxglove", "foxglove.messages", "foxglove.channels", "foxglove.mcap"):
        monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(UserError) as error:
        inside("export", record, "--mcap", "--csv", "--out", tmp_path)
    assert error.value.problems == (
        "--mcap: foxglove-sdk is not installed: pip install 'fuzzyq_bullet[mcap]'",
    )
    assert list(tmp_path.iterdir()) == []


def test_a_mistake_is_one_line(record: Path, fuzzyq: Call, tmp_path: Path) -> None:
    done = fuzzyq("export", record)
    assert (done.returncode, done.stderr) == (
        2,
        "error: nothing to export: --csv or --mcap says in which form\n",
    )
    mine = tmp_path / "sparse-ticks.csv"
    mine.write_text("my own")
    done = fuzzyq("export", record, "--csv", "--out", tmp_path)
    assert done.returncode == 2
    assert "is there already" in done.stderr
    assert mine.read_text() == "my own"
    assert fuzzyq("export", record, "--csv", "--out", tmp_path, "--replace").returncode == 0
    done = fuzzyq("export", tmp_path / "none.npz", "--csv")
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
