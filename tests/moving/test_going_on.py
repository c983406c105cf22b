"""A robot that would be run into if it braked goes on, and keeps to it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from fuzzyq_bullet import Decision
from fuzzyq_bullet.planning.traffic.going_on import GoingOn
from fuzzyq_bullet.planning.traffic.passive_safety import safe_speed
from fuzzyq_bullet.planning.traffic.track import Track
from fuzzyq_bullet.planning.traffic.tracker import Traffic
from tests.moving.test_passive_safety import MOTION, ON, SPEED, Crossing
from tests.moving.test_tracking import reading

BRAKES = Decision(0.0, 0.4, reach=0.0, guard=0.0)


@pytest.mark.parametrize("side", [100.0, -100.0])
def test_it_goes_on_as_long_as_that_helps_whatever_it_would_do_by_now(side: float) -> None:
    crossing = Crossing(math.radians(side), 0.06)
    assert crossing.limit(ON) == ON
    other = ON._replace(heading=math.radians(-side))
    for decision in (other, BRAKES, other):
        kept = crossing.limit(decision)
        assert kept.heading == ON.heading
        assert kept.reach > 0.9
        # On record it gives way.
        assert (kept.mode, kept.exact, kept.target) == ("routine", 1.0, kept.aim)
        assert kept.target[1] == pytest.approx(0.0)


def test_meanwhile_the_clock_of_the_escape_stands_still() -> None:
    crossing = Crossing(math.radians(100.0), 0.06)
    crossing.limit(ON)
    before = crossing.clock
    crossing.limit(BRAKES)
    assert crossing.clock == pytest.approx(before)


def test_without_going_on_before_it_does_what_it_wants() -> None:
    assert Crossing(math.radians(100.0), 0.06).limit(BRAKES).reach == 0.0


def test_it_stops_to_go_on_when_nothing_would_run_into_it() -> None:
    crossing = Crossing(math.radians(100.0), 0.06)
    crossing.limit(ON)
    for _ in range(20):  # it has passed in front of the obstacle by now
        last = crossing.limit(BRAKES)
    assert last == BRAKES


@pytest.mark.parametrize(("ahead", "goes_on"), [(math.inf, True), (0.7, False)])
def test_it_does_not_go_on_into_a_contact_that_comes_soon_after(ahead: float, goes_on: bool):
    crossing = Crossing(math.radians(90.0), 0.1, ahead=ahead)
    assert (crossing.limit(ON).reach == ON.reach) is goes_on


def test_a_robot_that_drives_slowly_does_not_rely_on_its_full_speed() -> None:
    slow = ON._replace(step=0.04)
    assert Crossing(math.radians(100.0), 0.06).limit(slow).reach < ON.reach


@pytest.mark.parametrize(("goes", "wary"), [(40.0, True), (-140.0, False), (140.0, False)])
def test_only_who_goes_away_may_turn_at_any_time(goes: float, wary: bool) -> None:
    # It is seen at 40 degrees, and goes away, comes past, or crosses.
    at = 0.62 * math.cos(math.radians(40.0)), 0.62 * math.sin(math.radians(40.0))
    velocity = 0.3 * math.cos(math.radians(goes)), 0.3 * math.sin(math.radians(goes))
    assert (safe(at, velocity, straight_for=math.inf) != math.inf) is wary


def safe(*points: tuple[float, float], straight_for: float, speed: float = 0.6) -> float | None:
    """Return the safe speed straight on; points and velocities in turn."""
    places, velocities = np.array(points[::2]), np.array(points[1::2])
    speeds = np.hypot(*velocities.T) + 0.05
    straight, none = np.full(len(places), straight_for), np.zeros((0, 2))
    traffic = Traffic((), places, velocities, speeds, straight, none, none)
    observation = replace(reading(0.0, (0.0, 0.0), []), speed=speed, motion=MOTION)
    return safe_speed(0.0, 1.0, observation, MOTION, traffic)


def test_who_is_met_only_by_braking_late_counts_too() -> None:
    comes_behind, goes_ahead = ((-0.35, -0.03), (0.44, 0.13)), ((1.08, -0.35), (0.16, 0.02))
    alone = [safe(*one, straight_for=math.inf, speed=0.38) for one in (comes_behind, goes_ahead)]
    assert alone == [math.inf, math.inf]
    assert safe(*comes_behind, *goes_ahead, straight_for=math.inf, speed=0.38) is None


def test_a_reach_that_allows_no_speed_does_not_get_it_away() -> None:
    assert Crossing(math.radians(100.0), 0.06).limit(ON._replace(reach=0.02)).reach < 0.02


class Around:
    """Obstacles of radius 0.25 m around a robot at the origin that drives along x, or backs up.

    Args:
        tracks: Centre (m) and velocity (m/s) of each, in turn.
        speed: Of the robot (m/s).
        latency: Of its wheels (s).
        seen: Whether passive safety knows of the obstacles, too.
    """

    def __init__(
        self,
        *tracks: tuple[float, float],
        speed: float = SPEED,
        latency: float = 0.0,
        seen: bool = True,
    ) -> None:
        places, velocities = np.array(tracks[::2]), np.array(tracks[1::2])
        moving = tuple(Track(c, 0.25, v) for c, v in zip(tracks[::2], tracks[1::2], strict=True))
        none = np.zeros((0, 2))
        edge = places - 0.25 * places / np.hypot(*places.T)[:, None]
        points, goes = (edge, velocities) if seen else (none, none)
        fast, straight = np.full(len(goes), 0.6), np.zeros(len(goes))  # they may turn
        self.traffic = Traffic(moving, points, goes, fast, straight, points, none)
        motion = replace(MOTION, latency=latency)
        self.observation = replace(reading(0.0, (0.0, 0.0), []), speed=speed, motion=motion)

    def begins(self, going_on: GoingOn, decision: Decision = ON) -> bool:
        return going_on.begins(decision, self.observation, self.traffic)


BESIDE = (-0.09, 0.5), (0.05, -0.3)
"""Comes from beside, and is 0.06 m away."""
BESIDE_BACKWARDS = (0.09, 0.5), (-0.05, -0.3)


def test_a_course_that_has_become_safe_is_given_up() -> None:
    going_on = GoingOn()
    now, later = Around(*BESIDE), Around(*BESIDE, seen=False)
    assert now.begins(going_on)
    assert going_on.kept(BRAKES, now.observation, now.traffic) is not None
    assert going_on.kept(BRAKES, later.observation, later.traffic) is None
    assert going_on.kept(BRAKES, now.observation, now.traffic) is None  # for good


def test_a_contact_that_comes_so_late_that_it_can_still_stop_is_none() -> None:
    # It reaches the one that stands ahead at full speed.
    goes_on = [
        Around(*BESIDE, (0.45 + gap, 0.0), (0.0, 0.0)).begins(GoingOn())
        for gap in (0.3, 0.5, 0.8, 1.2)
    ]
    assert goes_on == [False, False, True, True]


@pytest.mark.parametrize(("latency", "needs"), [(0.0, 0.8), (0.2, 0.9)])
def test_a_robot_that_hears_late_needs_longer_to_stop(latency: float, needs: float) -> None:
    for gap, goes_on in ((needs, True), (needs - 0.1, False)):
        ahead = (0.45 + gap, 0.0), (0.0, 0.0)
        assert Around(*BESIDE, *ahead, latency=latency).begins(GoingOn()) is goes_on


def test_it_goes_on_backwards_too() -> None:
    going_on, back = GoingOn(), ON._replace(heading=math.pi, backward=True)
    beside = Around(*BESIDE_BACKWARDS, speed=-SPEED)
    assert beside.begins(going_on, back)
    kept = going_on.kept(BRAKES, beside.observation, beside.traffic)
    assert kept is not None
    assert (kept.heading, kept.backward) == (math.pi, True)
