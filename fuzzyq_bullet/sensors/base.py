"""Sensor models by name: what a sensor tells of the lengths that its rays really have."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from fuzzyq_bullet.blame import blamed
from fuzzyq_bullet.errors import SensorError
from fuzzyq_bullet.quantities import ModelRegistry, Number
from fuzzyq_bullet.robots import RobotModel

Floats: TypeAlias = NDArray[np.float64]

MOST_RANGE = 10.0
"""Longest range that a scenario may ask for (m)."""


class SensorModel(BaseModel):
    """What a scenario file says of the sensor, and what the sensor makes of it.

    A sensor of your own is a subclass with a name and a method ``measure``, made known by
    ``register_sensor``. Its other fields are keys of ``sensor`` in the scenario file. Every ray
    goes through ``measure``: those of the detection lines, and single rays. Every sensor has a
    range, without doing anything for it: its rays are cast no farther.

    Attributes:
        model: Which sensor it is.
        range: Longest distance that a detection line tells (m); None for 5·S_p.
        noise: Standard deviation of a length (m); like the rest it comes on top of ``measure``.
        quantisation: Lengths are told in steps of this (m), rounded down; 0 for exactly.
        dropout: Share of the rays that meet something and tell nothing.
        blind: What is nearer than this to the robot's centre (m) is not seen.
        rate: Readings a second; None for a new one for every decision.
        pose_noise: Standard deviation of x, and of y, of the pose that the planner is told (m).
        heading_noise: Standard deviation of its heading (rad).
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    model: str
    range: Annotated[Number, Field(gt=0.0, le=MOST_RANGE)] | None = Field(
        default=None,
        description="How far the robot sees (m); by default five of its radii, the paper's 5·S_p.",
    )
    noise: Annotated[Number, Field(ge=0.0, le=1.0)] = Field(
        default=0.0, description="Standard deviation of a ray's length (m)."
    )
    quantisation: Annotated[Number, Field(ge=0.0, le=0.5)] = Field(
        default=0.0, description="Lengths are told in steps of this (m), rounded down."
    )
    dropout: Annotated[Number, Field(ge=0.0, le=0.5)] = Field(
        default=0.0, description="Share of the rays that tell nothing although they meet something."
    )
    blind: Annotated[Number, Field(ge=0.0, le=2.0)] = Field(
        default=0.0, description="What is nearer to the robot's centre (m) is not seen."
    )
    rate: Annotated[Number, Field(ge=1.0, le=240.0)] | None = Field(
        default=None, description="Readings a second; by default one for every decision."
    )
    pose_noise: Annotated[Number, Field(ge=0.0, le=1.0)] = Field(
        default=0.0,
        description="Standard deviation of x and y of the pose that is told (m); it drifts.",
    )
    heading_noise: Annotated[Number, Field(ge=0.0, le=0.5)] = Field(
        default=0.0, description="Standard deviation of the heading that is told (rad); it drifts."
    )

    @property
    def is_disturbed(self) -> bool:
        """Whether lengths are told otherwise than ``measure`` does."""
        return any((self.noise, self.quantisation, self.dropout, self.blind))

    def range_on(self, robot: RobotModel) -> float:
        """Return the longest distance (m) that a detection line of this robot tells."""
        return robot.sensor_range if self.range is None else self.range

    def measure(self, lengths: Floats, rng: np.random.Generator) -> Floats:
        """Return what the sensor tells of rays.

        Args:
            lengths: For each ray the distance (m) from where it begins to what it meets, infinite
                where it meets nothing; shape (N,).
            rng: The sensor's own random numbers, the same for the same seed of the scenario.

        Returns:
            The same as measured, shape (N,); at least 0 or infinite.
        """
        raise NotImplementedError

    def measured(self, lengths: Floats, rng: np.random.Generator) -> Floats:
        """Return what ``measure`` does, once it is sure that these are lengths.

        Raises:
            SensorError: If it raises, or they are not.
        """
        with blamed(f"sensor {self.model}", kind=SensorError):
            told = np.asarray(self.measure(lengths, rng), dtype=np.float64)
        if np.shape(told) != lengths.shape or not np.min(told) >= 0.0:
            raise SensorError(
                f"sensor {self.model}: measure must return {lengths.size} lengths of at least 0"
            )
        return told


_M = TypeVar("_M", bound=type[SensorModel])

SENSORS: ModelRegistry[SensorModel] = ModelRegistry("model", default="exact")

AnySensor: TypeAlias = Annotated[SensorModel, SENSORS]
"""What the key ``sensor`` of a scenario file holds: any of the registered models."""


def register_sensor(sensor: _M) -> _M:
    """Make a sensor model known by its name, so that scenario files may ask for it.

    As a decorator, in a file that ``--plugin FILE`` names::

        from typing import Literal

        import numpy as np
        from fuzzyq_bullet.sensors import SensorModel, register_sensor

        @register_sensor
        class Rounded(SensorModel):
            model: Literal["rounded"] = "rounded"
            step: float = 0.05

            def measure(self, lengths, rng):
                return np.floor(lengths / self.step) * self.step

    A scenario file then has ``sensor: {model: rounded, step: 0.1}``. Noise is a sensor too: it
    draws from ``rng``. A sensor of the package itself is a module here that
    ``sensors/__init__.py`` imports.

    Raises:
        ValueError: If it has no name, or the name is taken.
    """
    SENSORS.add(sensor)
    return sensor


@register_sensor
class ExactSensor(SensorModel):
    """Tells every length as it is."""

    model: Literal["exact"] = "exact"

    def measure(self, lengths: Floats, rng: np.random.Generator) -> Floats:  # noqa: D102
        return lengths
