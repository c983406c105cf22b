"""The parameters of the planners, as a scenario file may set them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar, Literal, TypeAlias

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    SerializerFunctionWrapHandler,
    Strict,
    ValidationInfo,
    field_validator,
    model_serializer,
)
from pydantic_core import PydanticCustomError

from fuzzyq_bullet.fuzzy.definition import ControllerDefinition, Samples
from fuzzyq_bullet.fuzzy.definition_checks import too_few
from fuzzyq_bullet.fuzzy.paper import RULE_TABLES

_Number: TypeAlias = Annotated[float, Strict(), Field(allow_inf_nan=False)]
Weight: TypeAlias = Annotated[_Number, Field(gt=0.0, le=20.0)]
NO_CONTROLLER = "none"
RULE_WORDS = (*RULE_TABLES, NO_CONTROLLER)
"""What ``rules`` may say beside a controller or, in files, the path of one."""


def _choose_rules(value: Any) -> Any:
    if isinstance(value, Mapping):
        return ControllerDefinition.model_validate(value)
    if not isinstance(value, ControllerDefinition) and value not in RULE_WORDS:
        raise PydanticCustomError(
            "rules",
            "must be {words}, or a controller; fuzzyq_bullet.fuzzy.load_controller reads one",
            {"words": ", ".join(RULE_WORDS)},
        )
    return value


Rules: TypeAlias = Annotated[str | ControllerDefinition, BeforeValidator(_choose_rules)]
BreakoutAt: TypeAlias = Annotated[_Number, Field(gt=0.0, le=5.0)]


class PlannerSettings(BaseModel):
    """What every planner's settings have: the name that chooses it. Unknown keys are mistakes.

    Attributes:
        needs_wheels: Whether it answers with twists, which the kinematic drive cannot carry out.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    needs_wheels: ClassVar[bool] = False

    name: str

    def doubts(self) -> Iterator[tuple[str, str]]:
        """Yield what is allowed and yet hardly meant: a key, and one line about it."""
        yield from ()


