"""Training with another robot, in an arena that does not begin at (0, 0)."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from fuzzyq_bullet.cli.app import app
from fuzzyq_bullet.errors import UserError

FIELD = (
    "name: s\nstart: {position: [-40, 31]}\ngoal: {position: [-38, 33]}\n"
    "arena: {size: [10, 8], origin: [-42, 30]}\n"
)


@pytest.mark.slow
def test_it_trains_there(tmp_path: Path) -> None:
    file, policy = tmp_path / "s.yaml", tmp_path / "s.json"
    file.write_text(FIELD + "robot: {model: turtlebot3-burger}\n")
    order = ["train", "fuzzy-q-lambda", "--scenario", str(file), "--episodes", "2"]
    assert not app([*order, "--out", str(policy)], standalone_mode=False)
    assert json.loads(policy.read_text())


def test_via_points_are_refused_in_one_line(tmp_path: Path) -> None:
    file = tmp_path / "s.yaml"
    file.write_text(FIELD + "via: [{position: [-38, 31]}]\n")
    order = ["train", "fuzzy-q-lambda", "--scenario", str(file), "--out", str(tmp_path / "p.json")]
    with pytest.raises(UserError, match="leave out the via points") as told:
        app(order, standalone_mode=False)
    assert len(told.value.problems) == 1
