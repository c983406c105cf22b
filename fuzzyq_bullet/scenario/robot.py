"""The robot of a scenario: which model it is, and what the scenario changes of it."""

from __future__ import annotations

import os
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any, NoReturn

from pydantic import Field, ValidationError, model_validator
from pydantic_core import InitErrorDetails, PydanticCustomError

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.quantities import Model, Number
from fuzzyq_bullet.robots import FUZZYQ, RobotModel, robot_model, robot_names
from fuzzyq_bullet.robots.base import (
    Acceleration,
    MaxSpeed,
    MaxTurnRate,
    Positive,
    Radius,
    TurnAcceleration,
    wheels_fit,
)
from fuzzyq_bullet.robots.urdf_checks import robot_from_urdf

URDF = ".urdf"
"""How a robot's name ends that is a file."""
_BODY = ("radius", "track", "wheel_radius", "mass")
_LIMITS = ("max_speed", "max_turn_rate", "acceleration", "turn_acceleration")
_JOINTS = ("left_wheel", "right_wheel")


class Robot(Model):
    """The robot, its body and the limits of its motion: its model's, where they are not given."""

    model: str = Field(
        default=FUZZYQ.name,
        description="Which robot it is: a name, or a URDF file beside the scenario.",
        json_schema_extra=lambda schema: schema.update(
            anyOf=[{"enum": list(robot_names())}, {"pattern": r"\.urdf$"}]
        ),
    )
    left_wheel: str | None = Field(
        default=None, description="Joint of the left wheel in a URDF; else found by its name."
    )
    right_wheel: str | None = Field(
        default=None, description="Joint of the right wheel in a URDF; else found by its name."
    )
    radius: Radius = Field(
        default=FUZZYQ.radius,
        description="Radius of the disc that it steers with (m): the paper's unit S_p.",
    )
    track: Positive = Field(default=FUZZYQ.track, description="Distance between its wheels (m).")
    wheel_radius: Positive = Field(
        default=FUZZYQ.wheel_radius, description="Radius of its wheels (m)."
    )
    mass: Positive = Field(default=FUZZYQ.mass, description="Mass of its body (kg).")
    max_speed: MaxSpeed = Field(default=FUZZYQ.max_speed, description="Greatest speed (m/s).")
    max_turn_rate: MaxTurnRate = Field(
        default=FUZZYQ.max_turn_rate, description="Greatest turn rate (rad/s)."
    )
    acceleration: Acceleration = Field(
        default=FUZZYQ.acceleration, description="Greatest change of speed, up or down (m/s²)."
    )
    turn_acceleration: TurnAcceleration = Field(
        default=FUZZYQ.turn_acceleration, description="Greatest change of the turn rate (rad/s²)."
    )

    slip: Annotated[Number, Field(ge=0.0, le=0.3)] = Field(
        default=0.0, description="Standard deviation of a wheel's speed, as a part of it."
    )
    latency: Annotated[Number, Field(ge=0.0, le=1.0)] = Field(
        default=0.0, description="Time from a decision to the wheels (s)."
    )

    @model_validator(mode="before")
    @classmethod
    def _with_numbers_of_its_model(cls, data: Any) -> Any:
        if not isinstance(data, Mapping) or not isinstance(data.get("model", FUZZYQ.name), str):
            return data
        name = data.get("model", FUZZYQ.name)
        if not name.endswith(URDF) and name not in robot_names():
            kind, allowed = "unknown_robot", list(robot_names())
            _refuse("model", name, kind, "must be one of {allowed}", allowed=allowed)
        try:
            model = _model(name, data.get("left_wheel"), data.get("right_wheel"))
        except UserError as error:
            _refuse("model", name, "bad_urdf", "{why}", why=error.problems[0])
        return {**model.model_dump(include={*_BODY, *_LIMITS}), **data}

    @model_validator(mode="after")
    def _is_one_robot(self) -> Robot:
        model = _model(self.model, self.left_wheel, self.right_wheel)
        changed = {key for key in _BODY if getattr(self, key) != getattr(model, key)}
        for key in _JOINTS:
            if getattr(self, key) is not None and not self.model.endswith(URDF):
                self._refuse_key(key, "is for a model from a URDF file; {model} needs none")
        if changed and model.corners:
            self._refuse_key(min(changed), "is measured from the URDF; change it there")
        if "radius" in changed and model.size is not None:
            self._refuse_key("radius", "is that of a rectangle's corners; {model} keeps its own")
        if changed and not wheels_fit(self.spec):
            key = next(one for one in ("track", "wheel_radius", "radius") if one in changed)
            self._refuse_key(
                key,
                "the wheels do not fit under the body: track / 2 is at most the radius, "
                "and the wheels are at most {height} m across",
                height=model.height,
            )
        return self

    def _refuse_key(self, key: str, why: str, **values: Any) -> None:
        _refuse(key, getattr(self, key), "unfit_robot", why, model=self.model, **values)

    @property
    def spec(self) -> RobotModel:
        """Footprint, wheels, masses and URDF of the robot."""
        model = _model(self.model, self.left_wheel, self.right_wheel)
        numbers = (self.radius, self.track, self.wheel_radius, self.mass)
        if numbers == (model.radius, model.track, model.wheel_radius, model.mass):
            return model
        return _changed(model, *numbers)


