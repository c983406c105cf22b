"""The robot's range sensor: detection lines as wide as the robot, and single rays."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.planning.base import RangeSensor
from fuzzyq_bullet.robots import RobotModel
from fuzzyq_bullet.sensors.base import SensorModel
from fuzzyq_bullet.sensors.noise import RayNoise
from fuzzyq_bullet.shapes.outlines import FINEST

Floats: TypeAlias = NDArray[np.float64]
Point: TypeAlias = tuple[float, float]
Point3: TypeAlias = tuple[float, float, float]
Cast: TypeAlias = Callable[[Sequence[Point3], Sequence[Point3]], Sequence[float]]
"""From where rays start and end (m) to the part of each that is free, in [0, 1]; 1 where it meets
nothing."""

SENSOR_MARGIN = 0.02
"""How much wider than the robot a detection line is, on either side (m)."""
SPREAD = np.array([0.11, 0.33, 0.55, 0.75, 0.91, 1.0])
"""Offsets of the rays on either side, as parts of the line's half width.

Neighbours are at most 0.0484 m apart for the paper's robot, and denser towards the rim, where the
front of the disc falls back ever faster. The last but one runs just outside the robot's own side,
so that not even the flattest graze along a wall gets past it. Where that is too far apart, for a
larger robot or for thinner obstacles, there are more of them (``offsets``).
"""
WIDEST = 0.05
"""Rays are always nearer to each other than this (m): a right angle that points between two of them
then comes no nearer than half of it unseen, which the safety filter's reserve makes up for."""
BESIDE = 0.0002
"""How far outside the robot's own side the last ray but one runs at least (m): as far as ``SPREAD``
says for the paper's robot. For a larger one that would be within its side."""


def offsets(half_width: float, spacing: float = WIDEST, side: float = float(SPREAD[-2])) -> Floats:
    """Return the offsets of rays on either side, as parts of a line's half width.

    They are those of ``SPREAD``, and as many in between as are needed.

    Args:
        half_width: Half the width of a line (m).
        spacing: Neighbours are less than this apart (m); taken as within ``FINEST`` and ``WIDEST``.
        side: The last but one of ``SPREAD``.
    """
    spread = SPREAD.copy()
    spread[-2] = side
    spacing = min(max(spacing, FINEST), WIDEST)
    ends = np.append(-spread[0], spread)
    parts = (np.diff(ends) * half_width / spacing).astype(int) + 1
    parts[0] += 1 - parts[0] % 2  # odd: the rays in the middle are as many on either side
    found = [
        low + (high - low) * np.arange(1, count + 1) / count
        for low, high, count in zip(ends[:-1], ends[1:], parts.tolist(), strict=True)
    ]
    if parts.max() == 1:
        return spread
    every = np.concatenate(found)
    return np.asarray(every[every > 0.0])


