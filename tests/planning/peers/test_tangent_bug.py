"""TangentBug: the tangent graph, boundary following, and goals that cannot be reached."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fuzzyq_bullet import result_of
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.planning import TangentBugPlanner, TangentBugSettings
from fuzzyq_bullet.planning.peers.tangent_bug import nodes_of, view_of
from tests.planning.peers.helpers import drive, drive_bundled, modes_of, moving

CYLINDER = {"shape": "cylinder", "position": [5.0, 5.05], "radius": 0.4}
TRAP = [
    {"shape": "box", "position": [5.5, 5.0], "size": [0.2, 2.2]},
    {"shape": "box", "position": [5.0, 6.0], "size": [1.0, 0.2]},
    {"shape": "box", "position": [5.0, 4.0], "size": [1.0, 0.2]},
]
RING = [
    {"shape": "box", "position": [7.0, 6.0], "size": [2.2, 0.2]},
    {"shape": "box", "position": [7.0, 4.0], "size": [2.2, 0.2]},
    {"shape": "box", "position": [6.0, 5.0], "size": [0.2, 2.2]},
    {"shape": "box", "position": [8.0, 5.0], "size": [0.2, 2.2]},
]


def field(*cylinders):
    return Field(np.array(cylinders, dtype=float).reshape(-1, 3), np.empty((0, 5)), None)


def test_where_the_goal_is_in_sight_it_goes_straight():
    decision = TangentBugPlanner(TangentBugSettings()).decide(
        moving(field(), (0.0, 0.0), goal=(0.5, 0.5))
    )
    assert decision.heading == pytest.approx(math.pi / 4)


def test_the_nodes_are_both_tangents_of_an_obstacle():
    seen = moving(field((0.8, 0.0, 0.2)), (0.0, 0.0), goal=(5.0, 0.0))
    right, left = sorted(nodes_of(view_of(seen), seen), key=lambda node: node.heading > math.pi)[
        ::-1
    ]
    tangent = math.asin(0.42 / 0.8)  # of the cylinder grown by half a line's width
    assert left.heading == pytest.approx(tangent, abs=math.radians(4.0))
    assert right.heading - math.tau == pytest.approx(-tangent, abs=math.radians(4.0))
    assert (left.side, right.side) == (1, -1)


def test_it_takes_the_node_of_the_shorter_way():
    for y in (0.1, -0.1):
        seen = moving(field((0.8, y, 0.2)), (0.0, 0.0), goal=(5.0, 0.0))
        decision = TangentBugPlanner(TangentBugSettings()).decide(seen)
        assert math.copysign(1.0, math.sin(decision.heading)) == -math.copysign(1.0, y)
        assert decision.mode == "routine"


def test_round_one_convex_obstacle_its_path_is_hardly_longer_than_the_shortest():
    record = drive("tangent-bug", [CYLINDER])
    assert record.outcome == "goal"
    assert "following" not in modes_of(record)  # the distance to the goal always falls
    assert result_of(record).spl > 0.95


def test_it_leaves_a_concave_trap_by_following_its_boundary():
    record = drive("tangent-bug", TRAP)
    assert record.outcome == "goal"
    modes = modes_of(record)
    assert "following" in modes
    assert modes[-1] == "routine"
    result = result_of(record)
    # At most once from the back of the trap round one leg, 1.6 m there and 1.6 m on the outside.
    assert result.path_length_m < result.shortest_path_m + 3.5


def test_it_goes_once_round_a_goal_that_is_walled_in_and_says_so():
    record = drive("tangent-bug", RING, goal={"position": [7.0, 5.0]})
    assert record.outcome == "stuck"
    assert modes_of(record)[-1] == "following"
    # It is not that it stood for too long: a second before, it was still on its way.
    assert math.dist(record.ticks.position[-1], record.ticks.position[-20]) > 0.1
    ring = 4.0 * 2.2 + math.tau * 0.25
    way = result_of(record).path_length_m
    assert 5.0 + ring < way + 0.5
    assert way < 5.0 + 1.35 * ring


@pytest.mark.slow
def test_it_gets_out_of_the_bundled_traps():
    for name in ("semicircle", "u-shape", "rooms"):
        assert drive_bundled(name, "tangent-bug").outcome == "goal"
