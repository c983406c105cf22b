"""What comes between the true lengths of rays and what is told: noise, steps, lost readings."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.sensors.base import SensorModel

Floats = NDArray[np.float64]


class RayNoise:
    """Disturbs the lengths that a sensor tells, as its scenario asks for.

    Args:
        model: The sensor, whose ``noise``, ``quantisation``, ``dropout`` and ``blind`` count.
        errors: Random numbers of the noise.
        losses: Random numbers of the dropout. Each has a stream of its own, so that a scenario with
            both has the same noise as one without dropout.
    """

    def __init__(
        self, model: SensorModel, errors: np.random.Generator, losses: np.random.Generator
    ) -> None:
        self._model, self._errors, self._losses = model, errors, losses

    def disturbed(self, lengths: Floats, aside: Floats) -> Floats:
        """Return the lengths (m) as they are told, shape (N,), infinite where nothing is met.

        Args:
            lengths: For each ray the distance from where it begins to what it meets, shape (N,).
            aside: How far from the robot's centre each begins (m), shape (N,).
        """
        model = self._model
        told = lengths
        if model.noise > 0.0:
            told = np.maximum(told + self._errors.normal(0.0, model.noise, told.shape), 0.0)
        if model.quantisation > 0.0:
            told = np.where(
                np.isfinite(told), np.floor(told / model.quantisation) * model.quantisation, told
            )
        if model.dropout > 0.0:
            told = np.where(self._losses.random(told.shape) < model.dropout, np.inf, told)
        if model.blind > 0.0:
            told = np.where(np.hypot(lengths, aside) < model.blind, np.inf, told)
        return told
