"""Whose fault a contact was, from the record alone."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.planning import Decision
from fuzzyq_bullet.recording.fault import at_fault, robot_speed
from fuzzyq_bullet.recording.trajectory import Collision, Trajectory
from fuzzyq_bullet.scenario.files import parse_scenario

WORLD = (
    "name: hit\narena: {size: [6.0, 4.0]}\nstart: {position: [1, 2]}\ngoal: {position: [5, 2]}\n"
)


def hit(speeds: list[float], period: float, drive: str = "wheels") -> Trajectory:
    """Return the record of a robot with these speeds (m/s) at its ticks, which touches a wall."""
    scenario = parse_scenario(f"{WORLD}drive: {drive}\n")
    times = np.arange(len(speeds)) * period
    states = [
        (t, 1.0, 2.0, 0.0, speed, 0.0, 0.0, 0.0) for t, speed in zip(times, speeds, strict=True)
    ]
    return Trajectory.from_episode(
        scenario,
        Field.of((), scenario.arena),
        states,
        [(0, Decision(0.0, 0.1))],
        outcome="collision",
        physics_steps=1,
        collision=Collision(float(times[-1]), (0.8, 2.0), -1, 1.0),
    )


@pytest.mark.parametrize(
    ("speeds", "period", "speed"),
    [
        # The last speed is what the contact has made of it; what is older than 0.3 s is over.
        ([0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 9.0], 0.05, 0.0),
        ([0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 9.0], 0.05, 0.5),
        ([0.0, 0.0, -0.4, 0.0, 0.0], 0.05, 0.4),
        # One that decides once a second has no tick within 0.3 s but that of the contact.
        ([0.0, 0.6, 9.0], 1.0, 0.6),
        ([0.6, 0.0, 9.0], 1.0, 0.0),
        ([0.3], 0.05, 0.3),
    ],
)
def test_the_greatest_speed_shortly_before_counts(
    speeds: list[float], period: float, speed: float
) -> None:
    record = hit(speeds, period)
    assert robot_speed(record) == pytest.approx(speed)
    assert at_fault(record)  # a wall comes to nobody


def test_a_point_is_as_fast_as_its_last_step() -> None:
    assert robot_speed(hit([0.0, 0.0], 0.5, "kinematic")) == pytest.approx(0.1 / 0.5)
    told = robot_speed(hit([0.3], 0.5, "kinematic"))  # a record of one tick
    assert told is not None
    assert math.isfinite(told)
