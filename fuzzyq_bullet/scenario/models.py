"""What a run is asked to do: the scenario file as typed, validated models, and its JSON Schema.

Metres, seconds and radians throughout; x to the right and y up (REP 103). Geometry that only makes
sense together (overlaps, walls) is checked in ``scenario.checks``; files and line numbers are the
business of ``scenario.files``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import (
    BeforeValidator,
    Field,
    SerializeAsAny,
    SerializerFunctionWrapHandler,
    ValidationError,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    WrapValidator,
    field_serializer,
    model_serializer,
)
from pydantic.json_schema import models_json_schema
from pydantic_core import PydanticCustomError

from fuzzyq_bullet.planning.registry import DEFAULT_PLANNER, planner_names, settings_for
from fuzzyq_bullet.planning.settings import PlannerSettings
from fuzzyq_bullet.quantities import (
    MAX_OBSTACLES,
    Count,
    Model,
    Number,
    Point,
)
from fuzzyq_bullet.scenario.expectations import (
    ANY_NAME,
    AnyExpect,
    Expect,
    expect_model,
)
from fuzzyq_bullet.scenario.layouts import AnyLayout
from fuzzyq_bullet.scenario.movers import movers, standing
from fuzzyq_bullet.scenario.places import Arena, Goal, Start, Via
from fuzzyq_bullet.scenario.robot import Robot
from fuzzyq_bullet.sensors.base import SENSORS, AnySensor, ExactSensor, SensorModel
from fuzzyq_bullet.shapes import Obstacle, Shape
from fuzzyq_bullet.shapes.motion import STILL

Drive: TypeAlias = Literal["wheels", "kinematic"]


class Limits(Model):
    """When a run is given up."""

    time: Annotated[Number, Field(gt=0.0, le=3600.0)] = Field(
        default=120.0, description="Simulated time (s)."
    )
    steps: Annotated[Count, Field(ge=1, le=1_000_000)] = Field(
        default=100_000, description="Decisions of the planner: M_s of Step 12."
    )


def _default_planner() -> PlannerSettings:
    return settings_for(DEFAULT_PLANNER).model_validate({"name": DEFAULT_PLANNER})


_AT_REST = STILL.model_dump()
_LONGEST_NAME = 100
MAX_VIA = 100
"""Most via points of a scenario."""
_DIALECT = "https://json-schema.org/draft/2020-12/schema"


def _choose_planner(value: Any, info: ValidationInfo) -> Any:
    """Turn a name, or parameters with or without one, into the settings of that planner.

    Mistakes among the parameters come out of ``model_validate`` with their own places, which
    pydantic puts behind ``planner``.
    """
    if value is None:
        return _default_planner()
    if isinstance(value, str):
        value = {"name": value}
    if isinstance(value, PlannerSettings):
        if value.name in planner_names() and isinstance(value, settings_for(value.name)):
            return value
        value = value.model_dump()
    if not isinstance(value, Mapping):
        return value  # a mistake that pydantic names
    name = value.get("name", DEFAULT_PLANNER)
    if name not in planner_names():
        if info.context == ANY_NAME and isinstance(name, str) and len(name) <= _LONGEST_NAME:
            return PlannerSettings(name=name)
        mistake = PydanticCustomError(
            "unknown_planner",
            "must be one of {allowed}",
            {"allowed": list(planner_names())},
        )
        raise ValidationError.from_exception_data(
            "planner", [{"type": mistake, "loc": ("name",), "input": name}]
        )
    return settings_for(name).model_validate({**value, "name": name})


def _choose_sensor(
    value: Any, choose: ValidatorFunctionWrapHandler, info: ValidationInfo
) -> SensorModel:
    name = value.get("model") if isinstance(value, Mapping) else None
    if info.context == ANY_NAME and isinstance(name, str) and name not in SENSORS.names():
        return SensorModel.model_validate({"model": name[:_LONGEST_NAME], **_range_of(value)})
    sensor: SensorModel = choose(value)
    return sensor


def _range_of(sensor: Mapping[Any, Any]) -> dict[str, Any]:
    return {key: value for key, value in sensor.items() if key == "range"}


class Scenario(Model):
    """One run, as asked for."""

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]{0,99}$")] = Field(
        description="Names the files of the run: letters, digits, dot, dash, underscore."
    )
    description: Annotated[str, Field(max_length=2000)] = Field(
        default="", description="What it shows, for people to read."
    )
    seed: Annotated[Count, Field(ge=0, le=2**63 - 1)] = Field(
        default=0, description="Seed of every random number of the run."
    )
    arena: Arena = Arena()
    start: Start
    via: tuple[Via, ...] = Field(
        default=(), max_length=MAX_VIA, description="To be passed before the goal, in this order."
    )
    goal: Goal
    robot: Robot = Robot()
    sensor: Annotated[AnySensor, WrapValidator(_choose_sensor)] = Field(
        default=ExactSensor(), description="What the robot senses with."
    )
    planner: Annotated[SerializeAsAny[PlannerSettings], BeforeValidator(_choose_planner)] = Field(
        default_factory=_default_planner,
        description="A planner's name, or its parameters with or without the name.",
    )
    drive: Drive = Field(
        default="wheels",
        description="What moves the robot: its wheels, in physics, or Eq. 17 exactly.",
    )
    obstacles: tuple[Obstacle, ...] = Field(
        default=(), max_length=MAX_OBSTACLES, description="What stands in the way."
    )
    random: AnyLayout | None = Field(
        default=None, description="Obstacles to be drawn; without a layout, scattered."
    )
    limits: Limits = Limits()
    expect: AnyExpect = Expect()

    @field_serializer("obstacles", mode="wrap")
    def _without_rest(self, value: Any, handler: SerializerFunctionWrapHandler) -> Any:
        """Leave out that obstacles stand still: a file of ten thousand need not say so."""
        told = handler(value)
        for item in told:
            if item.get("motion") == _AT_REST:
                del item["motion"]
        return told

    def moved(self, x: float, y: float) -> Scenario:
        """Return the same scenario elsewhere: arena, start, goal and obstacles moved (m).

        The places of obstacles are rounded to 0.1 mm.
        """

        def there(point: Point) -> Point:
            return point[0] + x, point[1] + y

        return self.model_copy(
            update={
                "arena": self.arena.model_copy(update={"origin": there(self.arena.origin)}),
                "start": self.start.model_copy(update={"position": there(self.start.position)}),
                "via": tuple(
                    one.model_copy(update={"position": there(one.position)}) for one in self.via
                ),
                "goal": self.goal.model_copy(update={"position": there(self.goal.position)}),
                "obstacles": tuple(one.moved(x, y, 0.0) for one in self.obstacles),
                "random": None if self.random is None else self.random.moved(x, y),
            }
        )

    @property
    def sensor_range(self) -> float:
        """Longest distance that a detection line tells (m): 5·S_p unless ``sensor`` says more."""
        return self.sensor.range_on(self.robot.spec)

    @model_serializer(mode="wrap")
    def _without_via(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Leave out that nothing is to be passed."""
        told: dict[str, Any] = handler(self)
        if not self.via:
            told.pop("via", None)
        return told

    @property
    def standing(self) -> tuple[Shape, ...]:
        """The obstacles that stand still."""
        return standing(self.obstacles)

    @property
    def movers(self) -> tuple[int, ...]:
        """The indices of the obstacles that move."""
        return movers(self.obstacles)

    @property
    def targets(self) -> tuple[Via | Goal, ...]:
        """The via points in their order, then the goal."""
        return (*self.via, self.goal)

    def start_heading(self) -> float:
        """Return the heading at the start (rad); towards the first target by default."""
        if self.start.heading is not None:
            return self.start.heading
        dx = self.targets[0].position[0] - self.start.position[0]
        dy = self.targets[0].position[1] - self.start.position[1]
        return math.atan2(dy, dx)


