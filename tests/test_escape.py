"""Ways out: breakout and sustained avoidance reach what the controller alone cannot."""

import math

import numpy as np
import pytest

from fuzzyq_bullet.episode import run
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.planning import MODES, Decision, ImprovedFuzzySettings, Observation, RangeSensor
from fuzzyq_bullet.planning.escape import Escape
from fuzzyq_bullet.planning.sweep import first_free
from fuzzyq_bullet.scenario import Arena, Box, Cylinder, Goal, Limits, Scenario, Start

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


def test_a_breakout_that_is_not_sustained_does_not_get_out_of_a_semicircle():
    brief = ImprovedFuzzySettings(weights=(1.0, 1.0), following=False)
    trajectory = run(task(TRAPS["semicircle"], planner=brief, time=60.0))
    assert trajectory.outcome in {"stuck", "timeout"}
    assert "following" not in modes_of(trajectory)


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


def blocked_ahead(position, difference):
    """Return what the routine part and the escape see where only the way to the goal is blocked."""
    bearing = math.atan2(-position[1], 100.0 - position[0])

    def sense(headings):
        return np.array([0.1 if abs(one - bearing) < 0.5 else 1.0 for one in headings])

    lines = np.array([bearing + 0.8, bearing, bearing - 0.8])
    routine = Decision(
        heading=bearing,
        step=0.1,
        lines=lines,
        lengths=sense(lines),
        difference=difference,
        weights=(1.0, 1.0),
        breakout_at=1.0,
    )
    observation = Observation(
        time=0.0,
        position=position,
        heading=bearing,
        speed=0.0,
        turn_rate=0.0,
        goal=(100.0, 0.0),
        goal_radius=0.2,
        range=1.0,
        radius=0.22,
        sensor=RangeSensor(sense, lambda headings: sense(headings) + 0.2),
    )
    return routine, observation


@pytest.mark.parametrize("sign", [1, -1])
def test_a_tie_of_both_sides_is_broken_by_the_side_with_more_room(sign):
    plain = Escape(following=False)
    decision = plain.decide(*blocked_ahead((0.0, 0.0), 2.0 * sign))
    assert decision.mode == "breakout"
    assert decision.heading * sign > 0.4


@pytest.mark.parametrize("side", [1, -1])
def test_a_sweep_finds_the_first_free_way_on_its_side(side):
    field = Field(boxes=np.array([[0.5, 0.0, 0.2, 1.0, 0.0]]))

    def sense(headings):
        return field.free_distance((0.0, 0.0), headings, 0.2, 1.0)

    found = first_free(sense, 0.0, side, 0.8)
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

    assert first_free(sense, 0.0, 1, 0.3) is None
