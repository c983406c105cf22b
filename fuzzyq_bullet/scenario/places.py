"""Where a run takes place, begins and ends: the arena, the start and the goal."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

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
        description="Direction it faces (rad), anticlockwise from x; default: to the goal.",
    )


class Goal(Model):
    """Where the robot must stop."""

    position: Point = Field(description="Centre of the goal (m).")
    radius: Annotated[Number, Field(ge=0.05, le=10.0)] = Field(
        default=0.2, description="The robot's centre must come to rest within it (m)."
    )
