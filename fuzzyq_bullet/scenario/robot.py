"""The robot of a scenario: which model it is, and what the scenario changes of it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import AfterValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from fuzzyq_bullet.quantities import Model, Number
from fuzzyq_bullet.robots import FUZZYQ, RobotModel, robot_model, robot_names
from fuzzyq_bullet.robots.base import Acceleration, MaxSpeed, MaxTurnRate, TurnAcceleration


def _known_robot(name: str) -> str:
    if name not in robot_names():
        raise PydanticCustomError(
            "unknown_robot", "must be one of {allowed}", {"allowed": list(robot_names())}
        )
    return name


class Robot(Model):
    """The robot, and limits of its motion: those of its model, where they are not given."""

    model: Annotated[str, AfterValidator(_known_robot)] = Field(
        default=FUZZYQ.name,
        description="Which robot it is.",
        json_schema_extra=lambda schema: schema.update(enum=list(robot_names())),
    )
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
    def _with_limits_of_its_model(cls, data: Any) -> Any:
        if not isinstance(data, Mapping) or data.get("model") not in robot_names():
            return data
        limits = robot_model(data["model"]).model_dump(include=set(cls.model_fields) - {"model"})
        return {**limits, **data}

    @property
    def spec(self) -> RobotModel:
        """Footprint, wheels, masses and URDF of the robot."""
        return robot_model(self.model)

    @property
    def radius(self) -> float:
        """Radius of the robot's footprint (m): the paper's unit S_p."""
        return self.spec.radius
