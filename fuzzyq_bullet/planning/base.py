"""What a planner sees, what it decides, and the one method it has."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple, Protocol, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]
Numbers: TypeAlias = Sequence[float] | Floats
"""A few numbers, in whatever holds them: plain ones are the faster for so few."""
Table: TypeAlias = Sequence[Sequence[float]] | Floats
Mode: TypeAlias = Literal["routine", "breakout", "following"]
MODES: tuple[Mode, ...] = get_args(Mode)

STEP_UNIT = 0.2
"""S_p of the default robot, the standard single step (m): the unit of the fuzzy controller."""
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
        unit: S_p, the unit of the fuzzy controller (m): the robot's radius.
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
    unit: float = STEP_UNIT

    @property
    def slowness(self) -> float:
        """How many times as long as usual the robot is to be waited for, at least 1."""
        return 1.0 if self.motion is None else self.motion.slowness


_NAN = float("nan")
_NO_SETS = (_NAN,) * 5


class Decision(NamedTuple):
    """Where to go next, and everything a picture needs to show why.

    Only ``heading``, ``step`` and ``reach`` move the robot. The rest explains the decision; a
    planner without fuzzy sets leaves it at its blank (NaN) default.

    Attributes:
        heading: World heading of the next step (rad).
        step: Length of the next step (m), at least 0 (Eq. 17: ω1·N_s·S_p).
        reach: Distance known to be free along the way (m); the wheels brake so that the robot
            could stop within it. Infinite where nothing was checked.
        mode: The part of the planner that decided.
        lines: World headings of the left, middle and right detection lines (rad), shape (3,).
        lengths: Their sensed free lengths (m), shape (3,).
        distance: d, the fuzzy controller's first input, in units of S_p.
        difference: Df = left − right (Eq. 14), its second input, in units of S_p.
        near: Memberships of d in VN, N, M, F, VF, shape (5,).
        side: Memberships of Df in NB, NS, ZO, PS, PB, shape (5,).
        rules: Firing strengths (Eq. 2), shape (5, 5): a row for each label of d, a column for Df.
        turn: N_a, the turn scale in [−2, 2], positive to the left.
        stride: N_s, the step scale in [0, 2].
        weights: (ω1, ω2) of Eq. 17: of the step and of the turn.
        breakout_at: c_f, in units of S_p: with less than this free towards the goal it breaks out.
        guard: Free length sensed along the final heading (m), NaN where not sensed.
        target: The temporary goal of a way out (m), NaN when there is none.
        hopeless: True when the planner knows that it cannot go on; the episode ends as ``stuck``.
    """

    heading: float
    step: float
    reach: float = float("inf")
    mode: Mode = "routine"
    lines: Numbers = (_NAN,) * 3
    lengths: Numbers = (_NAN,) * 3
    distance: float = _NAN
    difference: float = _NAN
    near: Numbers = _NO_SETS
    side: Numbers = _NO_SETS
    rules: Table = (_NO_SETS,) * 5
    turn: float = _NAN
    stride: float = _NAN
    weights: tuple[float, float] = (_NAN, _NAN)
    breakout_at: float = _NAN
    guard: float = _NAN
    target: tuple[float, float] = (_NAN, _NAN)
    hopeless: bool = False


class Planner(Protocol):
    """A local planner: one observation in, one decision out.

    A planner lives for one episode and may keep a memory within it.
    """

    def decide(self, observation: Observation, /) -> Decision:
        """Choose the next heading and step."""
        ...
