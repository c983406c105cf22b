"""Answers that are no decision: a twist, or speeds of the two wheels; and what limits them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, Field, Strict
from pydantic_core import PydanticCustomError

from fuzzyq_bullet.columns import Column
from fuzzyq_bullet.planning.base import Motion, Observation
from fuzzyq_bullet.planning.decision import FARTHEST, Decision, DecisionError
from fuzzyq_bullet.planning.settings import GuardedSettings
from fuzzyq_bullet.quantities import Number
from fuzzyq_bullet.wording import shorten

PHYSICS_RATE = 240
"""Steps of the physics in a second."""
HIGHEST_RATE = 80
"""Most decisions a second: so often are the wheels commanded."""


class TwistCommand(NamedTuple):
    """A twist to hold until the next answer is due.

    The wheels come to it within the robot's acceleration, and never beyond its greatest speed and
    turn rate.

    Attributes:
        speed: Forward speed (m/s), negative for backward.
        turn_rate: Turn rate (rad/s), positive to the left.
        told: What explains it on record; its heading, step and reach are of no matter.
    """

    speed: float
    turn_rate: float
    told: Decision | None = None


class WheelCommand(NamedTuple):
    """Speeds of the two wheels to hold until the next answer is due.

    Attributes:
        left: Speed of the left wheel (rad/s), positive forward.
        right: Speed of the right wheel (rad/s).
        told: What explains it on record; its heading, step and reach are of no matter.
    """

    left: float
    right: float
    told: Decision | None = None


Answer: TypeAlias = Decision | TwistCommand | WheelCommand

COMMAND_FIELDS = {
    "twist_speed": Column("m/s", "Forward speed that the planner asked for.", blank=True),
    "twist_turn_rate": Column("rad/s", "Turn rate that it asked for.", blank=True),
}
"""What is recorded besides, of a planner that answers with twists or speeds of wheels."""


def _whole_steps(rate: float) -> float:
    steps = round(PHYSICS_RATE / rate)
    if abs(steps * rate / PHYSICS_RATE - 1.0) > 1e-9:
        raise PydanticCustomError(
            "rate",
            "must be 240 divided by a whole number, as 10, 20, 40 or 80: a decision lasts whole "
            "steps of 1/240 s",
        )
    return rate


Rate: TypeAlias = Annotated[Number, Field(ge=1.0, le=HIGHEST_RATE), AfterValidator(_whole_steps)]


class CommandSettings(GuardedSettings):
    """For planners of one's own: how often they decide, and whether they are guarded.

    A subclass gives ``rate``, ``guard`` and ``closing_speed`` to any planner, whatever it answers
    with.
    """

    rate: Rate = Field(
        default=20.0,
        description="Decisions a second on wheels: 240 divided by a whole number, at most 80.",
    )
    guard: Annotated[bool, Strict()] = Field(
        default=False,
        description="Whether the safety filter limits what it answers to what is free, and among "
        "moving obstacles to what is passively safe.",
    )

    def heeds_closing_speed(self) -> bool:
        """Return whether it is guarded."""
        return self.guard


def twist_of(command: TwistCommand | WheelCommand, motion: Motion | None) -> TwistCommand:
    """Return the twist that a planner asks for.

    Args:
        command: What the planner answered.
        motion: Limits of the robot's body; None for a point.

    Raises:
        DecisionError: If it is not finite, or absurd, or there are no wheels to carry it out.
    """
    kind: Literal["twist", "wheels"] = "twist" if isinstance(command, TwistCommand) else "wheels"
    first, second, told = command
    for number in (first, second):
        if not _finite(number):
            shown = shorten(f"{first!r}, {second!r}")
            raise DecisionError(f"answered with the {kind} [{shown}], which must be finite numbers")
    if told is not None and not isinstance(told, Decision):
        raise DecisionError(f"explained its {kind} by a {type(told).__name__}, not a Decision")
    if motion is None:
        raise DecisionError(
            f"answered with {'a twist' if kind == 'twist' else 'speeds of wheels'}, which needs "
            "the drive wheels, not kinematic"
        )
    if kind == "twist":
        return TwistCommand(float(first), float(second), told)
    left, right = first * motion.wheel_radius, second * motion.wheel_radius
    return TwistCommand((left + right) / 2.0, (right - left) / motion.track, told)


def equivalent(twist: TwistCommand, observation: Observation, motion: Motion) -> Decision:
    """Return what goes on record where a decision would: where a twist leads until the next one."""
    speed = min(max(0.0, twist.speed), motion.max_speed)
    rate = max(-motion.max_turn_rate, min(twist.turn_rate, motion.max_turn_rate))
    heading, step = observation.heading + rate * motion.period, speed * motion.period
    if twist.told is None:
        return Decision(heading, step)
    return twist.told._replace(heading=heading, step=step, reach=math.inf)


def command_arrays(
    twists: Mapping[int, tuple[float, float]], count: int
) -> dict[str, NDArray[np.float64]]:
    """Return the columns of the twists that were asked for; none if none was.

    Args:
        twists: Speed (m/s) and turn rate (rad/s) by the number of the decision.
        count: How many decisions there were.
    """
    if not twists:
        return {}
    blank = (np.nan, np.nan)
    table = np.array([twists.get(number, blank) for number in range(count)], dtype=np.float64)
    return dict(zip(COMMAND_FIELDS, table.T.copy(), strict=True))


def _finite(number: Any) -> bool:
    try:
        return abs(float(number)) <= FARTHEST and not isinstance(number, str | bool)
    except (TypeError, ValueError, OverflowError):
        return False
