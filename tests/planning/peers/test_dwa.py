"""The dynamic window approach: what it may choose, and how it passes an obstacle."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.planning import DwaPlanner, DwaSettings
from fuzzyq_bullet.planning.peers.dwa import free_arcs
from tests.helpers.exploring import WIDE, standing
from tests.planning.peers.helpers import MOTION, drive, moving

CYLINDER = {"shape": "cylinder", "position": [5.0, 5.0], "radius": 0.3}
RATES = st.floats(-2.0, 2.0)
SPEEDS = st.floats(0.0, 0.6)


def driven(speed, rate, length):
    """Points that the centre passes on an arc of this length (m), every 2 mm."""
    along = np.arange(0.0, length, 0.002)
    turned = along * rate / speed
    chord = along * np.sinc(turned / math.tau)
    return np.column_stack([chord * np.cos(turned / 2), chord * np.sin(turned / 2)])


@given(st.floats(0.05, 0.6), RATES, st.floats(-1.2, 1.2), st.floats(-1.2, 1.2))
def test_an_arc_is_free_up_to_where_the_disc_meets_a_point(speed, rate, x, y):
    points = np.array([[x, y]])
    if math.hypot(x, y) < WIDE + 0.01:
        return
    free = free_arcs(np.array([speed]), np.array([rate]), points, WIDE)[0, 0]
    way = min(free, 1.0, math.tau * speed / max(abs(rate), 1e-9))
    apart = np.hypot(*(driven(speed, rate, way) - points).T)
    assert apart.min(initial=np.inf) > WIDE - 0.003
    if free < 1.0:
        there = driven(speed, rate, free + 0.002)[-1]
        assert math.dist(there, (x, y)) == pytest.approx(WIDE, abs=0.005)


@settings(max_examples=60, deadline=None)
@given(standing(), st.floats(-3.1, 3.1), SPEEDS, RATES)
def test_what_it_chooses_is_in_the_window_and_admissible(world, heading, speed, rate):
    field, here = world
    seen = moving(field, here, goal=(3.5, 3.5), heading=heading, speed=speed, turn_rate=rate)
    chosen = DwaSettings()
    twist = DwaPlanner(chosen).decide(seen)
    if twist.speed == 0.0:  # it brakes, and turns on the spot as fast as it can
        assert abs(twist.turn_rate) == MOTION.max_turn_rate
        return
    assert 0.0 <= twist.speed <= MOTION.max_speed
    assert abs(twist.speed - speed) <= MOTION.acceleration * chosen.interval + 1e-9
    assert abs(twist.turn_rate) <= MOTION.max_turn_rate + 1e-9
    assert abs(twist.turn_rate - rate) <= MOTION.turn_acceleration * chosen.interval + 1e-9
    # Every point that a ray has hit is farther from the way to a stop than the disc reaches.
    rays = np.arange(120) * (math.tau / 120)
    far = seen.look(rays.tolist())
    met = far < 1.22 - 1e-9
    hits = far[met, None] * np.column_stack(
        [np.cos(rays[met] - heading), np.sin(rays[met] - heading)]
    )
    stop = twist.speed * MOTION.period + MOTION.way_to_stop(twist.speed)
    way = driven(twist.speed, twist.turn_rate, stop)
    apart = np.hypot(*(way[:, None] - hits).transpose(2, 0, 1))
    wide = np.minimum(WIDE, np.hypot(*hits.T) - 1e-3)
    assert (apart > wide - 0.003).all()


def test_it_drives_faster_where_more_is_free():
    field = Field(np.array([[0.0, 0.0, 0.3]]), np.empty((0, 5)), None)
    speeds = [
        DwaPlanner(DwaSettings()).decide(moving(field, (x, 0.0), goal=(5.0, 0.0), speed=0.4)).speed
        for x in (-3.0, -0.75)
    ]
    assert speeds[0] > speeds[1]


def test_the_weight_of_the_clearance_leads_it_away_from_what_stands_beside_its_way():
    post = Field(np.array([[0.9, 0.1, 0.1]]), np.empty((0, 5)), None)  # a little to the left
    seen = moving(post, (0.0, 0.0), goal=(5.0, 0.0), speed=0.3)
    blind, usual = (
        DwaPlanner(settings).decide(seen).turn_rate
        for settings in (DwaSettings(clearance=0.0), DwaSettings())
    )
    assert blind == 0.0
    assert usual < -0.2  # to the right


def test_where_no_arc_is_admissible_it_turns_on_the_spot_away_from_what_is_near():
    ahead = Field(np.array([[0.5, 0.05, 0.27]]), np.empty((0, 5)), None)
    twist = DwaPlanner(DwaSettings()).decide(moving(ahead, (0.0, 0.0), goal=(5.0, 0.0), speed=0.0))
    assert twist.speed == 0.0
    assert twist.turn_rate == -MOTION.max_turn_rate  # the obstacle is a little to the left


def test_it_passes_one_obstacle():
    record = drive("dwa", [CYLINDER])
    assert record.outcome == "goal"
    assert record.ticks.time[-1] < 20.0


def test_it_slows_down_before_the_end_of_a_corridor_without_the_safety_filter():
    corridor = [
        {"shape": "box", "position": [2.5, 5.6], "size": [4.6, 0.4]},
        {"shape": "box", "position": [2.5, 4.4], "size": [4.6, 0.4]},
        {"shape": "box", "position": [4.6, 5.0], "size": [0.2, 0.6]},
    ]
    record = drive({"name": "dwa", "guard": False}, corridor, limits={"time": 12.0})
    assert record.outcome in ("timeout", "stuck")
    x, speed = record.ticks.position[:, 0], record.ticks.speed
    assert speed[(x > 2.0) & (x < 3.0)].max() > 0.55
    assert speed[np.argmax(x)] < 0.1
    assert 3.8 < x.max() < 4.3  # half a metre before the end or nearer, and not in it
