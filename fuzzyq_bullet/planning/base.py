"""What a planner sees, and the one method it has."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.planning.decision import Decision

Floats: TypeAlias = NDArray[np.float64]

STEP_UNIT = 0.2
"""S_p, the standard single step (m): the unit of the fuzzy controller."""
LONGEST_STRIDE = 2.0
"""Upper end of N_s: the longest step is this many S_p."""

RangeSensor: TypeAlias = Callable[[Sequence[float]], Sequence[float]]
"""Free distances (m) along world headings (rad), one for each, in one batch."""
ThinRays: TypeAlias = Callable[[Sequence[float]], Floats]
"""Distances (m) along world headings (rad), shape (K,), in one batch."""


USUAL_SPEED = 0.6
"""Greatest speed (m/s) of the robot that all patience was measured with."""
USUAL_HALF_TURN = 2.0
"""How long that robot may take to turn round on the spot (s)."""


@dataclass(frozen=True, slots=True)
class Motion:
    """What the robot's body can do; the planner's braking rests on it.

    Attributes:
        max_speed: Greatest speed (m/s).
        max_turn_rate: Greatest turn rate (rad/s).
        acceleration: Greatest change of speed, up or down (m/s²).
        turn_acceleration: Greatest change of the turn rate (rad/s²).
        period: Time between two decisions (s).
        radius: Radius of the robot's disc (m).
        margin: How much wider than the disc a detection line is, on either side (m).
    """

    max_speed: float
    max_turn_rate: float
    acceleration: float
    turn_acceleration: float
    period: float
    radius: float
    margin: float

    def way_to_stop(self, speed: float) -> float:
        """Return the way (m) from full braking at ``speed`` (m/s) to a stop."""
        return speed * speed / (2.0 * self.acceleration)

    @property
    def slowness(self) -> float:
        """How many times as long as the usual robot it takes to drive or to turn; at least 1.

        Whatever waits for the robot, and gives up, waits so many times as long.
        """
        rate, change = self.max_turn_rate, self.turn_acceleration
        if rate * rate < math.pi * change:
            half_turn = math.pi / rate + rate / change
        else:  # it brakes again before it turns as fast as it could
            half_turn = 2.0 * math.sqrt(math.pi / change)
        return max(1.0, USUAL_SPEED / self.max_speed, half_turn / USUAL_HALF_TURN)


class Observation(NamedTuple):
    """All a planner may know at one instant. It cannot see the map.

    Attributes:
        time: Time since the start (s).
        position: Centre of the robot (m), world frame, shape (2,).
        heading: Direction the robot faces (rad), anticlockwise from x.
        speed: Forward speed (m/s).
        turn_rate: Turn rate (rad/s), positive to the left.
        goal: Centre of the goal (m), world frame, shape (2,).
        goal_radius: Radius of the goal (m).
        range: Longest distance the sensor tells (m): 5·S_p in the paper.
        radius: Half the width of a detection line (m): the robot's radius and a margin.
        sense: The range sensor: free distance along any world headings.
        look: The same sensor's single rays: distance from the robot's centre to what stands there,
            at most ``range + radius``.
        motion: Limits of a body that must turn and brake, or None for the paper's point robot,
            which faces any way at once and stops at once (Eq. 17).
    """

    time: float
    position: tuple[float, float]
    heading: float
    speed: float
    turn_rate: float
    goal: tuple[float, float]
    goal_radius: float
    range: float
    radius: float
    sense: RangeSensor
    look: ThinRays
    motion: Motion | None = None

    @property
    def slowness(self) -> float:
        """How many times as long as usual the robot is to be waited for, at least 1."""
        return 1.0 if self.motion is None else self.motion.slowness


class Planner(Protocol):
    """A local planner: one observation in, one decision out.

    A planner lives for one episode and may keep a memory within it.
    """

    def decide(self, observation: Observation, /) -> Decision:
        """Choose the next heading and step."""
        ...
