"""Passive safety looks where the robot drives, and lets it go on if it would be run into else."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from fuzzyq_bullet import Decision
from fuzzyq_bullet.planning.base import Motion
from fuzzyq_bullet.planning.traffic.avoidance import TrafficAvoidance
from tests.moving.test_tracking import PERIOD, pillar, reading

SPEED, COMES = 0.5, 0.3
MOTION = Motion(
    max_speed=0.6, max_turn_rate=2.5, acceleration=1.0, turn_acceleration=8.0, period=0.05,
    radius=0.2, margin=0.02,
)  # fmt: skip
ON = Decision(0.0, 0.4, reach=0.9, guard=0.95)


class Crossing:
    """An obstacle comes from a side (rad) straight to a robot that drives along x.

    Another may come slowly towards the robot, ``ahead`` of it (m).
    """

    def __init__(
        self, side: float, gap: float, speed: float = SPEED, ahead: float = math.inf
    ) -> None:
        self._side, self._gap, self._speed, self._ahead = side, gap, speed, ahead
        self._avoidance = TrafficAvoidance()
        self._tick = -12
        while self._tick < 0:
            self._look()

    def _look(self) -> None:
        self._tick += 1
        time = self._tick * PERIOD
        apart = self._gap + 0.2 + 0.25 - COMES * time
        there = apart * math.cos(self._side), apart * math.sin(self._side)
        other = min(self._ahead, 9.0) + 0.2 + 0.25 - 0.15 * time
        seen = reading(time, (self._speed * time, 0.0), [pillar(*there), pillar(other, 0.0)])
        self._observation = replace(seen, speed=self._speed, motion=MOTION)
        self._avoidance.update(self._observation)

    @property
    def clock(self) -> float:
        """Time that has passed for the escape (s)."""
        return self._avoidance.without_waiting(self._observation).time

    def limit(self, decision: Decision) -> Decision:
        """Return what becomes of a decision now, and look again."""
        limited = self._avoidance.limit(decision, self._observation)
        self._look()
        return limited


def after_a_while(
    side: float, gap: float, decision: Decision = ON, speed: float = SPEED
) -> Decision:
    """Return what becomes of a decision when an obstacle has come so near (m)."""
    return Crossing(side, gap, speed).limit(decision)


@pytest.mark.parametrize("side", [100.0, -100.0])
def test_it_drives_on_before_one_that_comes_from_beside_it(side: float) -> None:
    assert after_a_while(math.radians(side), 0.06).reach == ON.reach


@pytest.mark.parametrize("side", [80.0, -80.0])
def test_it_does_not_creep_where_it_would_be_run_into(side: float) -> None:
    # To creep is passively safe: the robot would stand for 0.3 s before the contact.
    assert after_a_while(math.radians(side), 0.2, speed=0.1).reach == ON.reach


@pytest.mark.parametrize("side", [80.0, -80.0])
def test_it_brakes_where_less_than_2_cm_would_be_left(side: float) -> None:
    assert after_a_while(math.radians(side), 0.15, speed=0.1).reach < 0.01


@pytest.mark.parametrize("side", [0.0, 30.0, -30.0])
def test_it_brakes_before_one_that_it_would_run_into(side: float) -> None:
    assert after_a_while(math.radians(side), 0.06).reach == 0.0


def test_a_robot_that_backs_up_minds_what_comes_from_behind_and_not_from_ahead() -> None:
    back = ON._replace(heading=math.pi, backward=True)
    assert after_a_while(math.pi, 0.2, back, speed=-0.2).reach < 0.05
    assert after_a_while(0.0, 0.2, back, speed=-0.2).reach == back.reach
