"""What a planner sees, and the one method it has."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.planning.decision import NUMBER, Numbers

if TYPE_CHECKING:
    from fuzzyq_bullet.planning.commands import Answer

Floats: TypeAlias = NDArray[np.float64]
Flags: TypeAlias = NDArray[np.bool_]

STEP_UNIT = 0.2
"""S_p of the default robot, the standard single step (m): the unit of the fuzzy controller."""
USUAL_RANGE = 5.0
"""How far the paper's detection lines reach, in S_p."""
LONGEST_STRIDE = 2.0
"""Upper end of N_s: the longest step is this many S_p."""

Sense: TypeAlias = Callable[[Sequence[float]], Sequence[float]]
"""Free distances (m) along world headings (rad), one for each, in one batch."""
Look: TypeAlias = Callable[[Sequence[float]], Numbers]
"""Distances (m) to what stands along world headings (rad), one for each, in one batch."""

MOST_HEADINGS = 1000
"""Most that may be asked for at once: PyBullet silently drops what is too much for one batch."""
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
        wheel_radius: Radius of the two wheels (m).
        track: Distance between them (m).
        latency: Time from a decision to the wheels (s).
    """

    max_speed: float
    max_turn_rate: float
    acceleration: float
    turn_acceleration: float
    period: float
    radius: float
    margin: float
    wheel_radius: float = 0.05
    track: float = 0.28
    latency: float = 0.0

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


class RangeSensor:
    """What can be asked of the robot's sensor at one instant.

    Parts of a planner ask in turn, often for the same: nothing is sensed twice. What is stored
    (pickled) is what was told: a stored sensor answers the same questions again, and no others.

    Args:
        sense: Free distances of the robot's disc (m) along world headings (rad), one for each.
        look: Distances (m) from the robot's centre to what stands along world headings (rad).
    """

    def __init__(self, sense: Sense, look: Look) -> None:
        self._sense = sense
        self._look = look
        self._lines: dict[float, float] = {}
        self._rays: dict[tuple[float, ...], Floats] = {}

    def sense(self, headings: Sequence[float]) -> list[float]:
        """Return the free distance (m) of the robot's disc along each of the headings (rad).

        Raises:
            ValueError: If a heading is no finite number, or there are more than 1000.
            LookupError: If the sensor was stored, and not asked for one of them before.
        """
        _check(headings)
        known = self._lines
        missing = [heading for heading in dict.fromkeys(headings) if heading not in known]
        if missing:
            known.update(zip(missing, self._sense(missing), strict=True))
        return [known[heading] for heading in headings]

    def look(self, headings: Sequence[float]) -> Floats:
        """Return the distance (m) to what stands along each of the headings (rad), shape (K,).

        Raises:
            ValueError: If a heading is no finite number, or there are more than 1000.
            LookupError: If the sensor was stored, and not asked for the same before.
        """
        _check(headings)
        asked = tuple(headings)
        if asked not in self._rays:
            self._rays[asked] = np.array(self._look(headings) if asked else (), dtype=np.float64)
        return self._rays[asked].copy()

    def __reduce__(self) -> tuple[Callable[..., RangeSensor], tuple[object, object]]:
        return _stored, (self._lines, self._rays)


def _stored(lines: dict[float, float], rays: dict[tuple[float, ...], Floats]) -> RangeSensor:
    """Return a sensor that tells again what it told before it was stored."""
    sensor = RangeSensor(_not_asked, _not_asked)
    sensor._lines.update(lines)
    sensor._rays.update(rays)
    return sensor


def _not_asked(headings: Sequence[float]) -> Sequence[float]:
    raise LookupError(f"a stored sensor was not asked for {len(headings)} of these headings")


def _check(headings: Sequence[float]) -> None:
    """Let nothing through that PyBullet would answer with nonsense.

    Raises:
        ValueError: If a heading is no finite number, or there are too many.
    """
    if len(headings) > MOST_HEADINGS:
        raise ValueError(f"{len(headings)} headings at once; at most {MOST_HEADINGS} are allowed")
    for heading in headings:
        if not isinstance(heading, NUMBER) or not math.isfinite(heading):
            raise ValueError(f"a heading must be a finite number, got {heading!r:.60}")


@dataclass(frozen=True, slots=True)
class Observation:
    """All a planner may know at one instant. It cannot see the map.

    Observations can be stored by ``pickle`` and compared: two are equal if everything but their
    sensors is equal. ``dataclasses.replace`` returns one with other values.

    Attributes:
        time: Time since the start (s).
        position: Centre of the robot (m), world frame, shape (2,).
        heading: Direction the robot faces (rad), anticlockwise from x.
        speed: Forward speed (m/s).
        turn_rate: Turn rate (rad/s), positive to the left.
        goal: Centre (m), world frame, shape (2,), of the next via point, or of the goal when all
            are passed.
        goal_radius: Radius of that (m).
        range: Longest distance the sensor tells (m): 5·S_p unless a scenario says more.
        radius: Half the width of a detection line (m): the robot's radius and a margin.
        sensor: What else can be sensed at this instant.
        motion: Limits of a body that must turn and brake, or None for the paper's point robot,
            which faces any way at once and stops at once (Eq. 17).
        unit: S_p, the unit of the fuzzy controller (m): the robot's radius.
        uncertainty: How much less may be free than the sensor tells (m), by its noise and whatever
            else the scenario disturbs.
        closing_speed: How fast what moves, or is not seen yet, may come (m/s): what the planner's
            settings say, else the greatest speed of the scenario's obstacles. 0 where all stand.
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
    sensor: RangeSensor = field(compare=False, repr=False)
    motion: Motion | None = None
    unit: float = STEP_UNIT
    uncertainty: float = 0.0
    closing_speed: float = 0.0

    def sense(self, headings: Sequence[float]) -> list[float]:
        """Return the free distance (m) along each of the world headings (rad).

        It is how far the robot's disc, and a margin, can move: at most ``range``.

        Raises:
            ValueError: If a heading is no finite number, or there are more than 1000.
        """
        return self.sensor.sense(headings)

    def look(self, headings: Sequence[float]) -> Floats:
        """Return the distance (m) from the robot's centre to what stands along each heading (rad).

        These are single rays; shape (K,), each at most ``range + radius``.

        Raises:
            ValueError: If a heading is no finite number, or there are more than 1000.
        """
        return self.sensor.look(headings)

    def backwards(self) -> Observation:
        """Return what is observed if the robot's back is taken for its front.

        What holds for a robot that drives forward then holds for one that backs up.
        """
        return replace(self, heading=self.heading + math.pi, speed=-self.speed)

    @property
    def slowness(self) -> float:
        """How many times as long as usual the robot is to be waited for, at least 1."""
        return 1.0 if self.motion is None else self.motion.slowness

    @property
    def sees_far(self) -> bool:
        """Whether the robot sees farther than the paper's lines reach, 5·S_p."""
        return self.range > USUAL_RANGE * self.unit * (1.0 + 1e-9)

    @property
    def size(self) -> float:
        """How many times as large as usual the robot is, at least 1.

        Ways out were tried and measured with the usual robot; the lengths (m) of whatever serves
        them are so many times as long. A smaller robot is not asked to be more exact.
        """
        return max(1.0, self.unit / STEP_UNIT)


class Planner(Protocol):
    """A local planner: one observation in, one answer out.

    A planner lives for one episode and may keep a memory within it. If it has a method ``close``,
    that is called when the episode is over.
    """

    def decide(self, observation: Observation, /) -> Answer:
        """Choose the next heading and step, or a twist, or speeds of the wheels."""
        ...
