"""Among moving obstacles the map forgets what it sees through; elsewhere it forgets nothing."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import pytest

from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.planning.escape.exploration import ExplorationGraph
from fuzzyq_bullet.shapes import Box
from tests.helpers.exploring import observe

HERE, GOAL = (0.05, 0.05), (2.05, 0.05)
WALL = Box(shape="box", position=(0.7, 0.05), size=(0.1, 1.2))
POST = Box(shape="box", position=(0.05, 0.9), size=(0.1, 0.1))


def path_after(*fields, closing_speed):
    """Return the length (m) of the open path after a scan of each field in turn."""
    graph = ExplorationGraph()
    for field in fields:
        graph.scan(replace(observe(field, HERE), closing_speed=closing_speed))
    path = graph.open_path(observe(fields[-1], HERE, goal=GOAL))
    return sum(math.dist(a, b) for a, b in pairwise(path))


@pytest.mark.parametrize("closing_speed", [0.0, 0.5])
def test_a_wall_that_was_seen_is_gone_round(closing_speed):
    assert path_after(Field.of([WALL, POST]), closing_speed=closing_speed) > 2.2


def test_a_wall_that_has_moved_away_is_forgotten():
    shut, opened = Field.of([WALL, POST]), Field.of([POST])
    assert path_after(shut, opened, closing_speed=0.5) < 2.05
    assert path_after(shut, opened, closing_speed=0.0) > 2.2
