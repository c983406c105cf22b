"""The shortest path to the goal that what was seen leaves open, and who drives along it."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.planning.escape.cost_to_go import CELL, ObstacleMap
from fuzzyq_bullet.planning.escape.escape import Escape
from fuzzyq_bullet.planning.escape.open_path import open_path
from tests.helpers.exploring import WIDE, observe

START, GOAL = (0.05, 0.05), (4.05, 0.05)


def points(*ends):
    """Return points every 2 cm along straight lines, as rays would hit them."""
    return np.concatenate(
        [np.linspace(a, b, max(2, round(math.dist(a, b) / 0.02))) for a, b in ends]
    )


def seen(*ends):
    obstacles = ObstacleMap()
    obstacles.add(np.array(ends), points(*ends), WIDE)
    return obstacles


def length(path):
    return sum(math.dist(a, b) for a, b in pairwise(path))


def clearance(path, hits):
    along = points(*pairwise(path))
    return np.hypot(*(along[:, None] - hits[None]).transpose(2, 0, 1)).min()


def test_through_what_was_not_seen_it_leads_straight():
    path = open_path(ObstacleMap(), START, GOAL)
    assert path is None  # nothing is known, not even how wide the robot is
    path = open_path(seen(((2.0, 3.0), (2.0, 4.0))), START, GOAL)
    assert path is not None
    assert (path[0], path[-1]) == (START, GOAL)
    assert length(path) == pytest.approx(4.0, abs=CELL)
    assert max(math.dist(a, b) for a, b in pairwise(path)) <= 7 * CELL


def test_it_leads_round_a_pocket_that_was_seen_with_room_for_the_disc():
    pocket = ((2.0, -1.0), (2.0, 1.0)), ((1.0, 1.0), (2.0, 1.0)), ((1.0, -1.0), (2.0, -1.0))
    path = open_path(seen(*pocket), START, GOAL)
    assert path is not None
    # Past two corners, half of the room of the disc away from each at least.
    assert math.dist((1.0, 1.0), START) + math.dist((2.0, 1.0), GOAL) < length(path) < 6.0
    assert clearance(path, points(*pocket)) > WIDE - 1.5 * CELL
    assert not any(1.0 < x < 2.0 and abs(y) < 1.0 for x, y in path)


def turned(point, angle, by=(0.0, 0.0)):
    (x, y), cos, sin = point, math.cos(angle), math.sin(angle)
    return x * cos - y * sin + by[0], x * sin + y * cos + by[1]


SHIFTS = [(0.0, 0.0), (0.03, 0.07), (0.05, 0.02)]
ANGLES = np.radians([0.0, 12.0, 30.0, 45.0, 77.0])


@pytest.mark.parametrize("shift", SHIFTS)
@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize("wider", [0.01, -0.01])
def test_a_gap_is_open_if_the_disc_gets_through_wherever_the_cells_lie(wider, angle, shift):
    """Between the round ends of two walls: of an edge, the very end may not be among the hits."""
    middle = WIDE + wider / 2 + 0.1
    above = np.array([0.0, middle])
    around = np.linspace(0.0, math.tau, 40)
    ends = 0.1 * np.column_stack([np.cos(around), np.sin(around)])
    wall = points(((0.0, -3.0), (0.0, -middle)), ((0.0, middle), (0.0, 3.0)))
    hits = np.concatenate([wall, ends + above, ends - above])
    hits = np.column_stack(turned(hits.T, angle, shift))
    obstacles = ObstacleMap()
    obstacles.add(hits[None, :2], hits, WIDE)
    path = open_path(obstacles, turned((-2.0, 0.0), angle), turned((2.0, 0.0), angle))
    assert path is not None
    assert (length(path) < 4.5) is (wider > 0.0)


@pytest.mark.parametrize("shift", SHIFTS)
@pytest.mark.parametrize("angle", ANGLES)
def test_between_posts_that_stand_too_close_leads_no_path(angle, shift):
    """All around the robot a post every 0.43 m, which its disc of 0.44 m does not get through."""
    around = math.tau * np.arange(30) / 30 + angle
    posts = 0.43 / (2 * math.sin(math.pi / 30)) * np.column_stack([np.cos(around), np.sin(around)])
    obstacles = ObstacleMap()
    obstacles.add(np.array([[posts[0], posts[0]]]), posts + shift, WIDE)
    assert open_path(obstacles, shift, (6.0, 0.0)) is None


def test_a_fast_robot_goes_round_where_a_slow_one_squeezes_through():
    gap = 2 * WIDE + 0.02
    obstacles = seen(((2.0, -3.0), (2.0, -gap / 2)), ((2.0, gap / 2), (2.0, 1.3)))
    through, around = (open_path(obstacles, (0.0, 0.0), (4.0, 0.0), speed) for speed in (0.6, 2.0))
    assert length(through) < 4.3 < 5.0 < length(around) < 5.8


def test_where_what_was_seen_encloses_the_robot_there_is_none():
    corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)]
    assert open_path(seen(*pairwise(corners)), START, GOAL) is None


@pytest.mark.parametrize("aside", [0.013, 0.05, 0.087])
def test_what_is_known_elsewhere_opens_no_gap_that_was_closed(aside):
    """The cells do not move when the map grows: the robot would go to and fro."""
    for gap in np.arange(0.36, 0.5, 0.02):
        wall = ((2.0, -3.0), (2.0, -gap / 2)), ((2.0, gap / 2), (2.0, 3.0))
        obstacles = seen(*wall)
        before = open_path(obstacles, (0.0, 0.0), (4.0, 0.0))
        far = np.array([[[-5.0 - aside, -6.0], [-5.0, -6.0 + aside]]])
        obstacles.add(far, far[0], WIDE)
        after = open_path(obstacles, (0.0, 0.0), (4.0, 0.0))
        assert before is not None
        assert after is not None
        assert length(after) == pytest.approx(length(before))


POCKET = Field(boxes=np.array([[2.4, 0.0, 0.2, 2.2, 0.0], [1.9, 1.0, 1.0, 0.2, 0.0]]))


def test_who_sees_far_goes_round_a_pocket_before_it_is_in_it():
    def aim(far):
        seen = observe(POCKET, (0.0, 0.0), goal=(6.0, 0.0))
        free, look = (
            lambda headings: POCKET.free_distance((0.0, 0.0), headings, WIDE, far),
            lambda headings: POCKET.free_distance((0.0, 0.0), headings, 0.0, far + WIDE),
        )
        sensor = type(seen.sensor)(free, look)
        return Escape().aim(replace(seen, range=far, sensor=sensor), 4.0)

    near, far = aim(1.0), aim(3.0)
    assert near.mode == "routine"  # nothing to be seen of it yet
    assert far.mode == "breakout"
    assert far.bearing < -math.radians(20.0)  # round its open side
    assert far.target == far.point
    assert POCKET.free_distance((0.0, 0.0), [far.bearing], WIDE, 10.0)[0] >= far.distance


def test_where_the_open_path_cannot_be_driven_it_goes_to_frontiers():
    """The sensor tells the disc of nothing free, though rays get through: no progress."""
    escape, modes, targets = Escape(), [], []
    for k in range(100):
        seen = observe(POCKET, (0.0, 0.0), goal=(6.0, 0.0), time=0.05 * k * 10)
        sensor = type(seen.sensor)(
            lambda headings: [0.0] * len(headings),
            lambda headings: POCKET.free_distance((0.0, 0.0), headings, 0.0, 3.0 + WIDE),
        )
        aim = escape.aim(replace(seen, range=3.0, sensor=sensor), 4.0)
        modes.append(aim.mode)
        targets.append(aim.target)
        if aim.hopeless:
            break
    assert aim.hopeless  # it has tried every frontier too, and says so
    assert "following" in modes
