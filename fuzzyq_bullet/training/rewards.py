"""The reward of a decision in seconds: −Δt + (how much nearer to the goal)/v_max − penalties."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from typing import Any, TypeAlias

from fuzzyq_bullet.blame import blamed
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.physics.robot import RobotState
from fuzzyq_bullet.recording.trajectory import Outcome
from fuzzyq_bullet.wording import did_you_mean, shorten

MOST = 1e6
"""Greatest penalty, and greatest reward of one's own for one decision."""


@dataclass(frozen=True, slots=True)
class Transition:
    """What a decision came to.

    Attributes:
        before: The robot when it decided.
        after: The robot when the next decision is due, or the episode is over.
        nearer: How much shorter the distance to the goal has become (m).
        max_speed: The robot's greatest speed (m/s).
        outcome: How the episode ended with it; None while it goes on.
    """

    before: RobotState
    after: RobotState
    nearer: float
    max_speed: float
    outcome: Outcome | None


OwnReward: TypeAlias = Callable[[Transition], float]
REWARDS: dict[str, OwnReward] = {}
"""Rewards of users' own, by name."""


def register_reward(name: str) -> Callable[[OwnReward], OwnReward]:
    """Make a reward known, so that ``fuzzyq train --reward NAME`` learns from it: a decorator.

    What is decorated takes a ``Transition`` and returns what it earns. In a file that ``--plugin``
    names (``examples/extend/reward.py`` is a whole one)::

        from fuzzyq_bullet.training.rewards import Transition, register_reward

        @register_reward("gentle")
        def gentle(step: Transition) -> float:
            turned = abs(step.after.turn_rate)
            return step.before.time - step.after.time - 0.1 * turned

    Raises:
        ValueError: If the name is taken, or could be taken for penalties.
    """
    if name in REWARDS or not name.replace("-", "_").isidentifier():
        raise ValueError(f"a reward cannot be named {name!r}: it is taken, or no plain word")

    def keep(function: OwnReward) -> OwnReward:
        REWARDS[name] = function
        return function

    return keep


@dataclass(frozen=True, slots=True)
class RewardSettings:
    """What counts how much.

    Attributes:
        hit: Penalty for a contact (s): by default more than any detour that avoids it.
        given_up: Penalty for an episode that ends outside the goal without a contact (s).
        progress: How much the progress towards the goal counts: 1, or 0 for time alone.
        own: Name of a registered reward that takes the place of all this, the time too; empty for
            none.
    """

    hit: float = 30.0
    given_up: float = 10.0
    progress: float = 1.0
    own: str = ""

    @classmethod
    def parse(cls, text: str) -> RewardSettings:
        """Read ``hit=30,given_up=10,progress=1``, of which any may be missing; or a name.

        Raises:
            UserError: If it is neither.
        """
        if text in REWARDS:
            return cls(own=text)
        known = [one.name for one in fields(cls) if one.name != "own"]
        found: dict[str, Any] = {}
        for part in text.split(","):
            key, equals, number = (one.strip() for one in part.partition("="))
            if not equals:
                names = ", ".join(REWARDS) or "none is registered; --plugin names a file with one"
                raise UserError(
                    f"reward: no reward {shorten(text)}; {did_you_mean(text, REWARDS)}rewards of "
                    f"your own: {names}; or {', '.join(f'{one}=NUMBER' for one in known)}"
                )
            if key in found:
                raise UserError(f"reward: {key}: is given twice")
            if key not in known:
                raise UserError(
                    f"reward: {shorten(key)}: no part of the reward; "
                    f"{did_you_mean(key, known)}allowed: {', '.join(known)}"
                )
            found[key] = _penalty(key, number)
        return replace(cls(), **found)

    def __str__(self) -> str:
        """Return what ``parse`` reads as the same."""
        return self.own or ",".join(
            f"{one.name}={_short(getattr(self, one.name))}"
            for one in fields(self)
            if one.name != "own"
        )

    def of(self, step: Transition) -> Reward:
        """Return the reward of one step, in parts.

        Raises:
            UserError: If a reward of the user's own fails, or returns what is no number.
        """
        if self.own:
            return Reward(time=0.0, progress=0.0, own=self._own_reward(step))
        return Reward(
            time=step.before.time - step.after.time,
            progress=self.progress * step.nearer / step.max_speed,
            contact=-self.hit if step.outcome == "collision" else 0.0,
            given_up=-self.given_up if step.outcome in ("stuck", "timeout") else 0.0,
        )

    def _own_reward(self, step: Transition) -> float:
        with blamed(f"reward {self.own}"):
            value = float(REWARDS[self.own](step))
        if not abs(value) <= MOST:
            raise UserError(
                f"reward {self.own}: returned {value:g} at {step.after.time:g} s; a number from "
                f"{-MOST:g} to {MOST:g} is needed"
            )
        return value


USUAL = RewardSettings()


def _short(number: float) -> str:
    """Return a number that reads back as the very same, without a needless ``.0``."""
    return f"{number:g}" if float(f"{number:g}") == number else repr(number)


def _penalty(key: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 <= value <= MOST:
        raise UserError(f"reward: {key}: must be a number from 0 to {MOST:g}, got {shorten(text)}")
    return value


@dataclass(frozen=True, slots=True)
class Reward:
    """The reward of one decision, in parts.

    Over an episode that reaches the goal, time and progress sum to minus its delay: the time
    beyond that of driving the distance at full speed. Without a discount progress changes nothing
    of which behaviour is best, because it depends only on where the robot is.

    Attributes:
        time: Minus the time that passed (s); at most 0.
        progress: How much nearer the robot came to the goal, divided by its greatest speed (s).
        contact: −``hit`` if something was touched, else 0 (s).
        given_up: −``given_up`` if the episode ended as stuck or by its limits, else 0 (s).
        own: What a reward of the user's own says instead of all these.
    """

    time: float
    progress: float
    contact: float = 0.0
    given_up: float = 0.0
    own: float = 0.0

    @property
    def total(self) -> float:
        """The sum of the parts (s)."""
        return self.unshaped + self.progress

    @property
    def unshaped(self) -> float:
        """All parts but the progress (s)."""
        return self.time + self.contact + self.given_up + self.own

    def parts(self) -> dict[str, float]:
        """Return the parts of the usual reward by name."""
        return {
            "time": self.time,
            "progress": self.progress,
            "contact": self.contact,
            "given_up": self.given_up,
        }
