"""A robot that would be run into if it braked goes on, and keeps to it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from fuzzyq_bullet import Decision
from fuzzyq_bullet.planning.traffic.passive_safety import safe_speed
from fuzzyq_bullet.planning.traffic.tracker import Traffic
from tests.moving.test_passive_safety import MOTION, ON, Crossing
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