def scenario_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of a scenario file.

    ``planner`` accepts a registered name, or the settings of a registered planner; only those of
    the default planner may leave out the name. What takes geometry to see (``scenario.checks``) is
    not in it.
    """
    models = [(Scenario, "validation"), *((settings_for(n), "validation") for n in planner_names())]
    places, together = models_json_schema(models)  # type: ignore[arg-type]
    definitions = together["$defs"]
    choices: list[dict[str, Any]] = [
        {"type": "string", "enum": list(planner_names())},
        {"type": "null"},
    ]
    for name in planner_names():
        reference = places[(settings_for(name), "validation")]
        settings = definitions[reference["$ref"].rsplit("/", 1)[-1]]
        required = set(settings.get("required", ())) - {"name"}
        if name != DEFAULT_PLANNER:
            required.add("name")
        settings["required"] = sorted(required)
        choices.append(reference)
    scenario = definitions.pop("Scenario")
    planner = scenario["properties"]["planner"]
    scenario["properties"]["planner"] = {
        "title": "Planner",
        "description": planner.get("description", ""),
        "anyOf": choices,
    }
    definitions["Expect"] = expect_model().model_json_schema()
    definitions.pop("PlannerSettings", None)
    return {"$schema": _DIALECT, **scenario, "title": "Scenario", "$defs": definitions}
