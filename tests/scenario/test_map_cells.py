"""Maps of cells keep every edge: what is blocked in the map is blocked in the scenario."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from PIL import Image

from fuzzyq_bullet import UserError
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.scenario import Scenario
from fuzzyq_bullet.scenario.importers import import_map, options_of

MAPS = Path(__file__).parent / "maps"
YAML = "image: a.png\nresolution: {cell}\norigin: [{x}, {y}, {yaw}]\nnegate: 0\n"


def centres(grid: np.ndarray, cell: float, x: float, y: float, yaw: float) -> np.ndarray:
    rows, columns = np.indices(grid.shape)
    own = np.stack([columns.ravel() + 0.5, rows.ravel() + 0.5], axis=1) * cell
    cos, sin = math.cos(yaw), math.sin(yaw)
    return own @ np.array([[cos, sin], [-sin, cos]]) + (x, y)


def covered(scenario: Scenario) -> tuple[float, float]:
    """The area of all obstacles (m²): of their union, and one by one."""
    polygons = [shapely.Polygon(one.outline()) for one in scenario.obstacles]
    return shapely.union_all(polygons).area, sum(one.area for one in polygons)


@settings(max_examples=40)
@given(
    grid=arrays(bool, st.tuples(st.integers(3, 14), st.integers(3, 14)), elements=st.booleans()),
    cell=st.sampled_from([0.03, 0.05, 0.37]),
    yaw=st.sampled_from([0.0, 0.3, -1.2, math.pi / 2, math.pi]),
)
def test_every_cell_of_a_ros_map_is_as_it_was_and_no_edge_has_moved(
    tmp_path_factory: pytest.TempPathFactory, grid: np.ndarray, cell: float, yaw: float
) -> None:
    folder = tmp_path_factory.mktemp("map")
    # Free cells below, so that a start and a goal have room: the property is about the others.
    grid = np.concatenate([np.zeros((int(2 / cell), grid.shape[1]), dtype=bool), grid])
    grid = np.pad(grid, ((0, 0), (0, max(0, int(2 / cell) - grid.shape[1]))))
    Image.fromarray(np.where(grid, 0, 254).astype(np.uint8)[::-1]).save(folder / "a.png")
    (folder / "a.yaml").write_text(YAML.format(cell=cell, x=-3.5, y=2.25, yaw=yaw))
    cos, sin = math.cos(yaw), math.sin(yaw)

    def place(x: float, y: float) -> str:
        return f"{-3.5 + cos * x - sin * y},{2.25 + sin * x + cos * y}"

    asked = options_of(start=place(0.5, 0.5), goal=place(1.2, 0.7), unknown="free")
    scenario = import_map(folder / "a.yaml", asked).scenario
    field = Field.of(scenario.obstacles)
    inside = field.clearance(centres(grid, cell, -3.5, 2.25, yaw)) < 0.0
    assert np.array_equal(inside.reshape(grid.shape), grid)
    union, sum_of_all = covered(scenario)
    assert union == pytest.approx(grid.sum() * cell**2, abs=1e-6)
    assert sum_of_all == pytest.approx(union, abs=1e-6)  # none lies over another


def test_a_turned_ros_map_keeps_its_coordinates_and_is_closed_beyond_its_edge() -> None:
    asked = {"start": "-1.18,5.81", "goal": "0.9,2.63"}
    blocked = import_map(MAPS / "lab.yaml", options_of(**asked))
    assert blocked.changed == ("28 unknown cells of 1200: taken as blocked (--unknown)",)
    field = Field.of(blocked.scenario.obstacles)
    assert blocked.scenario.arena.bounds.left == pytest.approx(-2.0 - 4.5 * math.sin(0.4))
    assert blocked.scenario.arena.bounds.bottom == 1.0
    beyond, unknown = (-3.5, 1.2), (-2.0 + 5.3 * math.cos(0.4) - 4 * math.sin(0.4), 6.75)
    assert field.clearance([beyond])[0] < 0.0
    assert field.clearance([unknown])[0] < 0.0
    free = import_map(MAPS / "lab.yaml", options_of(**asked, unknown="free"))
    assert Field.of(free.scenario.obstacles).clearance([beyond, unknown]).min() > 0.0


def test_few_shapes_stand_for_many_cells(tmp_path: Path) -> None:
    grid = np.zeros((60, 80), dtype=bool)
    grid[:2] = grid[-2:] = grid[:, :2] = grid[:, -2:] = True  # a frame: a hole to be cut open
    grid[20:24, 10:60] = grid[20:50, 40:43] = True  # a T
    grid[40:45, 10:20] = True  # a rectangle
    Image.fromarray(np.where(grid, 0, 255).astype(np.uint8)[::-1]).save(tmp_path / "a.png")
    asked = options_of(resolution=0.1, start="1,1", goal="7,1")
    found = import_map(tmp_path / "a.png", asked).scenario.obstacles
    assert sorted(one.shape for one in found) == ["box", "polygon", "polygon", "polygon"]


def test_a_part_of_a_map_is_cut_out_exactly(tmp_path: Path) -> None:
    grid = np.zeros((50, 50), dtype=bool)
    grid[10:40, 30:34] = grid[36:40, 10:34] = True
    Image.fromarray(np.where(grid, 0, 255).astype(np.uint8)[::-1]).save(tmp_path / "a.png")
    asked = options_of(resolution=0.1, start="1.6,1.6", goal="2.2,2.5", crop="1.25,1.25,3.25,3.25")
    scenario = import_map(tmp_path / "a.png", asked).scenario
    assert scenario.arena.origin == (1.25, 1.25)
    assert scenario.arena.size == (2.0, 2.0)
    assert covered(scenario)[0] == pytest.approx(0.25 * 2.0)


def test_specks_are_grown_and_named(tmp_path: Path) -> None:
    grid = np.full((400, 400), 255, dtype=np.uint8)
    grid[100, 100] = 0
    Image.fromarray(grid).save(tmp_path / "a.png")
    asked = options_of(resolution=0.005, start="0.4,0.4", goal="1.2,0.5")
    found = import_map(tmp_path / "a.png", asked)
    assert found.changed == ("1 specks thinner than 0.02 m: grown to that",)
    assert covered(found.scenario)[0] == pytest.approx(0.02**2)


def test_too_many_obstacles_are_one_line_that_says_what_to_do(tmp_path: Path) -> None:
    noise = np.random.default_rng(1).random((500, 500)) < 0.3
    Image.fromarray(np.where(noise, 0, 255).astype(np.uint8)).save(tmp_path / "a.png")
    with pytest.raises(UserError) as raised:
        import_map(tmp_path / "a.png", options_of(resolution=0.05, start="1,1", goal="2,2"))
    (line,) = raised.value.problems
    assert "at most 10000; take a part of it with --crop X0,Y0,X1,Y1" in line
