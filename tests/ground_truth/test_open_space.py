"""Whether there is a way among very many obstacles: held against the exact answer among few."""

from __future__ import annotations

import pytest

from fuzzyq_bullet.ground_truth import feasible
from fuzzyq_bullet.ground_truth.open_space import has_open_space
from fuzzyq_bullet.recording.metrics import has_way, shortest_length
from fuzzyq_bullet.scenario import parse_scenario, random_task, realise
from fuzzyq_bullet.shapes import Polygon

WALL = """\
name: gap
arena: {{size: [6.0, 4.0], origin: [-3.0, -2.0], walls: {walls}}}
start: {{position: [-2.0, 0.0]}}
goal: {{position: [2.0, 0.0]}}
obstacles:
  - {{shape: polygon, points: [[0.0, -2.0], [0.3, -2.0], [0.3, 0.0], [0.1, -0.3], [0.0, 0.0]]}}
  - {{shape: box, position: [0.15, {middle}], size: [0.3, 1.0]}}
  - {{shape: cylinder, position: [0.15, 1.7], radius: 0.31}}
"""


@pytest.mark.parametrize(("gap", "open_"), [(0.3995, False), (0.4005, True)])
def test_a_gap_is_open_if_the_robot_fits_through(gap, open_):
    scenario = parse_scenario(WALL.format(walls="true", middle=gap + 0.5))
    assert has_open_space(scenario) is feasible(scenario) is open_
    around = parse_scenario(WALL.format(walls="false", middle=gap + 0.5))
    assert has_open_space(around) is feasible(around) is True


@pytest.mark.slow
def test_it_agrees_with_the_exact_answer():
    told = [
        (has_open_space(task), feasible(task))
        for task in (realise(random_task(seed, count=125)) for seed in range(30))
    ]
    assert all(one == other for one, other in told)
    assert 0 < sum(one for one, _ in told) < len(told)


def test_it_is_told_where_the_shortest_path_is_not_looked_for():
    scenario = parse_scenario(WALL.format(walls="true", middle=0.901))
    row = [(0.01 * k, 2.0 - 0.002 * (k % 2)) for k in range(-150, 150)]
    lid = Polygon(shape="polygon", points=[(-1.5, 2.0 + 0.5), *row, (1.5, 2.5)])
    crowded = scenario.model_copy(update={"obstacles": (*scenario.obstacles, *[lid] * 11)})
    assert has_way(crowded) is True
    assert shortest_length(crowded) is None
