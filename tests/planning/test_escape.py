"""Ways out: breakout and sustained avoidance reach what the controller alone cannot."""

import math
from itertools import groupby

import numpy as np
import pytest

from fuzzyq_bullet.episode import run
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.planning import MODES, ImprovedFuzzySettings
from fuzzyq_bullet.planning.base import STEP_UNIT
from fuzzyq_bullet.planning.escape.escape import GAIN, PATIENCE, Escape
from fuzzyq_bullet.planning.escape.exploration import NEAR
from fuzzyq_bullet.planning.escape.path_follower import PATIENCE as FOLLOWER_PATIENCE
from fuzzyq_bullet.planning.escape.path_follower import PathFollower, Segment
from fuzzyq_bullet.planning.ray_search import ray_search
from fuzzyq_bullet.scenario import Arena, Box, Cylinder, Goal, Limits, Scenario, Start
from tests.helpers.exploring import RANGE, WIDE, observe

FULL = ImprovedFuzzySettings(weights=(1.0, 1.0))


def box(x, y, length, width):
    return Box(shape="box", position=(x, y), size=(length, width))


def task(obstacles, *, goal=(7.0, 4.0), planner=FULL, drive="wheels", time=200.0):
    return Scenario(
        name="trap",
        arena=Arena(size=(8.0, 8.0)),
        start=Start(position=(1.0, 4.0)),
        goal=Goal(position=goal),
        obstacles=obstacles,
        planner=planner,
        drive=drive,
        limits=Limits(time=time),
    )


def semicircle(radius=1.2):
    """Return a trap of cylinders that opens towards the start."""
    angles = np.linspace(-math.pi / 2, math.pi / 2, 19)
    return tuple(
        Cylinder(
            shape="cylinder",
            position=(4.0 + radius * math.cos(a), 4.0 + radius * math.sin(a)),
            radius=0.2,
        )
        for a in angles
    )


def u_shape():
    return (box(4.6, 4.0, 0.2, 2.6), box(3.8, 5.2, 1.6, 0.2), box(3.8, 2.8, 1.6, 0.2))


TRAPS = {
    "semicircle": semicircle(),
    "u-shape": u_shape(),
    "long wall": (box(4.0, 4.6, 0.2, 5.0),),
}


def modes_of(trajectory):
    return {MODES[mode] for mode in trajectory.decisions.mode}


@pytest.mark.slow
@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
@pytest.mark.parametrize("trap", TRAPS)
def test_it_gets_out_of_traps_and_touches_nothing(trap, drive):
    trajectory = run(task(TRAPS[trap], drive=drive))
    assert trajectory.outcome == "goal"
    assert trajectory.ticks.clearance.min() > 0.0
    assert modes_of(trajectory) == set(MODES)


@pytest.mark.parametrize("trap", TRAPS)
def test_without_the_schemes_the_same_traps_hold_it(trap):
    plain = ImprovedFuzzySettings(weights=(1.0, 1.0), breakout=False)
    trajectory = run(task(TRAPS[trap], planner=plain, time=60.0))
    assert trajectory.outcome in {"stuck", "timeout"}
    assert modes_of(trajectory) == {"routine"}


@pytest.mark.slow
def test_a_breakout_that_is_not_sustained_does_not_get_out_of_a_semicircle():
    brief = ImprovedFuzzySettings(weights=(1.0, 1.0), following=False)
    trajectory = run(task(TRAPS["semicircle"], planner=brief, time=60.0))
    assert trajectory.outcome in {"stuck", "timeout"}
    assert "following" not in modes_of(trajectory)


@pytest.mark.slow
@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_where_there_is_no_way_it_ends_without_a_touch(drive):
    prison = (
        box(7.0, 5.2, 2.0, 0.2),
        box(7.0, 2.8, 2.0, 0.2),
        box(5.9, 4.0, 0.2, 2.6),
    )
    trajectory = run(task(prison, drive=drive, time=40.0))
    assert trajectory.outcome in {"stuck", "timeout"}
    assert trajectory.collision is None


def test_an_escape_says_where_it_is_going():
    trajectory = run(task(TRAPS["u-shape"]))
    decisions = trajectory.decisions
    routine = decisions.mode == MODES.index("routine")
    assert np.isnan(decisions.target[routine]).all()
    assert np.isfinite(decisions.target[~routine]).all()
    # A breakout's temporary goal is where it goes next, within sight; and it does get there.
    position, ticks = trajectory.ticks.position, decisions.tick
    for index in np.flatnonzero(decisions.mode == MODES.index("breakout")):
        target = decisions.target[index]
        assert math.dist(target, position[ticks[index]]) <= 1.0
        assert np.hypot(*(position[ticks[index] :] - target).T).min() < 0.5


