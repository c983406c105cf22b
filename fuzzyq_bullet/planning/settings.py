"""The parameters of the planners, as a scenario file may set them."""

from __future__ import annotations

import math
from typing import Annotated, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, Strict

_Number: TypeAlias = Annotated[float, Strict(), Field(allow_inf_nan=False)]
Weight: TypeAlias = Annotated[_Number, Field(gt=0.0, le=2.0)]


class PlannerSettings(BaseModel):
    """What every planner's settings have: the name that chooses it. Unknown keys are mistakes."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str


class RoutineSettings(PlannerSettings):
    """Parameters of the routine part: detection lines, fuzzy controller, weights (Section 3)."""

    weights: tuple[Weight, Weight] = Field(
        default=(0.5, 0.5), description="(ω1, ω2) of Eq. 17: ω1 scales the step, ω2 the turn."
    )
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
    rules: Literal["corrected", "printed"] = Field(
        default="corrected", description="Table 4 with its two misprints mended, or as printed."
    )
    samples: Annotated[int, Strict(), Field(ge=3, le=10_001)] = Field(
        default=101, description="n of Eq. 22: points of the centroid. The paper says 5."
    )


class FuzzySettings(RoutineSettings):
    """The traditional baseline: the fuzzy controller alone."""

    name: Literal["fuzzy"] = "fuzzy"


class ImprovedFuzzySettings(RoutineSettings):
    """The improved fuzzy planner: the controller, and the guard that caps its step."""

    name: Literal["improved-fuzzy"] = "improved-fuzzy"
    guard: Annotated[bool, Strict()] = Field(
        default=True, description="Whether a corridor along the final heading caps the step."
    )
    breakout: Annotated[bool, Strict()] = Field(
        default=True, description="Whether it breaks out of dead ends (4.2)."
    )
    following: Annotated[bool, Strict()] = Field(
        default=True, description="Whether it follows large obstacles after a breakout (4.3)."
    )
