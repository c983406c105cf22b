"""Where a run takes place, what it passes, where it ends: arena, start, via points, goal."""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator
from pydantic_core import PydanticCustomError

from fuzzyq_bullet.quantities import Angle, Flag, Length, Model, Number, Point


class Bounds(NamedTuple):
    """The edges of a rectangle along the axes (m)."""

    left: float
    bottom: float
    right: float
    top: float

    @property
    def corners(self) -> list[tuple[float, float]]:
        """Its corners (m), anticlockwise from the lower left."""
        x0, y0, x1, y1 = self
        return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]

    def holds(self, x: float, y: float) -> bool:
        """Whether a point (m) is within it, or on its edge."""
        return self.left <= x <= self.right and self.bottom <= y <= self.top

    def __str__(self) -> str:
        return f"x {self.left:g} to {self.right:g} m, y {self.bottom:g} to {self.top:g} m"


class Arena(Model):
    """The rectangle the run takes place in."""

    size: tuple[Length, Length] = Field(default=(10.0, 10.0), description="Width and depth (m).")
    walls: Flag = Field(default=True, description="Whether walls stand on its four edges.")
    origin: Point = Field(default=(0.0, 0.0), description="Its lower left corner (m).")
    headroom: Length | None = Field(
        default=None,
        description="Up to this height (m) the obstacles are complete; a taller robot is refused. "
        "Default: they are complete for every robot.",
    )

    @model_serializer(mode="wrap")
    def _without_usual_keys(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Leave out an origin at (0, 0) and no headroom: the hash of a field stays the same."""
        told: dict[str, Any] = handler(self)
        if self.origin == (0.0, 0.0):
            told.pop("origin", None)
        if self.headroom is None:
            told.pop("headroom", None)
        return told

    @property
    def bounds(self) -> Bounds:
        """Its edges (m)."""
        (x, y), (width, depth) = self.origin, self.size
        return Bounds(x, y, x + width, y + depth)

    def bars(self, thick: float) -> list[tuple[float, float, float, float]]:
        """Return its four walls, which stand just outside.

        Args:
            thick: Their thickness (m).

        Returns:
            South, north, west and east; of each the centre and the size along x and y (m).
        """
        (x, y), (width, depth) = self.origin, self.size
        half, long = thick / 2, width + 2 * thick
        return [
            (x + width / 2, y - half, long, thick),
            (x + width / 2, y + (depth + half), long, thick),
            (x - half, y + depth / 2, thick, depth),
            (x + (width + half), y + depth / 2, thick, depth),
        ]


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
