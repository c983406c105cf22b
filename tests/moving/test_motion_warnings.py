"""Ways of moving obstacles that are hardly meant are told before a run; they are no mistake."""

from __future__ import annotations

from pathlib import Path

import pytest

from fuzzyq_bullet.early_warnings import early_warnings
from fuzzyq_bullet.scenario import load_scenario, realise
from tests.moving.test_moving import ROOM, disc

WALL_BOX = "shape: box, position: [3.0, 3.005], size: [1.0, 0.2]"
UP = "kind: patrol, points: [[3, 1], [3, 3.7]], speed: 0.5"
"""A disc of 0.25 m is in ``WALL_BOX`` after 3.32 s; in a wall, if it went on, after 5.5 s."""


def told(folder: Path, *obstacles: str, more: str = "") -> list[str]:
    path = folder / "room.yaml"
    lines = "".join(f"  - {{{one}}}\n" for one in obstacles)
    path.write_text(f"{ROOM}obstacles:\n{lines}{more}")
    scenario = load_scenario(path)
    found = early_warnings(str(path), scenario, realise(scenario))
    return [line.removeprefix(f"{path}:") for line in found]


def test_a_way_through_what_stands_and_out_is_told_at_its_line(tmp_path: Path) -> None:
    assert told(tmp_path, WALL_BOX, disc(3.0, 1.0, UP.replace("3.7", "3.9"))) == [
        "7: obstacles[1].motion: goes into obstacles[0], which stands still, after 3.3 s, its "
        "centre at (3.00, 2.66)",
        "7: obstacles[1].motion: goes into a wall after 5.5 s, its centre at (3.00, 3.76)",
    ]


@pytest.mark.parametrize(
    "motion",
    [
        "kind: circle, centre: [3.0, 2.0], speed: 0.5",
        "kind: trace, poses: [[0, 3, 1, 0], [4, 3, 3, 0]]",
    ],
)
def test_circles_and_traces_are_looked_at_too(motion: str, tmp_path: Path) -> None:
    [line] = told(tmp_path, disc(3.0, 1.0, motion), WALL_BOX)
    assert "goes into obstacles[1], which stands still, after" in line


def test_what_only_touches_or_passes_is_not_told(tmp_path: Path) -> None:
    beside = disc(3.75, 1.0, "kind: patrol, points: [[3.75, 1], [3.75, 3.75]], speed: 0.5")
    assert told(tmp_path, beside, WALL_BOX) == []
    through = disc(2.0, 1.0, "kind: patrol, points: [[2, 1], [5, 1]], speed: 0.5")
    assert told(tmp_path, through, disc(3.0, 0.5, "kind: wander, speed: 0.5")) == []


def test_a_box_that_turns_is_where_it_has_turned_to(tmp_path: Path) -> None:
    bar = "shape: box, position: [3.0, 1.0], size: [1.6, 0.1], motion: {%s}"
    poses = "kind: trace, poses: [[0, 3, 1, 0], [%s, 3, 1, %s]]"
    assert told(tmp_path, bar % (poses % (5, 1.0)), WALL_BOX) == []
    # Upright, 0.8 m from the centre: 0.2 m of it are left to the wall below, and it is near no box.
    assert told(tmp_path, bar % (poses % (8, 1.57)), WALL_BOX) == []
    [line] = told(tmp_path, (bar % (poses % (8, 1.57))).replace("1.6", "2.2"), WALL_BOX)
    assert "goes into a wall" in line
    # Turned to the left, the long corner of a wedge is below; turned to the right, beside it.
    wedge = "shape: polygon, points: [[3.0, 0.4], [4.9, 1], [4.9, 1.6], [3.0, 1.6]], motion: {%s}"
    assert told(tmp_path, wedge % (poses % (8, -0.785))) == []
    [line] = told(tmp_path, wedge % (poses % (8, 0.785)))
    assert "goes into a wall" in line
    pillar = "shape: cylinder, position: [3.0, 1.7], radius: 0.2"
    [line] = told(tmp_path, bar % (poses % (8, 1.57)), pillar)
    assert "goes into obstacles[1]" in line


def test_without_walls_what_is_told_is_that_it_leaves(tmp_path: Path) -> None:
    open_air = ROOM.replace("4.0]}", "4.0], walls: false}")
    path = tmp_path / "open.yaml"
    for top, words in (
        (3.9, []),
        (4.2, ["leaves the arena after 6.0 s, its centre at (3.00, 4.01)"]),
    ):
        path.write_text(
            f"{open_air}obstacles:\n  - {{{disc(3, 1, UP.replace('3.7', str(top)))}}}\n"
        )
        scenario = load_scenario(path)
        lines = early_warnings(str(path), scenario, realise(scenario))
        assert [line.split("motion: ")[1] for line in lines] == words


def test_who_meets_the_robot_at_once_is_told(tmp_path: Path) -> None:
    # 0.55 m of way until the two discs touch.
    motion = "kind: patrol, points: [[2, 2], [0.3, 2]], speed: %s"
    [line] = told(tmp_path, disc(2.0, 2.0, motion % 0.6))
    assert line.startswith("6: obstacles[0].motion: meets the robot at the start after 0.9 s")
    assert told(tmp_path, disc(2.0, 2.0, motion % 0.5)) == []  # after 1.1 s it may be gone
    assert told(tmp_path, disc(2.0, 2.0, motion % 0.6 + ", stops_for_robot: true")) == []


def test_what_happens_after_the_run_is_over_is_not_told(tmp_path: Path) -> None:
    mover = disc(3.0, 1.0, UP)
    limits = "limits: {time: 3.0}\nexpect: {outcome: timeout}\n"
    assert len(told(tmp_path, mover, WALL_BOX)) == 1
    assert told(tmp_path, mover, WALL_BOX, more=limits) == []


def test_what_is_drawn_is_named_as_such(tmp_path: Path) -> None:
    mover = disc(3.0, 1.0, "kind: patrol, points: [[3, 1], [3, 3.5], [0.5, 3.5]], speed: 0.5")
    [line] = told(tmp_path, mover, more="random: {count: 12, radius: 0.2}\n")
    assert "(drawn), which stands still" in line
