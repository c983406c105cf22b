"""What the drives share: how far the robot surely is from everything, and one cast for one line."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyq_bullet.drives.apart import Apart
from fuzzyq_bullet.drives.sensor import CastOnce
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.physics.sight import Sight
from fuzzyq_bullet.scenario import Arena, Cylinder

FIELD = Field(np.array([[0.0, 0.0, 0.3], [1.5, 0.4, 0.2]]))

place = st.tuples(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0))


@given(st.lists(st.tuples(place, st.floats(0.0, 2.0)), min_size=1, max_size=20))
def test_what_is_surely_free_is_never_more_than_the_clearance(asked):
    apart = Apart(lambda x, y: float(FIELD.clearance([(x, y)])[0]))
    for (x, y), enough in asked:
        clearance = float(FIELD.clearance([(x, y)])[0])
        told = apart.by(x, y, enough)
        assert told <= clearance + 1e-9
        assert told >= enough or told == clearance


def test_it_is_measured_anew_only_where_that_may_matter():
    measured = []

    def measure(x, y):
        measured.append((x, y))
        return 1.0

    apart = Apart(measure)
    for k in range(8):
        assert apart.by(0.1 * k, 0.0, 0.25) == pytest.approx(1.0 - 0.1 * k)
    assert apart.by(0.8, 0.0, 0.25) == 1.0  # 0.2 m would be left of it
    assert measured == [(0.0, 0.0), (0.8, 0.0)]


def test_where_nothing_stands_it_is_asked_once():
    measured = []
    apart = Apart(lambda x, y: measured.append((x, y)) or math.inf)
    assert [apart.by(x, 0.0, 1.0) for x in range(5)] == [math.inf] * 5
    assert len(measured) == 1


def test_a_line_is_cast_once_and_told_as_often_as_asked():
    post = Cylinder(shape="cylinder", position=(3.0, 2.0), radius=0.3)
    with Sight([post], Arena(size=(6.0, 4.0))) as world:
        cast = []

        class Watched:
            def sense(self, origin, headings):
                cast.extend(headings)
                return world.sense(origin, headings)

        sense = CastOnce(Watched(), (2.0, 2.0))
        headings = [0.0, 1.0, 2.0, 0.0]
        first = sense(headings)
        assert first.tolist() == world.sense((2.0, 2.0), headings)
        assert sense([2.0, 0.5, 0.0]).tolist() == world.sense((2.0, 2.0), [2.0, 0.5, 0.0])
        assert sense([]).shape == (0,)
        assert sorted(cast) == [0.0, 0.5, 1.0, 2.0]
