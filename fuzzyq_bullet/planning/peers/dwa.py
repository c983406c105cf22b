"""The planner ``dwa``: the dynamic window approach of Fox, Burgard and Thrun (1997).

D. Fox, W. Burgard, S. Thrun: The dynamic window approach to collision avoidance. IEEE Robotics and
Automation Magazine 4(1), 1997. It searches among pairs of speed and turn rate, each held on a
circular arc:

- *Dynamic window* V_d: what the wheels can come to within one interval.
- *Admissible* V_a: v ≤ √(2·dist·a) and ω ≤ √(2·dist·α), so that it can stop before what stands on
  the arc; dist is the length of the arc up to the first contact of the robot's disc.
- Of these it takes the pair with the greatest α·heading + β·dist + γ·velocity, each from 0 to 1,
  smoothed over the neighbouring pairs. ``heading`` is 1 − |angle to the goal| / π where the robot
  would come to rest if it braked after the interval.
- If no pair that moves ahead is admissible, it turns on the spot until one is.

What is different here: the robot's disc meets points that rays have hit, in place of the paper's
obstacle lines from sonar. The admissible speed counts the way driven during one period, because the
next answer comes only then. Left out: the paper's slowly changing weights and its estimate of the
robot's speed near doors. It has no memory but which way it turns on the spot, so that dead ends
hold it.

Tuning (docs/results/peers.md): the best of 20 settings on 24 training fields.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, ValidationInfo, field_validator
from pydantic_core import PydanticCustomError

from fuzzyq_bullet.geometry import wrap_angle
from fuzzyq_bullet.planning.base import Floats, Motion, Observation
from fuzzyq_bullet.planning.commands import TwistCommand
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.planning.peers.surroundings import (
    TOUCHING,
    PeerSettings,
    look_around,
    to_goal,
)
from fuzzyq_bullet.planning.safety_filter import RESERVE
from fuzzyq_bullet.quantities import Number

SPEEDS, RATES = 9, 31
"""Pairs tried: so many speeds times so many turn rates, evenly spaced over the window."""
STRAIGHT = 1e-3
"""An arc is bent by at least this much (1/m), so that one formula serves straight lines too."""
CRAWL = 0.02
"""What is slower than this (m/s) is no way ahead."""
TIE = 0.01
"""What is less far aside than this (m) is straight ahead."""

_Weight = Annotated[Number, Field(ge=0.0, le=100.0)]


class DwaSettings(PeerSettings):
    """The dynamic window approach of Fox, Burgard and Thrun (1997)."""

    needs_wheels: ClassVar[bool] = True

    name: Literal["dwa"] = "dwa"
    heading: _Weight = Field(default=1.0, description="α: weight of facing the goal.")
    clearance: _Weight = Field(default=0.5, description="β: weight of the free length of the arc.")
    velocity: _Weight = Field(default=0.5, description="γ: weight of the speed.")
    interval: Annotated[Number, Field(gt=0.0, le=2.0)] = Field(
        default=0.25,
        description="Within it the wheels must come to a speed and turn rate (s); at least one "
        "period between decisions.",
    )
    horizon: Annotated[Number, Field(gt=0.0, le=5.0)] = Field(
        default=0.25, description="How far ahead the facing of the goal is judged (s)."
    )
    margin: Annotated[Number, Field(ge=0.0, le=1.0)] = Field(
        default=0.02, description="How much more than half a detection line stays free (m)."
    )

    @field_validator("velocity")
    @classmethod
    def _one_weighs(cls, value: float, info: ValidationInfo) -> float:
        others = [info.data.get(key) for key in ("heading", "clearance")]
        if value == 0.0 and others == [0.0, 0.0]:
            raise PydanticCustomError(
                "weights", "heading, clearance and velocity are all 0: one must be greater"
            )
        return value

    def doubts(self) -> Iterator[tuple[str, str]]:
        """Yield what is allowed and yet hardly meant."""
        yield from super().doubts()
        period = 1.0 / self.rate
        if "interval" in self.model_fields_set and self.interval < period - 1e-9:
            yield (
                "interval",
                f"{self.interval:g} s is shorter than the {period:.3g} s between two decisions "
                f"(rate {self.rate:g}): it counts as {period:.3g} s",
            )


class Window(NamedTuple):
    """The pairs that are tried, those that cannot stop in time included.

    Attributes:
        speeds: Forward speeds (m/s), shape (S,).
        rates: Turn rates (rad/s), shape (W,).
        free: Free length of each arc (m), shape (S, W): at most the sensor's range.
        admissible: Whether the robot can stop within it, shape (S, W).
    """

    speeds: Floats
    rates: Floats
    free: Floats
    admissible: NDArray[np.bool_]


class DwaPlanner:
    """Chooses among the twists that the wheels can come to, by an objective of three parts."""

    def __init__(self, settings: DwaSettings) -> None:
        self._settings = settings
        self._turning = 0.0

    def decide(self, observation: Observation, /) -> TwistCommand:
        """Return the best admissible twist of the window, or one that turns on the spot."""
        motion = observation.motion
        if motion is None:  # a point has no wheels: the episode refuses any twist with one line
            return TwistCommand(0.0, 0.0)
        settings = self._settings
        interval = max(settings.interval, motion.period + motion.latency)
        around = look_around(observation)
        points = _turned(around.points, -observation.heading)
        wide = around.radius + settings.margin
        window = window_of(observation, motion, interval, points, wide)
        told = Decision(0.0, 0.0, aim=observation.goal)
        ahead = window.admissible & (window.speeds > CRAWL)[:, None]
        if not ahead.any():
            return TwistCommand(
                0.0,
                self._turn_away(points, observation) * motion.max_turn_rate,
                told._replace(mode="breakout"),
            )
        self._turning = 0.0
        worth = np.where(window.admissible, self._worth(window, observation, motion), 0.0)
        worth = np.where(ahead, _smoothed(worth), -1.0)
        speed, rate = np.unravel_index(int(np.argmax(worth)), worth.shape)
        return TwistCommand(float(window.speeds[speed]), float(window.rates[rate]), told)

    def _worth(self, window: Window, observation: Observation, motion: Motion) -> Floats:
        """Return α·heading + β·dist + γ·velocity of each pair, shape (S, W)."""
        speeds, rates = window.speeds[:, None], window.rates[None, :]
        horizon = self._settings.horizon
        seconds = horizon + speeds / (2.0 * motion.acceleration)
        turned = rates * seconds
        chord = speeds * seconds * np.sinc(turned / math.tau)
        bearing, distance = to_goal(observation)
        ahead = bearing - observation.heading
        x = distance * math.cos(ahead) - chord * np.cos(turned / 2.0)
        y = distance * math.sin(ahead) - chord * np.sin(turned / 2.0)
        spun = rates * horizon + rates * np.abs(rates) / (2.0 * motion.turn_acceleration)
        off = np.abs(np.angle(np.exp(1j * (np.arctan2(y, x) - spun))))
        settings = self._settings
        return (
            settings.heading * (1.0 - off / math.pi)
            + settings.clearance * window.free / observation.range
            + settings.velocity * speeds / motion.max_speed
        )

    def _turn_away(self, points: Floats, observation: Observation) -> float:
        """Return to which side it turns on the spot: away from the nearest, until it can go on."""
        if self._turning == 0.0:
            nearest = points[np.argmin(np.hypot(*points.T))] if len(points) else np.zeros(2)
            beside = float(nearest[1])
            off = wrap_angle(to_goal(observation)[0] - observation.heading)
            self._turning = math.copysign(1.0, -beside if abs(beside) > TIE else off)
        return self._turning


def window_of(
    observation: Observation, motion: Motion, interval: float, points: Floats, radius: float
) -> Window:
    """Return the pairs that the wheels can come to, and which of them are admissible.

    Args:
        observation: What the robot does now.
        motion: Its limits.
        interval: Within it the wheels must come to them (s).
        points: What the rays have hit, seen from the robot (m), x ahead, shape (H, 2).
        radius: Radius of the disc that must not meet them (m).
    """
    gain, spin = motion.acceleration * interval, motion.turn_acceleration * interval
    most = motion.max_turn_rate
    speeds = np.linspace(
        min(max(0.0, observation.speed - gain), motion.max_speed),
        max(0.0, min(observation.speed + gain, motion.max_speed)),
        SPEEDS,
    )
    low, high = max(-most, observation.turn_rate - spin), min(most, observation.turn_rate + spin)
    rates = np.linspace(low, high, RATES)
    if low <= 0.0 <= high:
        rates[np.argmin(np.abs(rates))] = 0.0
    free = np.minimum(free_arcs(speeds, rates, points, radius), observation.range)
    usable = np.maximum(free - RESERVE - observation.uncertainty, 0.0)
    usable = np.maximum(usable - speeds[:, None] * (motion.period + motion.latency), 0.0)
    stops = speeds[:, None] <= np.sqrt(2.0 * motion.acceleration * usable)
    straightens = np.abs(rates) <= np.sqrt(2.0 * motion.turn_acceleration * usable)
    return Window(speeds, rates, free, (stops & straightens) | (speeds == 0.0)[:, None])


def free_arcs(speeds: Floats, rates: Floats, points: Floats, radius: float) -> Floats:
    """Return the length of each arc (m) until the disc meets a point; infinite if it never does.

    A point at the distance D from the centre of an arc of radius r is met where the disc's centre
    sees it, from the centre of the arc, under the angle φ: cos φ = (r² + D² − R²) / (2·r·D).

    Args:
        speeds: Forward speeds (m/s), shape (S,); turning on the spot never meets anything.
        rates: Turn rates (rad/s), shape (W,).
        points: Seen from the robot (m), x ahead, shape (H, 2).
        radius: R, of the disc (m); less for points that are nearer already.

    Returns:
        Shape (S, W).
    """
    lengths = np.full((speeds.size, rates.size), np.inf)
    moving = speeds > 0.0
    if not len(points) or not moving.any():
        return lengths
    bend = rates[None, :] / speeds[moving, None]
    side = np.where(bend < 0.0, -1.0, 1.0)[..., None]
    r = 1.0 / np.maximum(np.abs(bend), STRAIGHT)[..., None]
    reach = np.minimum(radius, np.hypot(points[:, 0], points[:, 1]) - TOUCHING)
    x, y = points[:, 0], side * points[:, 1] - r
    far = np.hypot(x, y)
    cosine = (r * r + far * far - reach * reach) / np.maximum(2.0 * r * far, 1e-12)
    angle = np.arctan2(x, -y) - np.arccos(np.clip(cosine, -1.0, 1.0))
    arcs = np.where(np.abs(cosine) <= 1.0, r * (angle % math.tau), np.inf)
    lengths[moving] = arcs.min(axis=2)
    return lengths


def _turned(points: Floats, angle: float) -> Floats:
    cos, sin = math.cos(angle), math.sin(angle)
    turned: Floats = points @ np.array([[cos, sin], [-sin, cos]])
    return turned


def _smoothed(worth: Floats) -> Floats:
    """Return the mean of each pair and its eight neighbours; beyond the edge the edge counts."""
    around = np.pad(worth, 1, mode="edge")
    rows = around[:-2] + around[1:-1] + around[2:]
    mean: Floats = (rows[:, :-2] + rows[:, 1:-1] + rows[:, 2:]) / 9.0
    return mean