def with_robot_in(data: dict[str, Any], folder: Path | None) -> dict[str, Any]:
    """Return the data of a scenario with the path of its robot's URDF made absolute.

    Args:
        data: A scenario as its file says.
        folder: Folder of that file, in which a relative path begins; without one it stays so.
    """
    name = _urdf_in(data)
    if folder is None or name is None:
        return data
    return {**data, "robot": {**data["robot"], "model": str((folder / name).absolute())}}


def with_robot_from(data: dict[str, Any], folder: Path | None) -> dict[str, Any]:
    """Return the data of a scenario with the path of its robot's URDF as seen from a folder.

    On another drive of Windows it stays absolute.

    Args:
        data: A scenario.
        folder: Folder in which the path begins; without one it stays as it is.
    """
    name = _urdf_in(data)
    if folder is None or name is None:
        return data
    urdf = Path(name)
    try:  # of true folders: '..' behind a link leads elsewhere
        seen = Path(os.path.relpath(urdf.parent.resolve(), folder.resolve())) / urdf.name
    except ValueError:
        seen = urdf
    return {**data, "robot": {**data["robot"], "model": seen.as_posix()}}


def _urdf_in(data: dict[str, Any]) -> str | None:
    """Return the path of the robot's URDF in the data of a scenario; None if it has none."""
    robot = data.get("robot")
    name = robot.get("model") if isinstance(robot, dict) else None
    return name if isinstance(name, str) and name.endswith(URDF) else None


def _refuse(key: str, value: Any, kind: Any, message: Any, **context: Any) -> NoReturn:
    mistake = PydanticCustomError(kind, message, context)
    details = InitErrorDetails(type=mistake, loc=(key,), input=value)
    raise ValidationError.from_exception_data("robot", [details])


def _model(name: str, left: Any, right: Any) -> RobotModel:
    """Return the robot of a scenario, before it changes anything."""
    if not name.endswith(URDF):
        return robot_model(name)
    return robot_from_urdf(
        Path(name),
        left if isinstance(left, str) else None,
        right if isinstance(right, str) else None,
    )


@lru_cache(maxsize=64)
def _changed(
    model: RobotModel, radius: float, track: float, wheel_radius: float, mass: float
) -> RobotModel:
    """Return the robot with a body of other numbers; its URDF is made from them."""
    return model.model_copy(
        update={
            "radius": radius,
            "track": track,
            "wheel_radius": wheel_radius,
            "mass": mass,
            "urdf_file": None,
        }
    )