class GuardedSettings(PlannerSettings):
    """What the safety filter reckons with, of planners that have one."""

    closing_speed: Annotated[_Number, Field(ge=0.0, le=3.0)] | None = Field(
        default=None,
        description="How fast what moves, or is not seen yet, may come (m/s): the safety filter "
        "reckons with it; 0: everything stands. By default that of the fastest obstacle.",
    )

    def closing_speed_among(self, fastest: float) -> float:
        """Return the speed (m/s) to reckon with where the fastest obstacle is so fast (m/s)."""
        return fastest if self.closing_speed is None else self.closing_speed

    def heeds_closing_speed(self) -> bool:
        """Return whether anything that the planner does depends on the closing speed."""
        return True

    def doubts(self) -> Iterator[tuple[str, str]]:
        """Yield what is allowed and yet hardly meant."""
        yield from super().doubts()
        if self.closing_speed is not None and not self.heeds_closing_speed():
            yield "closing_speed", "the safety filter reckons with it, but guard is false"

    @model_serializer(mode="wrap")
    def _without_default(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Leave out that nothing was said: records and plans from before the key are the same."""
        told: dict[str, Any] = handler(self)
        if self.closing_speed is None:
            told.pop("closing_speed", None)
        return told


class RoutineSettings(PlannerSettings):
    """Parameters of the routine part: detection lines and fuzzy controller (Section 3)."""

    line_angle: Annotated[_Number, Field(gt=0.0, lt=math.pi)] = Field(
        default=math.radians(45.0),
        description="α: angle of the left and right lines from the middle one (rad).",
    )
    turn_unit: Annotated[_Number, Field(gt=0.0, le=math.pi / 2)] = Field(
        default=math.radians(60.0), description="A_p of Eq. 15: turn for N_a = 1 (rad)."
    )
    distance: Literal["middle", "least"] = Field(
        default="middle",
        description="Which line gives d: the middle one (Section 3.1) or the least (Step 9).",
    )
    clear: Literal["aim", "range"] = Field(
        default="aim",
        description="Where d = 5 and Df = 0: with the middle line free up to the aim (the paper), "
        "or as far as the robot sees.",
    )
    rules: Rules = Field(
        default="corrected",
        description="Table 4 with its two misprints mended, or as printed; none: no controller, "
        "straight to the aim with N_s = 2. Or rules and sets of one's own: a .yaml, .fll or .fis "
        "file, relative to that of the scenario, or what such a file says.",
    )
    samples: Samples | None = Field(
        default=None,
        description="n of Eq. 22: points of the centroid; by default as the rules say, 101 for "
        "Table 4. The paper says 5.",
    )

    @field_validator("samples")
    @classmethod
    def _meet_every_set(cls, value: int | None, info: ValidationInfo) -> int | None:
        rules = info.data.get("rules")
        if value is not None and isinstance(rules, ControllerDefinition):
            why = too_few(rules, value)
            if why:
                raise PydanticCustomError("samples", "{why}", {"why": why})
        return value


class WeightsSettings(PlannerSettings):
    """Constant weights (Eq. 17)."""

    weights: tuple[Weight, Weight] = Field(
        default=(0.5, 0.5), description="(ω1, ω2) of Eq. 17: ω1 scales the step, ω2 the turn."
    )


class RecoverySettings(GuardedSettings, RoutineSettings):
    """Parameters of the breakout, the sustained avoidance (Section 4) and the safety filter."""

    guard: Annotated[bool, Strict()] = Field(
        default=True,
        description="Whether the safety filter limits how far it goes to what is free.",
    )
    breakout: Annotated[bool, Strict()] = Field(
        default=True, description="Whether it breaks out of dead ends (4.2)."
    )
    breakout_at: BreakoutAt = Field(
        default=1.0,
        description="c_f in S_p: with less than this free towards the goal, it breaks out.",
    )
    following: Annotated[bool, Strict()] = Field(
        default=True, description="Whether it follows large obstacles after a breakout (4.3)."
    )


class PolicySettings(PlannerSettings):
    """Where a planner that has learned takes its policy from."""

    policy: Annotated[str, Strict(), Field(min_length=1, max_length=4096)] | None = Field(
        default=None,
        description="Policy file, relative to that of the scenario; by default the one shipped.",
    )


class FuzzySettings(WeightsSettings, RoutineSettings):
    """The traditional baseline: the fuzzy controller alone."""

    name: Literal["fuzzy"] = "fuzzy"


class ImprovedFuzzySettings(WeightsSettings, RecoverySettings):
    """The improved fuzzy planner: the controller, the guard that caps its step, and ways out."""

    name: Literal["improved-fuzzy"] = "improved-fuzzy"


class FuzzyQLambdaSettings(PolicySettings, RecoverySettings):
    """The paper's own planner: the improved one, with weights that were learned."""

    name: Literal["fuzzy-q-lambda"] = "fuzzy-q-lambda"
    breakout_at: BreakoutAt = Field(
        default=4.0,
        description="c_f in S_p: with less than this free towards the goal, it breaks out.",
    )


class DirectSettings(GuardedSettings, PolicySettings):
    """Parameters of the direct baselines: neither safety filter nor ways out unless asked for."""

    guard: Annotated[bool, Strict()] = Field(
        default=False,
        description="Whether the safety filter limits how far it goes to what is free.",
    )
    breakout: Annotated[bool, Strict()] = Field(
        default=False,
        description="Whether it breaks out of dead ends (4.2) and follows large obstacles (4.3).",
    )
    breakout_at: BreakoutAt = Field(
        default=1.0,
        description="c_f in S_p: with less than this free towards the goal, it breaks out.",
    )

    def heeds_closing_speed(self) -> bool:
        """Return whether it has the safety filter, or ways out among what moves."""
        return self.guard or self.breakout


class QLearningSettings(DirectSettings):
    """The direct Q-learning baseline (Eq. 7)."""

    name: Literal["q-learning"] = "q-learning"


class QLambdaSettings(DirectSettings):
    """The direct Q(λ) baseline (Eq. 18)."""

    name: Literal["q-lambda"] = "q-lambda"
