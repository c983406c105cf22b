"""VFH+: its grid, its histograms, its candidates, and what it steers to."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyq_bullet.geometry import Field, wrap_angle
from fuzzyq_bullet.planning import VfhPlanner, VfhSettings
from fuzzyq_bullet.planning.peers.surroundings import look_around
from fuzzyq_bullet.planning.peers.vfh import (
    ALPHA,
    SECTORS,
    CertaintyGrid,
    candidates_of,
    polar_histogram,
)
from tests.planning.peers.helpers import drive, moving

GOAL = (5.0, 0.0)


def field(*cylinders):
    return Field(np.array(cylinders, dtype=float).reshape(-1, 3), np.empty((0, 5)), None)


def settled(planner, observation, count=5):
    """What it decides once its grid is sure of what it sees."""
    for _ in range(count):
        decision = planner.decide(observation)
    return decision


def sectors(*runs):
    """Blocked sectors: from the first to the last of each run, both included."""
    blocked = np.zeros(SECTORS, dtype=bool)
    for first, last in runs:
        blocked[np.arange(first, last + 1) % SECTORS] = True
    return blocked


def test_with_nothing_in_the_way_it_makes_for_the_goal_at_full_speed():
    decision = VfhPlanner(VfhSettings()).decide(moving(field(), (0.0, 0.0), goal=(3.0, 4.0)))
    assert decision.heading == pytest.approx(math.atan2(4.0, 3.0))
    assert decision.step == pytest.approx(0.4)


def test_it_takes_the_opening_between_two_obstacles():
    gap = field((0.8, 0.75, 0.3), (0.8, -0.45, 0.3))  # their gap is at (0.8, 0.15)
    decision = settled(VfhPlanner(VfhSettings()), moving(gap, (0.0, 0.0), goal=GOAL))
    assert decision.heading == pytest.approx(math.atan2(0.15, 0.8), abs=math.radians(6.0))


def test_a_gap_narrower_than_the_robot_is_none():
    closed = field((0.6, 0.4, 0.3), (0.6, -0.4, 0.3))
    decision = settled(VfhPlanner(VfhSettings()), moving(closed, (0.0, 0.0), goal=GOAL))
    assert abs(decision.heading) > math.radians(40.0)


def test_a_narrow_opening_gives_its_middle_and_a_wide_one_its_edges_and_the_goal():
    around = sectors((4, 32), (40, 71))  # open: 0 to 3, and 33 to 39
    middles = [one % math.tau for one in candidates_of(around, goal=0.0, wide=16)]
    assert sorted(middles) == pytest.approx([1.5 * ALPHA, 36 * ALPHA])
    wide = sectors((30, 59))  # open: 60 to 71 and 0 to 29, 42 sectors
    found = [math.remainder(one, math.tau) for one in candidates_of(wide, goal=0.1, wide=16)]
    assert sorted(found) == pytest.approx([-4 * ALPHA, 0.1, 21 * ALPHA])
    behind = candidates_of(wide, goal=math.pi, wide=16)
    assert len(behind) == 2  # the goal lies in no opening


@given(st.integers(0, SECTORS - 1), st.integers(1, SECTORS - 1), st.floats(-3.1, 3.1))
def test_every_candidate_lies_in_an_opening(first, count, goal):
    blocked = sectors((first, first + count - 1))
    for heading in candidates_of(blocked, goal, 16):
        near = {math.floor(heading / ALPHA) % SECTORS, math.ceil(heading / ALPHA) % SECTORS}
        assert not all(blocked[sector] for sector in near)


def test_with_no_opening_there_is_no_candidate():
    assert candidates_of(np.ones(SECTORS, dtype=bool), 0.0, 16) == []


def test_a_cell_counts_in_the_sectors_that_the_robot_would_touch_it_in():
    density = polar_histogram(np.array([[0.43, 0.0]]), np.ones(1), 0.22, 1.22, 0.0)
    touched = np.flatnonzero(density)
    assert sorted((touched + 36) % SECTORS - 36) == list(range(-6, 7))  # arcsin(0.22 / 0.43) = 31°
    assert density[0] == 1.0  # m = c² where nothing is added for nearness


def test_a_near_cell_counts_more_and_an_uncertain_one_less():
    def density(x, certain):
        return polar_histogram(np.array([[x, 0.0]]), np.array([certain]), 0.22, 1.22, 4.0)[0]

    assert density(0.3, 1.0) > density(0.9, 1.0) > density(1.22, 1.0)
    assert density(1.22, 1.0) == pytest.approx(1.0)
    assert density(0.9, 0.5) == pytest.approx(0.25 * density(0.9, 1.0))


def test_between_the_thresholds_a_sector_stays_what_it_was():
    near, far = field((0.6, 0.0, 0.15)), field((1.0, 0.0, 0.15))
    planner = VfhPlanner(VfhSettings(high=14.0, low=5.0, steepness=4.0, safety=0.02))
    fresh = settled(
        VfhPlanner(VfhSettings(high=14.0, low=5.0, steepness=4.0, safety=0.02)),
        moving(far, (0.0, 0.0), goal=GOAL),
    )
    assert fresh.heading == pytest.approx(0.0)  # not dense enough to block
    blocked = settled(planner, moving(near, (0.0, 0.0), goal=GOAL))
    assert abs(blocked.heading) > 0.2
    still = settled(planner, moving(far, (0.0, 0.0), goal=GOAL))
    assert abs(still.heading) > 0.2  # and not thin enough to open again
    opened = settled(planner, moving(field(), (0.0, 0.0), goal=GOAL))
    assert opened.heading == pytest.approx(0.0)


def test_while_it_is_fast_it_does_not_turn_left_past_what_is_on_its_left():
    ahead_on_the_left = field((0.32, 0.38, 0.1))
    behind = (5.0 * math.cos(2.6), 5.0 * math.sin(2.6))
    settings = VfhSettings(turn_cost=0.0, change_cost=0.0)

    def heading(speed):
        seen = moving(ahead_on_the_left, (0.0, 0.0), goal=behind, speed=speed)
        return wrap_angle(settled(VfhPlanner(settings), seen).heading)

    assert heading(0.0) == pytest.approx(2.6)  # it can turn on the spot
    assert not 0.5 < heading(0.6) < 3.1  # its tightest turn to the left would meet the obstacle


def test_it_prefers_what_it_chose_before():
    wall = field((0.7, 0.0, 0.3))
    settings = VfhSettings(goal_cost=1.0, change_cost=10.0, turn_cost=0.0)
    for side in (1.0, -1.0):
        planner = VfhPlanner(settings)
        settled(planner, moving(field(), (0.0, 0.0), goal=(5.0, 5.0 * side)), 1)
        decision = settled(planner, moving(wall, (0.0, 0.0), goal=GOAL))
        assert wrap_angle(decision.heading) * side > 0.2


def test_the_grid_keeps_where_things_are_while_the_robot_moves():
    world = field((1.0, 0.0, 0.2))
    grid = CertaintyGrid(0.05, 1.22)
    for x in (0.0, 0.07, 0.13, 0.2):
        grid.add((x, 0.0), look_around(moving(world, (x, 0.0), goal=GOAL)))
    points, certain = grid.occupied((0.2, 0.0))
    apart = np.abs(np.hypot(points[:, 0] + 0.2 - 1.0, points[:, 1]) - 0.2)
    assert certain.max() == 1.0
    assert apart[certain == 1.0].max() < 0.05  # they are on the cylinder's rim, within a cell
    for _ in range(3):
        grid.add((0.2, 0.0), look_around(moving(field(), (0.2, 0.0), goal=GOAL)))
    assert len(grid.occupied((0.2, 0.0))[0]) == 0  # it has gone


def test_it_passes_one_obstacle():
    record = drive("vfh", [{"shape": "cylinder", "position": [5.0, 5.15], "radius": 0.3}])
    assert record.outcome == "goal"
    assert record.ticks.time[-1] < 18.0
    assert record.ticks.position[:, 1].min() < 4.7  # by the shorter side


def test_the_lower_threshold_is_not_above_the_upper():
    with pytest.raises(ValueError, match=r"must be at most high, 4\.0"):
        VfhSettings(high=4.0, low=5.0)
