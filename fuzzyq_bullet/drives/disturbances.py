"""What comes between the planner and its robot: an error of the pose, slip, and latency.

Each draws from a stream of the scenario's seed that is its own, and none is there unless the
scenario asks for it.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

DRIFT = 5.0
"""Time (s) after which an error of the pose has become another."""
_STREAMS = {"noise": 10, "dropout": 11, "pose": 12, "slip": 13}
SURE = 3.0
"""Errors of so many standard deviations are reckoned with."""


def stream(seed: int, name: str) -> np.random.Generator:
    """Return the random numbers of one disturbance.

    Args:
        seed: That of the scenario.
        name: ``noise``, ``dropout``, ``pose`` or ``slip``.
    """
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(_STREAMS[name],)))


class PoseError(NamedTuple):
    """How far the pose that is told lies from the true one: x, y (m) and heading (rad)."""

    x: float = 0.0
    y: float = 0.0
    heading: float = 0.0


class Localiser:
    """Tells where the robot is with an error that drifts, as that of a localiser does.

    x, y and heading each follow an Ornstein-Uhlenbeck process of the time ``DRIFT``, which at any
    time is normally distributed.

    Args:
        position: Standard deviation of x, and of y (m).
        heading: Standard deviation of the heading (rad).
        rng: Random numbers.
    """

    def __init__(self, position: float, heading: float, rng: np.random.Generator) -> None:
        self._rng = rng
        self._scale = np.array([position, position, heading])
        self._error = self._scale * rng.standard_normal(3)
        self._time = 0.0

    def error(self, time: float) -> PoseError:
        """Return the error at a time (s), which is not before that of the last question."""
        if not self._scale.any():
            return PoseError()
        if time > self._time:
            kept = math.exp((self._time - time) / DRIFT)
            drawn = self._rng.standard_normal(3)
            self._error = kept * self._error + math.sqrt(1.0 - kept * kept) * self._scale * drawn
            self._time = time
        return PoseError(*self._error.tolist())
