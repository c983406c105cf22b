"""What a robot is: its footprint, wheels, masses, limits, and the URDF made from them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, TypeAlias

from pydantic import Field, model_validator

from fuzzyq_bullet.quantities import Model, Number
from fuzzyq_bullet.robots.made_urdf import GROUND_CLEARANCE, made_urdf
from fuzzyq_bullet.wording import not_one_of

MaxSpeed: TypeAlias = Annotated[Number, Field(ge=0.05, le=3.0)]
MaxTurnRate: TypeAlias = Annotated[Number, Field(ge=0.2, le=4.0)]
Acceleration: TypeAlias = Annotated[Number, Field(ge=0.1, le=2.0)]
TurnAcceleration: TypeAlias = Annotated[Number, Field(ge=0.5, le=10.0)]
Radius: TypeAlias = Annotated[Number, Field(ge=0.05, le=2.0)]
Positive: TypeAlias = Annotated[Number, Field(gt=0.0, le=1000.0)]

RANGE_UNITS = 5.0
"""Range of the detection lines, in units of the robot's radius: 5·S_p (Section 3.1)."""
TALLEST = 0.4
"""Greatest height of a robot (m): that of the obstacles."""
_CORNERS = 48
"""Corners of a disc's outline."""


class RobotModel(Model):
    """A differential drive: two driven wheels and a caster under a body, round or rectangular.

    Attributes:
        name: What a scenario calls it: ``robot: {model: NAME}``.
        size: Length and width of a rectangular footprint (m); by default it is a disc.
        offset: How far the middle of the rectangle lies ahead of the axle (m).
        corners: Corners of a footprint that was measured from a URDF (m), counter-clockwise.
        radius: Radius of the smallest disc about the turning centre that holds the footprint (m).
            It is the paper's unit S_p: the sensor reaches 5·S_p, and the controller's steps are
            multiples of it. Planners steer this disc; contact in the physics is with the body.
            Computed where the footprint is no disc.
        height: Height of the body's lid (m); the sensor looks out half way up the body.
        track: Distance between the wheels (m).
        wheel_radius: Radius of the wheels (m).
        mass: Mass of the body (kg).
        wheel_mass: Mass of each wheel (kg).
        motor_torque: Greatest torque of a wheel's motor (N·m).
        max_speed: Greatest speed (m/s), unless the scenario says otherwise; likewise the rest.
        max_turn_rate: Greatest turn rate (rad/s).
        acceleration: Greatest change of speed (m/s²).
        turn_acceleration: Greatest change of the turn rate (rad/s²).
        urdf_file: A URDF whose base frame lies on the ground between the wheels, x forward; by
            default it is made from the numbers above.
        axles: The driven joints of that URDF, left and right.
        gripping: Links of a user's URDF that get a tyre's friction, as it says nothing of it.
        slippery: Links of a user's URDF that get no friction, as it says nothing of it.
        source: Where the numbers are from.
    """

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]{0,99}$")]
    size: tuple[Positive, Positive] | None = None
    offset: Annotated[Number, Field(ge=-1.0, le=1.0)] = 0.0
    corners: tuple[tuple[Number, Number], ...] = ()
    radius: Radius = 0.2
    height: Annotated[Number, Field(gt=GROUND_CLEARANCE, le=TALLEST)] = 0.15
    track: Positive = 0.28
    wheel_radius: Positive = 0.05
    mass: Positive = 5.0
    wheel_mass: Positive = 0.2
    motor_torque: Positive = 3.0
    max_speed: MaxSpeed = 0.6
    max_turn_rate: MaxTurnRate = 2.0
    acceleration: Acceleration = 1.0
    turn_acceleration: TurnAcceleration = 6.0
    urdf_file: Path | None = None
    axles: tuple[str, str] = ("left_axle", "right_axle")
    gripping: tuple[str, ...] = ()
    slippery: tuple[str, ...] = ()
    source: str = ""

    @model_validator(mode="before")
    @classmethod
    def _with_circumscribed_radius(cls, data: Any) -> Any:
        if not isinstance(data, Mapping) or "radius" in data:
            return data
        points = data.get("corners", ())
        if data.get("size") is not None:
            length, width = data["size"]
            points = rectangle(length, width, data.get("offset", 0.0))
        return {**data, "radius": max(math.hypot(*p) for p in points)} if points else data

    @property
    def is_disc(self) -> bool:
        """Whether the footprint is a disc about the turning centre."""
        return self.size is None and not self.corners

    @property
    def footprint(self) -> tuple[tuple[float, float], ...]:
        """Outline of the body seen from above (m), counter-clockwise, in the robot's own frame.

        A disc is a polygon of 48 corners on its circle.
        """
        if self.corners:
            return self.corners
        if self.size is not None:
            return rectangle(*self.size, self.offset)
        angles = [math.tau * k / _CORNERS for k in range(_CORNERS)]
        return tuple((self.radius * math.cos(a), self.radius * math.sin(a)) for a in angles)

    def footprint_at(self, x: float, y: float, heading: float) -> list[tuple[float, float]]:
        """Return the outline of the body in the arena (m), at a pose (m, m, rad)."""
        cos, sin = math.cos(heading), math.sin(heading)
        return [(x + a * cos - b * sin, y + a * sin + b * cos) for a, b in self.footprint]

    @property
    def sensor_range(self) -> float:
        """Longest distance that a detection line tells (m) unless the sensor says more: 5·S_p."""
        return RANGE_UNITS * self.radius

    @property
    def sensor_height(self) -> float:
        """Height of the sensor's rays above the ground (m): the middle of the body."""
        return (GROUND_CLEARANCE + self.height) / 2

    def wheel_commands(self, speed: float, turn_rate: float) -> tuple[float, float]:
        """Return the wheel speeds (rad/s), left and right, of an ideal differential drive.

        Args:
            speed: Forward speed (m/s).
            turn_rate: Turn rate (rad/s).
        """
        half = turn_rate * self.track / 2
        return (speed - half) / self.wheel_radius, (speed + half) / self.wheel_radius

    def urdf(self) -> str:
        """Return a URDF of these numbers."""
        return made_urdf(self)


