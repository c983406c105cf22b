"""What scenario models are built of: numbers within bounds, obstacles, and their limits."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

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
ROBOT_RADIUS = 0.2
"""Radius of the robot's disc (m): one unit of the paper; the shape in ``assets/robot.urdf``."""
MIN_RADIUS = 0.025
"""Nothing thinner than twice this is sure to be hit by a ray of a detection line (m)."""
TOUCH = 1e-6
"""Things closer than this (m) touch, and the physics counts a touch as a collision."""


class Model(BaseModel):
    """Base of all scenario models: immutable, and unknown keys are mistakes."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Cylinder(Model):
    """An upright cylinder."""

    shape: Literal["cylinder"]
    position: Point = Field(description="Centre (m).")
    radius: Annotated[Number, Field(ge=MIN_RADIUS, le=1000.0)] = Field(description="Radius (m).")


class Box(Model):
    """An upright box."""

    shape: Literal["box"]
    position: Point = Field(description="Centre (m).")
    size: tuple[
        Annotated[Number, Field(ge=2 * MIN_RADIUS, le=1000.0)],
        Annotated[Number, Field(ge=2 * MIN_RADIUS, le=1000.0)],
    ] = Field(description="Length along its own x and y (m).")
    yaw: Angle = Field(default=0.0, description="Turn of its own x axis (rad), anticlockwise.")


Obstacle: TypeAlias = Annotated[Cylinder | Box, Field(discriminator="shape")]
