"""What the planner ``process`` and its program say to each other: one JSON object a line."""

from __future__ import annotations

import json
from typing import Annotated, Any, Literal, NoReturn, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, Strict, ValidationError, model_validator

from fuzzyq_bullet.planning.commands import Answer, TwistCommand, WheelCommand
from fuzzyq_bullet.planning.decision import FARTHEST, LONGEST_STEP, Decision, Mode

_Number: TypeAlias = Annotated[
    float, Strict(), Field(allow_inf_nan=False, ge=-FARTHEST, le=FARTHEST)
]
_Pair: TypeAlias = Annotated[list[_Number], Field(min_length=2, max_length=2)]


class _Message(BaseModel):
    model_config = ConfigDict(extra="forbid")


class Robot(_Message):
    """What the robot can do; all but the radius is null in the kinematic drive."""

    radius: float = Field(description="Radius of the robot's disc (m).")
    max_speed: float | None = Field(default=None, description="m/s")
    max_turn_rate: float | None = Field(default=None, description="rad/s")
    acceleration: float | None = Field(default=None, description="m/s²")
    turn_acceleration: float | None = Field(default=None, description="rad/s²")
    wheel_radius: float | None = Field(default=None, description="m")
    track: float | None = Field(default=None, description="Distance between the wheels (m).")


class Goal(_Message):
    """Where to go."""

    position: tuple[float, float] = Field(description="Its centre (m).")
    radius: float = Field(description="m")


class Greeting(_Message):
    """The first line, sent once. It is not answered."""

    protocol: Literal[1] = Field(default=1, description="Version of these messages.")
    version: str = Field(description="Version of fuzzyq_bullet.")
    robot: Robot
    goal: Goal
    range: float = Field(description="Longest distance that the sensor tells (m).")
    period: float | None = Field(description="Time between two answers (s); null: no wheels.")
    rays: list[float] = Field(description="Angles of the rays (rad), from where the robot faces.")
    seed: int = Field(description="For random numbers, so that a run is the same each time.")


class Lines(_Message):
    """Free lengths (m) of the robot's disc along three headings; the middle one is the goal's."""

    left: float
    middle: float
    right: float


class Seen(_Message):
    """Every further line: what the robot sees. Each is answered."""

    time: float = Field(description="Since the start (s).")
    position: tuple[float, float] = Field(description="Centre of the robot (m).")
    heading: float = Field(description="Where it faces (rad), anticlockwise from x.")
    speed: float = Field(description="m/s")
    turn_rate: float = Field(description="rad/s, positive to the left")
    goal: tuple[float, float] = Field(description="Centre of the goal (m).")
    lines: Lines
    rays: list[float] = Field(description="Distances from the robot's centre (m), a ray each.")


class Explanation(_Message):
    """What the film and the page show beside the answer; none of it moves the robot."""

    mode: Mode = "routine"
    aim: _Pair | None = Field(default=None, description="The point that it steers to (m).")
    target: _Pair | None = Field(default=None, description="A temporary goal (m).")


class Reply(_Message):
    """An answer: ``heading`` and ``step``, or ``twist``, or ``wheels``."""

    heading: _Number | None = Field(default=None, description="World heading (rad).")
    step: Annotated[float, Strict(), Field(allow_inf_nan=False, ge=0.0, le=LONGEST_STEP)] | None = (
        Field(default=None, description="Length of the step (m); how fast follows from it.")
    )
    twist: _Pair | None = Field(default=None, description="Speed (m/s) and turn rate (rad/s).")
    wheels: _Pair | None = Field(
        default=None, description="Speeds of left and right wheel (rad/s)."
    )
    explain: Explanation = Explanation()
    hopeless: Annotated[bool, Strict()] = Field(
        default=False, description="Whether it gives up: the episode ends as stuck."
    )

    @model_validator(mode="after")
    def _one_answer(self) -> Reply:
        by_heading = self.heading is not None and self.step is not None
        half = (self.heading is None) != (self.step is None)
        if half or by_heading + (self.twist is not None) + (self.wheels is not None) != 1:
            raise ValueError("needs heading and step, or twist, or wheels, and one of these only")
        return self

    def answer(self, lines: tuple[float, ...], lengths: tuple[float, ...]) -> Answer:
        """Return the answer of a planner, with the lines that were sent."""
        told = Decision(
            self.heading or 0.0,
            self.step or 0.0,
            mode=self.explain.mode,
            lines=lines,
            lengths=lengths,
            hopeless=self.hopeless,
        )
        if self.explain.aim:
            told = told._replace(aim=(self.explain.aim[0], self.explain.aim[1]))
        if self.explain.target:
            told = told._replace(target=(self.explain.target[0], self.explain.target[1]))
        if self.twist:
            return TwistCommand(self.twist[0], self.twist[1], told)
        if self.wheels:
            return WheelCommand(self.wheels[0], self.wheels[1], told)
        return told


def read_reply(line: str) -> Reply:
    """Read what a program answered.

    Raises:
        ValueError: If it is no answer; says why in a few words.
    """
    try:
        data = json.loads(line, parse_constant=_no_number)
    except (ValueError, RecursionError) as error:
        why = str(error) if isinstance(error, _NoNumberError) else "which is no JSON"
        raise ValueError(why) from error
    if not isinstance(data, dict):
        raise ValueError("which is no JSON object")
    try:
        return Reply.model_validate(data)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        where = ".".join(map(str, first["loc"]))
        what = first["msg"].removeprefix("Value error, ")
        if first["type"] == "extra_forbidden":
            what = f"unknown; allowed: {', '.join(Reply.model_fields)}"
        raise ValueError(f"{where[:60]}: {what}" if where else f"it {what}") from error


def process_schema() -> dict[str, Any]:
    """Return a JSON Schema for each of the three kinds of lines."""
    models: dict[str, type[BaseModel]] = {
        "greeting": Greeting,
        "observation": Seen,
        "answer": Reply,
    }
    return {name: model.model_json_schema() for name, model in models.items()}


class _NoNumberError(ValueError):
    """NaN or Infinity, which JSON does not have."""


def _no_number(word: str) -> NoReturn:
    raise _NoNumberError(f"{word} is no number")
