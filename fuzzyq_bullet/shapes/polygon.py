"""The upright prism over any simple polygon, concave ones too."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, Field, ValidationError, model_validator
from pydantic.json_schema import SkipJsonSchema
from pydantic_core import PydanticCustomError

from fuzzyq_bullet.quantities import DECIMALS, Point
from fuzzyq_bullet.shapes.base import Collision, Floats, Shape, register_shape
from fuzzyq_bullet.shapes.convex import prism_over
from fuzzyq_bullet.shapes.outlines import convex_pieces, mistake_of, seen_by_rays
from fuzzyq_bullet.shapes.polygons import Polygons

if TYPE_CHECKING:
    from typing_extensions import Self

MAX_POINTS = 2000
"""Most corners of one polygon."""


def _simple(points: tuple[Point, ...]) -> tuple[Point, ...]:
    """Make sure that points are the corners of a simple polygon.

    Raises:
        ValidationError: If they are not, at the point where it shows.
    """
    mistake = mistake_of(points)
    if mistake is None:
        return points
    at, why = mistake
    error = PydanticCustomError("not_simple", "{why}", {"why": why})
    raise ValidationError.from_exception_data(
        "points", [{"type": error, "loc": () if at is None else (at,), "input": points}]
    )


@register_shape
class Polygon(Shape):
    """An upright prism over a simple polygon: convex or concave, its corners in either order.

    Its position is the middle of the smallest rectangle along the axes that holds it. It follows
    from the points and is not given.
    """

    group = Polygons

    shape: Literal["polygon"]
    points: Annotated[tuple[Point, ...], Field(max_length=MAX_POINTS), AfterValidator(_simple)] = (
        Field(
            description="Its corners (m), one after the other; no side may meet another.",
            json_schema_extra={"minItems": 3},
        )
    )
    position: SkipJsonSchema[Point] = Field(default=(0.0, 0.0), exclude=True)

    @model_validator(mode="before")
    @classmethod
    def _without_position(cls, data: Any) -> Any:
        if isinstance(data, dict) and "position" in data:
            raise PydanticCustomError(
                "no_position", "a polygon has no position; its points say where it is"
            )
        return data

    @model_validator(mode="after")
    def _with_position(self) -> Self:
        object.__setattr__(self, "position", _middle(self.points))
        return self

    def corners(self) -> tuple[Floats, float]:
        """Return the corners, which are not round."""
        return self.outline(), 0.0

    def outline(self, corners: int = 24) -> Floats:
        """Return the corners, anticlockwise."""
        points = np.array(self.points)
        after = np.roll(points, -1, axis=0) - points[0]
        from_first = points - points[0]
        area = from_first[:, 0] * after[:, 1] - from_first[:, 1] * after[:, 0]
        return points if area.sum() > 0.0 else points[::-1].copy()

    def pieces(self, corners: int = 24) -> list[Floats]:
        """Return convex polygons that make it up."""
        return list(convex_pieces(self.points))

    def thickness(self) -> float:
        """Return the width (m) of its thinnest part, at most 0.05 m; 0 if it is below 0.02 m."""
        return seen_by_rays(self.points)

    def faces(self) -> Floats:
        """Return the corners."""
        return self.outline()

    def collisions(self, height: float) -> list[Collision]:
        """Return a convex mesh for each of the pieces."""
        return [prism_over(piece - self.position, height) for piece in self.pieces()]

    def moved(self, x: float, y: float, turn: float) -> Self:
        """Return it turned about the origin (rad) and then moved (m), rounded to 0.1 mm."""
        cos, sin = math.cos(turn), math.sin(turn)
        points = tuple(
            (round(x + cos * px - sin * py, DECIMALS), round(y + sin * px + cos * py, DECIMALS))
            for px, py in self.points
        )
        motion = self.moved_motion(x, y, turn)
        told = {"points": points, "position": _middle(points), "motion": motion}
        return self.model_copy(update=told)


def _middle(points: tuple[Point, ...]) -> Point:
    x, y = zip(*points, strict=True)
    return (min(x) + max(x)) / 2, (min(y) + max(y)) / 2
