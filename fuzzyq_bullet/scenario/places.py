"""Where a run takes place, what it passes, where it ends: arena, start, via points, goal."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator
from pydantic_core import PydanticCustomError

from fuzzyq_bullet.quantities import Angle, Flag, Length, Model, Number, Point


class Arena(Model):
    """The rectangle the run takes place in."""

    size: tuple[Length, Length] = Field(default=(10.0, 10.0), description="Width and depth (m).")
    walls: Flag = Field(default=True, description="Whether walls stand on its four edges.")


class Start(Model):
    """Where the robot starts."""

    position: Point = Field(description="Centre of the robot (m).")
    heading: Angle | None = Field(
        default=None,
        description="Direction it faces (rad), anticlockwise from x; default: to the first via "
        "point, or the goal.",
    )


class Via(Model):
    """What the robot must pass on its way to the goal; it need not stop there."""

    position: Point = Field(description="Centre of the via point (m).")
    radius: Annotated[Number, Field(ge=0.05, le=10.0)] = Field(
        default=0.5, description="The robot's centre must come within it (m)."
    )


class Goal(Model):
    """Where the run ends."""

    position: Point = Field(description="Centre of the goal (m).")
    radius: Annotated[Number, Field(ge=0.05, le=10.0)] = Field(
        default=0.2, description="The robot's centre must come to rest within it (m)."
    )
    heading: Angle | None = Field(
        default=None,
        description="Direction to face in the end (rad): the robot turns to it on the spot.",
    )
    tolerance: Annotated[Number, Field(ge=0.02, le=3.2)] = Field(
        default=0.1, description="How far its heading may be off in the end (rad)."
    )
    stop: Flag = Field(default=True, description="Whether it must come to rest in the goal.")

    @model_validator(mode="after")
    def _can_turn(self) -> Goal:
        if self.heading is not None and not self.stop:
            raise PydanticCustomError(
                "heading_without_stop",
                "asks for a heading and stop: false; the robot turns to a heading at rest: leave "
                "out one of the two",
            )
        return self

    @model_serializer(mode="wrap")
    def _without_defaults(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Leave out what is not asked for: a field's digest is that of version 0.1.0 then."""
        told: dict[str, Any] = handler(self)
        for key in ("heading", "tolerance", "stop"):
            if key in told and told[key] == type(self).model_fields[key].default:
                del told[key]
        return told