class CorridorSensor:
    """Turns headings into rays, and what the rays meet into free distances.

    It replaces the distances from points of Eqs. 8 to 13. A detection line is a corridor a little
    wider than the robot, sensed by parallel rays, from the inside out and right before left. They
    start on the disc's diameter; the free distance is counted from its front rim. The two
    outermost rays start outside of the robot, within the margin, where there may be an obstacle
    already. A probe from the robot's side to each of these two starts shows that, and then the ray
    is left out: what stands beside the robot does not stop it.

    Args:
        model: What is told of the rays' lengths.
        cast: Casts rays.
        robot: The robot, whose radius and sensor height they have, and range if the model has none.
        rng: Random numbers of the model.
        spacing: How far apart rays of a line may be (m): the width of the thinnest obstacle.
        noise: What disturbs the lengths, if anything does.

    Attributes:
        radius: Half the width of a detection line (m).
        range: Longest distance that a detection line tells (m).
    """

    def __init__(
        self,
        model: SensorModel,
        cast: Cast,
        robot: RobotModel,
        rng: np.random.Generator,
        spacing: float = WIDEST,
        noise: RayNoise | None = None,
    ) -> None:
        self._model = model
        self._cast = cast
        self._height = robot.sensor_height
        self._rng = rng
        self._noise = noise
        self.radius = wide = robot.radius + SENSOR_MARGIN
        self.range = model.range_on(robot)
        side = max(float(SPREAD[-2]), (robot.radius + BESIDE) / wide)
        aside = wide * offsets(wide, spacing, side)
        rims = np.sqrt(wide**2 - aside**2)
        self._rims = np.repeat(rims, 2)
        self._lengths = np.append(np.repeat(rims + self.range, 2), [SENSOR_MARGIN] * 2)
        # Of each ray of a line, the two probes last: how far to the right it starts and ends, and
        # how far ahead it ends.
        both = np.outer(aside, [1.0, -1.0]).ravel().tolist()
        ahead = self._lengths[:-2].tolist()
        self._aside = np.abs([*both, robot.radius, robot.radius])
        self._rays = [
            *zip(both, both, ahead, strict=True),
            (robot.radius, wide, 0.0),
            (-robot.radius, -wide, 0.0),
        ]

    def at(self, origin: Point, misled: float = 0.0) -> RangeSensor:
        """Return what can be asked when the robot's centre is at a point (m).

        Args:
            origin: The point.
            misled: How far to the left of the truth the robot believes to face (rad): so far to the
                right of what it asks for go the rays.
        """

        def true(headings: Sequence[float]) -> Sequence[float]:
            return [one - misled for one in headings] if misled else headings

        return RangeSensor(
            lambda headings: self.sense(origin, true(headings)),
            lambda headings: self.look(origin, true(headings)),
        )

    def sense(self, origin: Point, headings: Sequence[float]) -> list[float]:
        """Return how far the robot's disc could move from ``origin`` along each heading.

        Args:
            origin: Centre of the robot (m).
            headings: World headings (rad), at least one and at most 1000.

        Returns:
            Free distance (m), one for each, in [0, ``range``].

        Raises:
            SensorError: If the sensor model fails.
        """
        # Plain numbers: for so few rays arrays take twice as long.
        (x, y), z = origin, self._height
        starts, ends = [], []
        for heading in headings:
            cos, sin = math.cos(heading), math.sin(heading)
            for start, end, ahead in self._rays:
                starts.append((x + start * sin, y - start * cos, z))
                ends.append((x + (ahead * cos + end * sin), y + (ahead * sin - end * cos), z))
        lengths = self._told(starts, ends, self._lengths, self._aside)
        lengths = lengths.reshape(len(headings), -1)
        rays, probes = lengths[:, :-2], lengths[:, -2:]
        rays[:, -2:][probes < np.inf] = np.inf
        # A free line is exactly as long as the range, not rounded.
        nearest: list[float] = (rays - self._rims).min(axis=1).tolist()
        return [max(0.0, min(self.range, one)) for one in nearest]

    def look(self, origin: Point, headings: Sequence[float]) -> Floats:
        """Return the distance (m) from ``origin`` to what stands there along each heading.

        Args:
            origin: Centre of the robot (m).
            headings: World headings (rad), at least one and at most 1000.

        Returns:
            Shape (K,), each in [0, reach]; the reach is ``range`` from the rim of a line.

        Raises:
            SensorError: If the sensor model fails.
        """
        reach = self.range + self.radius
        (x, y), z = origin, self._height
        ends = [(x + reach * math.cos(one), y + reach * math.sin(one), z) for one in headings]
        lengths = self._told([(x, y, z)] * len(ends), ends, np.array([reach]), np.zeros(1))
        return np.minimum(lengths, reach)

    def _told(
        self, starts: Sequence[Point3], ends: Sequence[Point3], lengths: Floats, aside: Floats
    ) -> Floats:
        """Return the measured length (m) of each ray, infinite where nothing is met.

        Every ray of the robot passes here.

        Args:
            starts: Where the rays start (m), those of one line after those of another.
            ends: Where they end (m).
            lengths: How long the rays of each line are (m), shape (R,).
            aside: How far from the robot's centre they begin (m), shape (R,).
        """
        free = np.array(self._cast(starts, ends)).reshape(-1, lengths.size)
        met = np.where(free < 1.0, free * lengths, np.inf).ravel()
        told = self._model.measured(met, self._rng)
        if self._noise is None:
            return told
        return self._noise.disturbed(told, np.tile(aside, len(free)))
