"""Claims about telling what moves from what stands, from successive readings alone."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.planning.base import Observation, RangeSensor
from fuzzyq_bullet.planning.traffic.circle_fit import Circle, fit_circle
from fuzzyq_bullet.planning.traffic.lidar_scan import (
    SURFACE_TOLERANCE,
    in_free_space,
    lidar_scan,
)
from fuzzyq_bullet.planning.traffic.track import SPEED_TOLERANCE, TrackHistory
from fuzzyq_bullet.planning.traffic.tracker import Tracker
from fuzzyq_bullet.scenario import Box, Cylinder

PERIOD, RANGE, WIDE = 0.05, 1.0, 0.22
angles = st.floats(-math.pi, math.pi)


def reading(time, position, obstacles, noise=0.0, rng=None, sees=RANGE):
    """Return what a robot at a position sees of obstacles at a time."""
    field = Field.of(obstacles)

    def look(headings):
        free = field.free_distance(position, headings, 0.0, sees + WIDE)
        told = free + (rng.normal(0.0, noise, len(free)) if noise else 0.0)
        return np.where(free < sees + WIDE, np.clip(told, 0.0, sees + WIDE), free)

    return Observation(
        time=time,
        position=position,
        heading=0.0,
        speed=0.0,
        turn_rate=0.0,
        goal=(50.0, 0.0),
        goal_radius=0.2,
        range=sees,
        radius=WIDE,
        sensor=RangeSensor(lambda headings: [sees] * len(headings), look),
        uncertainty=3.0 * noise,
        closing_speed=0.6,
    )


def pillar(x, y, radius=0.25):
    return Cylinder(shape="cylinder", position=(x, y), radius=radius)


def along(heading, distance):
    return distance * math.cos(heading), distance * math.sin(heading)


@given(angles, angles, st.floats(0.15, 0.6), st.floats(0.0, 0.5), angles)
@settings(max_examples=25, deadline=None)
def test_the_velocity_of_a_disc_is_told_to_within_5_cm_a_second(place, goes, speed, own, drives):
    tracker, found = Tracker(), 0
    for k in range(30):
        time = k * PERIOD
        robot = along(drives, own * time)
        start, moved = along(place, 0.8), along(goes, speed * time)
        disc = (start[0] + moved[0], start[1] + moved[1])
        if not 0.5 < math.dist(robot, disc) < 1.1:
            break
        traffic = tracker.update(reading(time, robot, [pillar(*disc)]))
        for track in traffic.tracks if k >= 15 else ():
            if track.velocity is None:  # it has been told to move for less than 0.1 s
                continue
            found += 1
            assert math.dist(track.centre, disc) < 0.05
            assert math.dist(track.velocity, along(goes, speed)) < 0.05
    if k == 29 and own == 0.0:
        assert found or math.cos(goes - place) > 0.4  # what moves away enters hardly anything free


@given(angles, st.lists(st.tuples(st.floats(0.3, 1.2), st.floats(-1.0, 1.0)), min_size=3))
def test_a_circle_for_what_is_none_reaches_no_nearer_than_what_is_seen(place, seen):
    points = np.array([along(place + aside, distance) for distance, aside in seen])
    circle = fit_circle(points, np.zeros(2), 0.0)
    assume(not circle.fits)
    nearest = min(distance for distance, _ in seen)
    centre = np.add(circle.centre, circle.back)
    assert math.hypot(*centre) - circle.radius >= nearest - 1e-6


@given(angles, st.floats(0.3, 0.5))
def test_what_goes_away_may_turn_round_and_come_at_the_closing_speed(place, speed):
    tracker = Tracker()
    for k in range(12):
        disc = along(place, 0.7 + 0.05 * k * speed)
        traffic = tracker.update(reading(0.05 * k, (0.0, 0.0), [pillar(*disc)]))
        unknown = ~traffic.velocities.any(axis=1)
        assert (traffic.max_speeds[unknown] == 0.6).all()
    assert len(traffic.points)


@given(angles, st.floats(0.0, 0.6), st.sampled_from([0.0, 0.005, 0.01]), st.integers(0, 2**32))
@settings(max_examples=25, deadline=None)
def test_what_stands_is_never_told_to_move(drives, own, noise, seed):
    rng = np.random.default_rng(seed)
    stands = [pillar(0.7, 0.4), pillar(-0.5, 0.8, 0.2), pillar(-0.4, 0.95, 0.2), pillar(0.2, -0.9)]
    tracker = Tracker()
    for k in range(40):
        robot = along(drives, own * k * PERIOD)
        if any(math.dist(robot, one.position) < one.radius + 0.2 for one in stands):
            break
        traffic = tracker.update(reading(k * PERIOD, robot, stands, noise, rng))
        assert not len(traffic.moving)
        assert not traffic.tracks
    # What was seen for a while is not distrusted any more.
    if own == 0.0:
        assert not len(traffic.points)


@pytest.mark.parametrize("sees", [1.0, 1.5])
@given(st.floats(0.0, 0.5), st.floats(0.25, 0.5), st.floats(0.005, 0.05), st.floats(0.0, 0.03))
def test_a_surface_is_not_in_free_space_however_noise_moves_it(sees, beyond, apart, beside, off):
    # Rays that graze a wall pass close to it, and meet nothing behind it.
    wall = Box(shape="box", position=(1.0, -1.0), size=(1.0, 2.0))
    scan = lidar_scan(reading(0.0, (0.5 - apart, beside), [wall], sees=sees))
    point = np.array([(0.5 + beyond, off)])
    assert not in_free_space(scan, point, SURFACE_TOLERANCE + 2.0 * 0.03)[0]


def test_what_has_just_come_into_sight_may_come_as_fast_as_was_said():
    traffic = Tracker().update(reading(0.0, (0.0, 0.0), [pillar(0.8, 0.0)]))
    assert len(traffic.points) > 5
    assert traffic.max_speeds == pytest.approx(0.6)


def test_what_moves_off_a_pillar_that_it_touches_is_told_apart_from_it():
    tracker = Tracker()
    for k in range(20):
        mover = pillar(0.8, 0.28 + 0.3 * k * PERIOD)
        both = [pillar(0.8, -0.25), mover]
        traffic = tracker.update(reading(k * PERIOD, (0.0, 0.0), both))
    [track] = traffic.tracks
    assert track.velocity == pytest.approx((0.0, 0.3), abs=0.05)
    assert math.dist(track.centre, mover.position) < 0.05


def test_what_bounces_is_followed_the_other_way_within_a_quarter_of_a_second():
    tracker = Tracker()
    for k in range(26):
        time = k * PERIOD
        y = 0.4 - 0.4 * time if time < 1.0 else 0.4 * (time - 1.0)
        traffic = tracker.update(reading(time, (0.0, 0.0), [pillar(0.8, y)]))
    [track] = traffic.tracks
    assert track.velocity == pytest.approx((0.0, 0.4), abs=0.05)


@pytest.mark.parametrize("way", [(-0.3, 0.0), (-0.2, 0.2)])
def test_the_velocity_of_a_box_is_told_to_within_5_cm_a_second(way):
    # No circle fits it. The one around it changes with what is seen of the box.
    tracker, told = Tracker(), []
    for k in range(20):
        time = k * PERIOD
        at = 0.95 + way[0] * time, way[1] * (time - 0.5)
        box = Box(shape="box", position=at, size=(0.3, 0.6))
        traffic = tracker.update(reading(time, (0.0, 0.0), [box]))
        told += [track.velocity for track in traffic.tracks if track.velocity and k > 8]
        for track in traffic.tracks:
            assert math.hypot(*track.centre) - track.radius > at[0] - 0.15 - 0.05
    assert len(told) > 5
    assert np.median(told, axis=0) == pytest.approx(way, abs=0.05)


def test_a_track_may_be_a_little_faster_than_fitted_but_not_beyond_the_limit() -> None:
    track = TrackHistory(0.25, velocity=(0.3, 0.4))
    assert track.max_speed(3.0) == pytest.approx(0.5 + SPEED_TOLERANCE)
    assert track.max_speed(0.52) == 0.52
    assert TrackHistory(0.25).max_speed(3.0) == 3.0


def test_a_radius_that_changes_throws_earlier_centres_away() -> None:
    def added(radius: float) -> TrackHistory:
        track = TrackHistory(0.25)
        for k in range(4):
            track.add(0.05 * k, Circle((0.0, 0.02 * k), 0.25, fits=True), 0.015, 3.0)
        track.add(0.2, Circle((0.0, 0.08), radius, fits=True), 0.015, 3.0)
        return track

    assert added(0.28).velocity == pytest.approx((0.0, 0.4))
    assert added(0.30).velocity is None


def test_a_fit_that_is_too_fast_is_no_velocity() -> None:
    track = TrackHistory(0.25)
    for k in range(4):
        track.add(0.05 * k, Circle((0.0, 0.2 * k), 0.25, fits=True), 0.015, 3.0)
    assert track.velocity is None


def test_what_stands_behind_a_track_does_not_turn_it() -> None:
    track = TrackHistory(0.25, velocity=(1.0, 0.0))
    track.positions.append((0.0, 0.0, 0.0))
    assert track.straight_for(np.array([[-1.0, 0.0]]), 0.0) == math.inf
    assert track.straight_for(np.array([[-1.0, 0.0], [1.25, 0.0]]), 0.0) == pytest.approx(1.0)
