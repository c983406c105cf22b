"""The reward of a decision, in seconds: r = −Δt + Δ(distance to the goal)/v_max − penalties."""

from __future__ import annotations

from dataclasses import dataclass

from fuzzyq_bullet.trajectory import Outcome

HIT = 30.0
"""Penalty for a contact (s): more than any detour that avoids it."""
GIVEN_UP = 10.0
"""Penalty for an episode that ends outside the goal without a contact (s)."""


@dataclass(frozen=True, slots=True)
class Reward:
    """The reward of one decision, in parts.

    Over an episode that reaches the goal, time and progress sum to minus its delay: the time
    beyond that of driving the distance at full speed. Progress depends only on where the robot is,
    so it does not change which behaviour is best (potential-based shaping).

    Attributes:
        time: Minus the time that passed (s); at most 0.
        progress: How much nearer the robot came to the goal, divided by its greatest speed (s).
        contact: −``HIT`` if something was touched, else 0 (s).
        given_up: −``GIVEN_UP`` if the episode ended as stuck or by its limits, else 0 (s).
    """

    time: float
    progress: float
    contact: float = 0.0
    given_up: float = 0.0

    @classmethod
    def of(
        cls, *, seconds: float, nearer: float, max_speed: float, outcome: Outcome | None
    ) -> Reward:
        """Return the reward of a decision.

        Args:
            seconds: Simulated time that it took (s).
            nearer: How much shorter the distance to the goal has become (m).
            max_speed: The robot's greatest speed (m/s).
            outcome: How the episode ended with it; None while it goes on.
        """
        return cls(
            time=-seconds,
            progress=nearer / max_speed,
            contact=-HIT if outcome == "collision" else 0.0,
            given_up=-GIVEN_UP if outcome in ("stuck", "timeout") else 0.0,
        )

    @property
    def total(self) -> float:
        """The sum of the parts (s)."""
        return self.time + self.progress + self.contact + self.given_up

    def parts(self) -> dict[str, float]:
        """Return the parts by name."""
        return {
            "time": self.time,
            "progress": self.progress,
            "contact": self.contact,
            "given_up": self.given_up,
        }
