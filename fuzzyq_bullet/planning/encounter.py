"""How long a choice stands: until what was seen when it was made lies behind the robot."""

from __future__ import annotations

import math

from fuzzyq_bullet.planning.base import STEP_UNIT
from fuzzyq_bullet.planning.decision import Mode

SHORTEST = 1.0 * STEP_UNIT
"""How much nearer to the goal than when it last chose the robot must be to choose anew (m)."""
LONGEST = 5.0 * STEP_UNIT
"""After coming so much nearer it has passed all that its lines could show then (m)."""


class Encounters:
    """Divides the way of one episode into encounters with obstacles, and clear ways between them.

    One ends where the way to the goal is no longer clear, or clear again, or after ``LONGEST``;
    but only where the robot is nearer to the goal than it ever was, and on no way out. So a choice
    is answerable for all that it leads to, a detour included; and as there are only so many of
    them on the way to the goal, whatever ends with a choice that stays the same ends with
    these (``docs/escape.md``).
    """

    def __init__(self) -> None:
        self._nearest = math.inf
        self._began = math.inf
        self._clear = False

    def begins(self, to_goal: float, mode: Mode, *, clear: bool) -> bool:
        """Return whether a new one begins with this decision. Call it once for each.

        Args:
            to_goal: Distance to the goal (m).
            mode: Of the decision before.
            clear: Whether nothing is seen to stand in the way to the goal.
        """
        nearest, self._nearest = self._nearest, min(self._nearest, to_goal)
        least = SHORTEST if clear != self._clear else LONGEST
        if mode != "routine" or to_goal > nearest or to_goal > self._began - least:
            return False
        self._began, self._clear = to_goal, clear
        return True
