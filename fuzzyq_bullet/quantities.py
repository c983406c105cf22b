"""Numbers and points within bounds, of which everything that a scenario file gives is built."""

from __future__ import annotations

from typing import Annotated, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, Strict

Number: TypeAlias = Annotated[float, Strict(), Field(allow_inf_nan=False)]
Coordinate: TypeAlias = Annotated[Number, Field(ge=-1000.0, le=1000.0)]
Length: TypeAlias = Annotated[Number, Field(gt=0.0, le=1000.0)]
Angle: TypeAlias = Annotated[Number, Field(ge=-100.0, le=100.0)]
Count: TypeAlias = Annotated[int, Strict()]
Flag: TypeAlias = Annotated[bool, Strict()]
Point: TypeAlias = tuple[Coordinate, Coordinate]

ANGLE_KEYS = ("heading", "yaw", "direction")
"""What keys of angles are called, all in radians."""
MAX_OBSTACLES = 10_000
MIN_RADIUS = 0.025
"""Nothing thinner than twice this is sure to be hit by a ray of a detection line (m)."""
TOUCH = 1e-6
"""Things closer than this (m) touch, and the physics counts a touch as a collision."""
DECIMALS = 4
"""Drawn coordinates are rounded to so many decimals of a metre."""


class Model(BaseModel):
    """Base of all that a scenario file holds: immutable, and unknown keys are mistakes."""

    model_config = ConfigDict(extra="forbid", frozen=True)
