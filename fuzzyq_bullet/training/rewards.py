"""What a decision earns: every part in seconds, so that a return is time lost on the way."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fuzzyq_bullet.trajectory import Outcome

HIT = 30.0
"""What a contact costs (s): more than any detour to avoid it."""
GIVEN_UP = 10.0
"""What it costs to end anywhere else than in the goal, without a contact (s)."""


@dataclass(frozen=True, slots=True)
class Reward:
    """The reward of one decision, in parts.

    Time and progress together are how much longer it took than a straight way at full speed would
    have; their sum over an episode that reaches the goal is its delay, which no weighting of the
    two could hide: progress depends on where the robot is and on nothing else, so it does not
    change which behaviour is best.

    Attributes:
        time: Less the time that passed (s); at most 0.
        progress: How much nearer the goal came, over the greatest speed (s).
        contact: Less ``HIT`` when something was touched.
        given_up: Less ``GIVEN_UP`` when the episode ended as stuck or by its limits.
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
            nearer: How much shorter the way to the goal has become (m).
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