def blocked_ahead(more_room):
    """Return what is observed where only the way to the goal is blocked, with room on one side."""

    def sense(headings):
        return [
            0.1 if abs(one) < 0.5 else 1.0 if one * more_room > 0.0 else 0.9 for one in headings
        ]

    return observe(Field(), (0.0, 0.0), sense=sense)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_tie_of_both_sides_is_broken_by_the_side_with_more_room(sign):
    aim = Escape(following=False).aim(blocked_ahead(sign), 1.0)
    assert aim.mode == "breakout"
    assert aim.bearing * sign > 0.4


@pytest.mark.parametrize("side", [1, -1])
def test_a_sweep_finds_the_first_free_way_on_its_side(side):
    field = Field(boxes=np.array([[0.5, 0.0, 0.2, 1.0, 0.0]]))

    def sense(headings):
        return field.free_distance((0.0, 0.0), headings, 0.2, 1.0)

    found = ray_search(sense, 0.0, side, 0.8)
    assert found.heading * side > 0.0
    assert sense([found.heading])[0] >= 0.8
    blocked, length = found.blocked
    assert length < 0.8
    assert abs(found.heading - blocked) <= math.radians(2.5)
    before = side * np.arange(0.0, abs(blocked), 0.02)
    assert (sense(before) < 0.8).all()


def test_a_sweep_among_walls_finds_nothing():
    field = Field(arena=(0.5, 0.5))

    def sense(headings):
        return field.free_distance((0.25, 0.25), headings, 0.2, 1.0)

    assert ray_search(sense, 0.0, 1, 0.3) is None


# ---- what it decides, one decision after the other


class Walk:
    """A robot that is put somewhere, and what its escape decides there."""

    def __init__(self, field, goal):
        self.escape, self.field, self.goal, self.time = Escape(), field, goal, 0.0

    def aim(self, here, *, middle=None, sense=None):
        """Return the aim a quarter of a second later; ``middle``: the line to the goal."""
        self.time += 0.25
        bearing = math.atan2(self.goal[1] - here[1], self.goal[0] - here[0])
        exact = sense or (lambda headings: self.field.free_distance(here, headings, WIDE, RANGE))

        def told(headings):
            free = zip(headings, exact(headings), strict=True)
            return [middle if one == bearing and middle is not None else far for one, far in free]

        seen = observe(self.field, here, goal=self.goal, time=self.time, sense=told)
        return self.escape.aim(seen, 1.0)


WALLED = Field(boxes=np.array([[0.7, 0.0, 0.1, 6.0, 0.0]]))
"""The goal at (5, 0) is behind a wall; from the origin the line to it is free for 0.43 m."""


def stalled():
    """A robot that came no nearer for too long, 0.43 m before the wall: its first breakout."""
    walk = Walk(WALLED, (5.0, 0.0))
    while (aim := walk.aim((0.0, 0.0))).mode == "routine":
        assert walk.time <= PATIENCE + 0.6
    assert aim.mode == "breakout"
    assert walk.time > PATIENCE
    return walk


def test_a_stalled_robot_does_not_leave_where_it_stalled():
    walk = stalled()
    for _ in range(10):
        assert walk.aim((0.0, 0.0)).mode != "routine"


def test_it_leaves_where_the_line_leads_nearer_than_the_line_that_did_not_help():
    # The line led to 0.43 m before the goal's 5 m. At the same distance from the goal elsewhere:
    as_before = math.dist((0.1, 1.0), (5.0, 0.0)) - 4.57
    for more in (-0.1, 0.0, GAIN * STEP_UNIT - 0.02):
        walk = stalled()
        assert walk.aim((0.1, 1.0), middle=as_before + more).mode != "routine"
    walk = stalled()
    left = walk.aim((0.1, 1.0), middle=as_before + GAIN * STEP_UNIT + 0.02)
    assert left.mode == "routine"
    # ... and it drives that line exactly, until it is nearer than ever: then the rules may turn it.
    assert left.point == (5.0, 0.0)
    assert left.exact
    assert not left.hopeless
    away = walk.aim((0.0, 0.5), middle=0.6)
    assert (away.mode, away.exact) == ("routine", True)
    nearer = walk.aim((0.3, 0.2), middle=0.6)
    assert (nearer.mode, nearer.exact) == ("routine", False)


