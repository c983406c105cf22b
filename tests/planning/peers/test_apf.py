"""The potential field: its force, its minima, and what cures them."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyq_bullet.planning import ApfSettings
from fuzzyq_bullet.planning.peers.apf import force_of
from fuzzyq_bullet.planning.peers.surroundings import Surroundings
from tests.planning.peers.helpers import drive, drive_bundled, modes_of

U_TRAP = [
    {"shape": "box", "position": [5.5, 5.0], "size": [0.2, 2.2]},
    {"shape": "box", "position": [5.0, 6.0], "size": [1.0, 0.2]},
    {"shape": "box", "position": [5.0, 4.0], "size": [1.0, 0.2]},
]
BESIDE = {"shape": "cylinder", "position": [7.0, 5.45], "radius": 0.2}
"""Its edge is 0.05 m from a robot that stands in the goal at (7, 5)."""
RADIUS = 0.22


def one_point(x, y):
    """What a single ray tells that has met a point of this world; others meet nothing."""
    return Surroundings(
        headings=np.array([math.atan2(y, x)]),
        distances=np.array([math.hypot(x, y)]),
        met=np.array([True]),
        radius=RADIUS,
        reserve=0.0,
    )


def potential(position, point, goal, settings):
    """½·η·(1/ρ - 1)²·g² of one point, ρ and g in units of ρ0 (Ge and Cui, Eq. 4, n = 2)."""
    rho = (math.dist(position, point) - RADIUS) / settings.influence
    g = min(1.0, math.dist(position, goal) / settings.influence) if settings.gnron else 1.0
    return 0.5 * settings.repulsion * max(0.0, 1.0 / rho - 1.0) ** 2 * g * g


@given(
    st.floats(0.3, 0.7),
    st.floats(-3.0, 3.0),
    st.floats(0.2, 2.0),
    st.floats(-3.0, 3.0),
    st.booleans(),
)
def test_the_repulsion_is_the_gradient_of_its_potential(far, bearing, left, goal_at, gnron):
    settings = ApfSettings(influence=0.5, gnron=gnron)
    if abs(left - 0.5) < 1e-3 or abs(far - RADIUS - 0.5) < 1e-3:
        return  # at a kink
    point = (far * math.cos(bearing), far * math.sin(bearing))
    goal = (left * math.cos(goal_at), left * math.sin(goal_at))
    force = np.array(force_of(one_point(*point), goal_at, left, settings))
    pulled = min(1.0, left / settings.slow_within)
    force -= pulled * np.array([math.cos(goal_at), math.sin(goal_at)])
    h = 1e-6
    slope = [
        (potential(dx, point, goal, settings) - potential((-dx[0], -dx[1]), point, goal, settings))
        / (2 * h)
        for dx in ((h, 0.0), (0.0, h))
    ]
    assert force == pytest.approx(-settings.influence * np.array(slope), rel=1e-4, abs=1e-6)


def test_what_is_farther_than_the_influence_does_not_repel():
    settings = ApfSettings(influence=0.4)
    assert force_of(one_point(0.0, 0.63), 0.0, 5.0, settings) == pytest.approx((1.0, 0.0))
    assert force_of(one_point(0.0, 0.5), 0.0, 5.0, settings)[1] < 0.0


def test_in_a_goal_beside_an_obstacle_only_the_cured_field_is_at_rest():
    around = dataclasses.replace(one_point(0.0, 0.27))
    cured, plain = (
        math.hypot(*force_of(around, 0.3, 1e-6, ApfSettings(gnron=on))) for on in (True, False)
    )
    assert cured < 1e-3
    assert plain > 0.5


def test_only_the_cured_field_reaches_a_goal_beside_an_obstacle():
    goal = {"position": [7.0, 5.0], "radius": 0.05}
    cured, plain = (
        drive({"name": "apf", "gnron": on, "escape": False, "repulsion": 0.5}, [BESIDE], goal=goal,
              limits={"time": 40.0})
        for on in (True, False)
    )  # fmt: skip
    assert cured.outcome == "goal"
    assert plain.outcome == "stuck"
    assert math.dist(plain.ticks.position[-1], (7.0, 5.0)) < 0.5


def test_without_the_escape_it_stays_in_a_u_and_with_it_gets_out():
    trapped = drive({"name": "apf", "escape": False}, U_TRAP)
    assert trapped.outcome == "stuck"
    x, y = trapped.ticks.position[-1]
    assert 4.5 < x < 5.4
    assert 4.1 < y < 5.9
    free = drive("apf", U_TRAP)
    assert free.outcome == "goal"
    assert set(modes_of(free)) == {"routine", "breakout"}


@pytest.mark.slow
def test_it_gets_out_of_the_bundled_traps():
    for name in ("semicircle", "u-shape"):
        assert drive_bundled(name, "apf").outcome == "goal"
