"""From a decision to a twist: what a fast robot does where it has to turn."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyq_bullet.drives.velocity_controller import GRIP, VelocityController
from fuzzyq_bullet.planning import Decision
from fuzzyq_bullet.scenario import Robot

FAST = Robot(model="jackal", max_speed=2.0)


def twist(robot, error):
    """Return the twist of a robot with all the room it wants, so far (rad) off its heading."""
    return VelocityController(robot, 0.05).twist(Decision(error, 20.0), 0.0, 0.0)


@given(st.floats(-math.pi, math.pi))
def test_a_robot_is_never_told_to_turn_faster_than_its_tyres_hold_at_its_speed(error):
    speed, turn_rate = twist(FAST, error)
    assert speed * abs(turn_rate) <= GRIP + 1e-9


def test_a_fast_robot_slows_down_for_a_turn_and_for_nothing_else():
    assert twist(FAST, 0.0).speed == 2.0
    assert twist(FAST, math.radians(10.0)).speed == 2.0
    assert twist(FAST, math.radians(60.0)).speed < 1.2


@pytest.mark.parametrize("degrees", [0, 30, 60, 85])
def test_the_usual_robot_is_slow_enough_for_every_turn(degrees):
    assert twist(Robot(), math.radians(degrees)).speed == 0.6