def test_it_leaves_where_the_line_leads_to_the_goal():
    walk = stalled()
    assert walk.aim((4.0, 1.0), middle=math.dist((4.0, 1.0), (5.0, 0.0))).mode == "routine"


def test_a_blocked_robot_looks_at_once():
    walk = Walk(WALLED, (5.0, 0.0))
    assert walk.aim((0.0, 0.0)).mode == "routine"
    aim = walk.aim((0.3, 0.0))  # 0.13 m before it stops
    assert aim.mode == "breakout"
    assert abs(aim.target[1]) > 0.5


def test_where_it_comes_nearer_the_goal_is_the_aim():
    walk = Walk(WALLED, (5.0, 0.0))
    for k in range(30):
        aim = walk.aim((-2.0 + 0.05 * k, 0.0))
        assert (aim.mode, aim.point, aim.exact) == ("routine", (5.0, 0.0), False)


def test_a_frontier_that_cannot_be_reached_is_tried_twice_and_then_given_up():
    walk = stalled()
    held = []  # the robot is held where it is, though all ways seem free
    while not (aim := walk.aim((0.0, 0.0))).hopeless:
        held.append(aim.target)
        assert len(held) < 2000
    tries = [(target, len(list(aims))) for target, aims in groupby(held)]
    targets = {target for target, _ in tries}
    assert len(targets) > 3
    # None is come back to before all the others were tried.
    assert {target for target, _ in tries[: len(targets)]} == targets
    twice = 2 * FOLLOWER_PATIENCE / 0.25 + 2
    counts = [count for _, count in tries[1:]]
    assert counts[: len(targets) - 1] == pytest.approx([twice] * (len(targets) - 1), abs=2)
    assert max(counts) <= twice + 2
    assert len(tries) <= 2 * len(targets)
    assert aim.reach == 0.0


def test_where_no_way_is_free_it_knows_at_once_that_it_is_hopeless():
    walk = Walk(Field(arena=(0.46, 0.46)), (5.0, 0.0))
    aim = walk.aim((0.23, 0.23))
    assert aim.hopeless
    assert aim.reach == 0.0


def test_where_ways_are_seen_but_none_can_be_gone_it_ends_hopeless_soon():
    walk = Walk(WALLED, (5.0, 0.0))
    walk.aim((0.3, 0.0))
    for _ in range(60):
        aim = walk.aim((0.3, 0.0), sense=lambda headings: np.zeros(len(headings)))
        if aim.hopeless:
            break
        assert aim.mode != "routine"
    assert aim.hopeless


def test_at_a_frontier_it_looks_again_and_goes_on_to_another():
    walk = stalled()
    first = walk.aim((0.0, 0.0)).target
    second = walk.aim(first)
    assert second.mode == "following"
    assert math.dist(second.target, first) > NEAR


def test_near_the_goal_a_line_that_leads_to_it_is_taken_though_little_is_to_gain():
    walk = Walk(Field(boxes=np.array([[0.4, 0.0, 0.1, 0.3, 0.0]])), (0.2, 0.0))
    assert walk.aim((0.0, 0.0), middle=0.1).mode == "breakout"
    assert walk.aim((0.15, 0.3), middle=0.25).mode != "routine"
    assert walk.aim((0.15, 0.3), middle=0.31).mode == "routine"


def test_a_line_that_leads_nearer_but_is_blocked_is_not_taken():
    walk = stalled()
    assert walk.aim((0.8, 0.0), middle=0.1).mode != "routine"


def test_a_robot_that_comes_no_nearer_but_sees_nothing_on_its_line_goes_on():
    walk = Walk(Field(), (5.0, 0.0))
    assert {walk.aim((0.0, 0.0)).mode for _ in range(40)} == {"routine"}


def test_it_aims_at_the_end_of_each_leg_of_its_way(monkeypatch):
    walk = stalled()
    monkeypatch.setattr(PathFollower, "next", lambda self, observation: Segment(1.2, 0.03, 0.02))
    aim = walk.aim((0.0, 0.0))
    assert (aim.bearing, aim.distance, aim.reach) == (1.2, 0.03, 0.02)