def rectangle(length: float, width: float, ahead: float = 0.0) -> tuple[tuple[float, float], ...]:
    """Return the corners of a rectangle whose middle lies ``ahead`` of the axle (m)."""
    front, rear, side = ahead + length / 2, ahead - length / 2, width / 2
    return ((front, side), (rear, side), (rear, -side), (front, -side))


_robots: dict[str, RobotModel] = {}


def register_robot(robot: RobotModel) -> RobotModel:
    """Make a robot known, so that scenario files may ask for it: ``robot: {model: NAME}``.

    One call in a file that ``--plugin`` names is enough::

        from fuzzyq_bullet.robots import RobotModel, register_robot

        register_robot(RobotModel(name="mouse", radius=0.08, track=0.12, wheel_radius=0.02))

    A robot of the package itself is a module here that ``robots/__init__.py`` imports.

    What is not given is that of the default robot. Physics, sensor, planner, shortest path, layouts
    and film take its radius from here.

    Raises:
        ValueError: If the name is taken, or the wheels do not fit under the body.
    """
    if robot.name in _robots:
        raise ValueError(f"a robot named {robot.name!r} is registered already")
    if not wheels_fit(robot):
        raise ValueError(f"the wheels of {robot.name!r} do not fit under its body")
    _robots[robot.name] = robot
    return robot


def wheels_fit(robot: RobotModel) -> bool:
    """Tell whether the wheels of a robot that is made from numbers lie under its body."""
    half = robot.radius if robot.size is None else robot.size[1] / 2
    return robot.track / 2 <= half and 2 * robot.wheel_radius <= robot.height


def robot_names() -> tuple[str, ...]:
    """Return all registered names, in order of registration."""
    return tuple(_robots)


def robot_model(name: str) -> RobotModel:
    """Return the robot of that name.

    Raises:
        KeyError: If there is none.
    """
    return _robots[name]


def no_robot(name: Any) -> str:
    """Say that no robot has this name, which do exist, and how others come to be known."""
    return f"{not_one_of('robot', name, robot_names())}; --plugin FILE adds one of your own"
