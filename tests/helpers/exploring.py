"""What the tests of scan, exploration and escape share: a robot that observes with exact rays."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st

from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.planning import Observation, RangeSensor
from fuzzyq_bullet.planning.escape.cost_to_go import ObstacleMap

RANGE, BODY, WIDE = 1.0, 0.2, 0.22
"""How far the robot sees, its radius and half the width of a detection line (m)."""

HIDDEN = 0.07
"""How much of what the disc would touch may stand unseen between two rays (m).

The disc slides along something: the ray that meets it last before the place of contact and the
next one, 3° on, leave up to ρ²·sin 3° / r = 0.27 m of a flat face between them, which is
half of that from the nearer hit: a disc of √(0.22² − 0.14²) = 0.17 m would still touch it. At a
corner met from one side 1.22 m · sin 3° = 0.064 m are lost, and more only behind a cylinder thinner
than 0.2 m."""
ROUNDING = 1e-6
"""Headings are told to so much (rad), and so many metres more or less make no difference."""


def map_of(seen):
    walls = ObstacleMap()
    walls.add(seen)
    return walls


def observe(field, here, *, goal=(100.0, 0.0), time=0.0, sense=None, size=1.0):
    """Return what a robot, so many times as large as usual, observes with exact rays."""
    far, wide = size * RANGE, size * WIDE
    return Observation(
        time=time,
        position=here,
        heading=0.0,
        speed=0.0,
        turn_rate=0.0,
        goal=goal,
        goal_radius=0.2,
        range=far,
        radius=wide,
        sensor=RangeSensor(
            sense or (lambda headings: field.free_distance(here, headings, wide, far)),
            lambda headings: field.free_distance(here, headings, 0.0, far + wide),
        ),
        unit=size * BODY,
    )


def free(field, here, there, radius):
    """Return whether a disc can move straight from one point to another."""
    way = math.dist(here, there)
    heading = math.atan2(there[1] - here[1], there[0] - here[0])
    return bool(field.free_distance(here, [heading], radius, way)[0] >= way - ROUNDING)


@st.composite
def standing(draw):
    """A robot that stands free somewhere in a world of things at least 0.4 m thick."""
    place = st.floats(0.0, 4.0)
    size = st.floats(0.4, 1.2)
    cylinders = draw(st.lists(st.tuples(place, place, st.floats(0.2, 0.5)), max_size=8))
    boxes = draw(st.lists(st.tuples(place, place, size, size, st.floats(0.0, 3.1)), max_size=4))
    field = Field(np.array(cylinders), np.array(boxes), draw(st.sampled_from([(4.0, 4.0), None])))
    here = draw(st.tuples(st.floats(0.3, 3.7), st.floats(0.3, 3.7)))
    assume(field.clearance([here])[0] >= WIDE)
    return field, here
