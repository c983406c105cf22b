"""A scan: how far the robot could move in every direction, and what would stop it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from fuzzyq_bullet.geometry import Field, wrap_angle
from fuzzyq_bullet.planning.scan import scan_360
from tests.helpers.exploring import HIDDEN, RANGE, ROUNDING, WIDE, map_of, observe, standing


@given(standing())
@settings(max_examples=80)
def test_what_a_look_tells_is_free_up_to_what_may_hide_between_two_rays(seen):
    field, here = seen
    scan = scan_360(observe(field, here))
    headings, told = np.array(scan.headings), np.array(scan.lengths)
    assert (np.diff(headings) > 0.0).all()
    assert headings[0] >= 0.0
    assert headings[-1] < math.tau
    assert told.min() >= 0.0
    assert told.max() <= RANGE
    # Along the very edge of something the exact answer jumps from one heading to the next.
    exact = np.min(
        [
            field.free_distance(here, headings + turn, WIDE + ROUNDING, RANGE)
            for turn in (-ROUNDING, 0.0, ROUNDING)
        ],
        axis=0,
    )
    assert (told >= exact - ROUNDING).all()
    assert (told <= field.free_distance(here, headings, WIDE - HIDDEN, RANGE) + ROUNDING).all()


def test_as_a_rule_a_look_is_exact_to_a_centimetre():
    rng = np.random.default_rng(5)
    late, count = 0, 0
    for _ in range(60):
        field = Field(np.column_stack([rng.uniform(0, 4, (6, 2)), rng.uniform(0.2, 0.5, 6)]))
        here = tuple(rng.uniform(0.3, 3.7, 2).tolist())
        if field.clearance([here])[0] < WIDE:
            continue
        scan = scan_360(observe(field, here))
        thinner = field.free_distance(here, scan.headings, WIDE - 0.01, RANGE)
        late += int((np.array(scan.lengths) > thinner + ROUNDING).sum())
        count += len(scan.lengths)
    assert count > 3000
    assert late < 0.02 * count


@given(standing(), st.floats(-10.0, 10.0))
@settings(max_examples=50)
def test_between_two_headings_no_more_is_free_than_along_either(seen, heading):
    field, here = seen
    scan = scan_360(observe(field, here))
    apart = np.array([wrap_angle(one - heading) for one in scan.headings])
    assume(np.abs(apart).min() > ROUNDING)
    left = int(np.where(apart > 0.0, apart, np.inf).argmin())
    right = int(np.where(apart < 0.0, apart, -np.inf).argmax())
    assert scan.free(heading) == min(scan.lengths[left], scan.lengths[right])
    assert scan.free(heading + math.tau) == scan.free(heading)


@given(standing())
@settings(max_examples=50)
def test_walls_lie_where_the_centre_of_the_disc_would_be_stopped(seen):
    field, here = seen
    walls = scan_360(observe(field, here)).boundary
    assert walls.shape[1:] == (2, 2)
    if len(walls):
        clearance = field.clearance(walls.reshape(-1, 2))
        assert clearance.max() <= WIDE + ROUNDING
        assert clearance.min() >= WIDE - HIDDEN
        # Each is one piece of one boundary, from one heading to the next: 3°, or where it recedes.
        assert np.hypot(*(walls[:, 1] - walls[:, 0]).T).max() <= math.hypot(0.3, math.radians(3.0))


def test_a_wall_in_front_is_seen_without_a_hole_and_its_end_is_open():
    field = Field(boxes=np.array([[1.0, 1.0, 0.2, 2.4, 0.0]]))  # from y = −0.2 up to 2.2
    walls = scan_360(observe(field, (0.0, 0.0))).boundary
    known = map_of(walls)
    crossed = [y for y in np.arange(-0.3, 0.45, 0.01) if not known.in_sight((0.0, y), (2.0, y))]
    assert crossed
    assert np.diff(crossed) == pytest.approx(0.01)
    assert crossed[-1] == pytest.approx(0.44)
    assert crossed[0] == pytest.approx(-0.3)  # −0.2 and half the width are blocked
    assert known.in_sight((0.0, -0.45), (2.0, -0.45))


def test_where_nothing_stands_all_is_free_and_there_are_no_walls():
    scan = scan_360(observe(Field(), (3.0, 2.0)))
    assert set(scan.lengths) == {RANGE}
    assert scan.boundary.shape == (0, 2, 2)
    assert scan.gaps == []


@pytest.mark.parametrize("apart", [0.2, 0.205, 0.215])
def test_what_the_robot_stands_too_near_to_does_not_keep_it_from_moving_away(apart):
    for field in (
        Field(np.array([[0.0, apart + 0.2, 0.2]])),
        Field(boxes=np.array([[0.0, apart + 0.1, 4.0, 0.2, 0.0]])),
    ):
        scan = scan_360(observe(field, (0.0, 0.0)))
        assert scan.free(math.pi / 2) == pytest.approx(0.0, abs=0.002)
        for turn in np.radians([20.0, 60.0, 90.0, 120.0, 160.0]):
            assert scan.free(-turn) == RANGE
        assert all(map(math.isfinite, scan.lengths))


def test_a_robot_beside_a_wall_sees_the_way_along_it():
    scan = scan_360(observe(Field(boxes=np.array([[0.0, 0.31, 4.0, 0.2, 0.0]])), (0.0, 0.0)))
    assert scan.free(-0.03) == pytest.approx(1.0)
    assert scan.free(math.pi + 0.03) == pytest.approx(1.0)
    assert scan.free(math.pi / 2) < 0.02


def seen_between(width, distance, aside, turned):
    """Return gaps and free ways that a robot sees between two cylinders."""
    turn = np.array([[math.cos(turned), -math.sin(turned)], [math.sin(turned), math.cos(turned)]])
    centres = np.array([[0.0, 0.2 + width / 2], [0.0, -0.2 - width / 2]]) @ turn.T
    here = tuple((turn @ (-distance, aside)).tolist())
    field = Field(np.column_stack([centres, [0.2, 0.2]]))
    assert field.clearance([here])[0] >= WIDE
    scan = scan_360(observe(field, here))
    towards = math.atan2(-here[1], -here[0])

    def between(k):
        return abs(wrap_angle(scan.headings[k] - towards)) < 0.35

    through = min(RANGE, math.hypot(distance, aside) + 0.05)
    ways = [k for k, length in enumerate(scan.lengths) if between(k) and length >= through]
    return [k for k in scan.gaps if between(k)], ways


TURNS = np.linspace(0.0, math.radians(3.0), 5)


@pytest.mark.parametrize("distance", [0.4, 0.6, 0.8, 0.9])
def test_a_gap_two_centimetres_wider_than_a_line_is_seen(distance):
    for aside in (-0.25, -0.1, 0.0, 0.05, 0.15):
        for turned in TURNS:
            gaps, ways = seen_between(0.46, distance, aside, turned)
            assert gaps or ways


@pytest.mark.parametrize("distance", [0.4, 0.6, 0.8, 0.9])
def test_where_a_gap_is_as_wide_as_a_line_the_way_into_it_is_told_as_one(distance):
    for aside in (-0.1, 0.0, 0.05, 0.15):
        for turned in TURNS:
            gaps, ways = seen_between(0.44, distance, aside, turned)
            assert gaps or ways
            assert gaps or aside  # straight in front, too, where no line goes through


@pytest.mark.parametrize("distance", [0.3, 0.4, 0.5, 0.6])
def test_a_gap_too_narrow_is_none_seen_from_the_front(distance):
    # The disc touches both sides 0.419 m apart, 1.6 cm less than what is taken for a gap; rays 3°
    # apart meet the sides up to 1.6 cm beside that: farther off, or aslant, it may seem wider.
    for aside in (-0.1, 0.0, 0.05, 0.1):
        if math.hypot(distance, 0.4 - abs(aside)) < 0.42:
            continue
        for turned in TURNS:
            assert seen_between(0.40, distance, aside, turned) == ([], [])


@pytest.mark.parametrize("distance", [0.4, 0.5, 0.7, 0.9])
def test_a_gap_far_too_narrow_is_none_from_wherever_it_is_seen(distance):
    for aside in (-0.2, -0.1, 0.0, 0.15):
        for turned in TURNS:
            assert seen_between(0.30, distance, aside, turned) == ([], [])
