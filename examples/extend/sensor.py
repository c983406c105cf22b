"""A sensor of your own: one that tells lengths in steps of 5 cm, rounded down.

    fuzzyq run SCENARIO --plugin examples/extend/sensor.py

where the scenario file has ``sensor: {model: rounded}``, or ``{model: rounded, step: 0.1}``.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from fuzzyq_bullet.sensors import SensorModel, register_sensor


@register_sensor
class Rounded(SensorModel):
    """Tells each length rounded down to a multiple of a step."""

    model: Literal["rounded"]
    step: float = Field(default=0.05, gt=0.0, le=1.0, description="Step of a length (m).")

    def measure(
        self, lengths: NDArray[np.float64], rng: np.random.Generator
    ) -> NDArray[np.float64]:
        """Round down; what meets nothing stays infinite."""
        return np.floor(lengths / self.step) * self.step
