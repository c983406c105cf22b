"""What an episode needs of a drive, whichever it is."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from fuzzyq_bullet.planning.base import LONGEST_STRIDE, Decision, Observation
from fuzzyq_bullet.scenario.models import Robot
from fuzzyq_bullet.trajectory import Collision


class Tick(NamedTuple):
    """The robot at one instant; units as in ``trajectory.Ticks``."""

    time: float
    x: float
    y: float
    heading: float
    speed: float
    turn_rate: float
    left_wheel: float
    right_wheel: float


class Driver(Protocol):
    """Moves the robot by one decision at a time and records where it was.

    Attributes:
        ticks: Every tick so far; the first is the start.
        steps: Steps of the simulation so far.
        collision: The first contact, after which the run is over.
        arrived: Whether the robot is where it should be.
        slowness: How many times as long as usual the robot is to be waited for, at least 1.
    """

    ticks: list[Tick]
    steps: int
    collision: Collision | None
    arrived: bool
    slowness: float

    def observe(self) -> Observation:
        """Return what the planner may know now."""
        ...

    def advance(self, decision: Decision) -> None:
        """Carry out one decision until the next one is due, a contact, or the arrival."""
        ...


def longest_step_time(robot: Robot) -> float:
    """Return how long the longest step of the controller lasts at full speed (s).

    It ties the paper's steps to time: a decision's step is driven at ``step / longest_step_time``,
    so the longest one is driven at ``max_speed``.
    """
    return LONGEST_STRIDE * robot.radius / robot.max_speed
