"""The direct planners with a table of places: the state is where the robot is, and nothing else.

The paper calls its baselines slightly worse than its own planner, and blames the dimension of their
tables: that fits a table of places, learned in each environment anew. Its states are square cells,
its actions eight headings of the world, and a step is as long as a cell is wide: 2·S_p, the longest
of the fuzzy controller. Such a table senses nothing: it knows one field and no other.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from fuzzyq_bullet.planning.aim import towards_goal
from fuzzyq_bullet.planning.base import LONGEST_STRIDE, STEP_UNIT, Observation
from fuzzyq_bullet.planning.decision import Decision

HEADINGS = 8
"""Number of actions: headings of the world, 45° apart."""


@dataclass(frozen=True)
class Cells:
    """Square cells over an arena.

    Attributes:
        columns: How many side by side.
        rows: How many one above the other.
        side: Of each (m).
        origin: Lower left corner of the first (m).
    """

    columns: int
    rows: int
    side: float
    origin: tuple[float, float] = (0.0, 0.0)

    @classmethod
    def over(
        cls,
        size: tuple[float, float],
        unit: float = STEP_UNIT,
        origin: tuple[float, float] = (0.0, 0.0),
    ) -> Cells:
        """Return cells over an arena of this size (m) for a robot of this radius (m).

        Args:
            size: Width and depth of the arena (m).
            unit: Radius of the robot (m).
            origin: Lower left corner of the arena (m).
        """
        side = LONGEST_STRIDE * unit
        return cls(math.ceil(size[0] / side), math.ceil(size[1] / side), side, origin)

    @property
    def count(self) -> int:
        """How many there are."""
        return self.columns * self.rows

    def state_of(self, position: tuple[float, float]) -> int:
        """Return the number of the cell that holds a position (m), or of the nearest."""
        column, row = (
            min(max(int((at - low) // self.side), 0), most - 1)
            for at, low, most in zip(position, self.origin, (self.columns, self.rows), strict=True)
        )
        return row * self.columns + column


def step_of(action: int, side: float, to_goal: float) -> tuple[float, float]:
    """Return the heading (rad) and the length (m) of an action's step: no farther than the goal.

    Args:
        action: Its number.
        side: Side of a cell (m).
        to_goal: Distance to the goal (m).
    """
    return math.tau * action / HEADINGS, min(side, to_goal)


class PositionPlanner:
    """Takes the best heading of the cell that the robot is in.

    Args:
        cells: The cells.
        best: The best action of each.
    """

    def __init__(self, cells: Cells, best: Sequence[int]) -> None:
        self._cells = cells
        self._best = best

    def decide(self, observation: Observation, /) -> Decision:
        """Return a step along that heading."""
        action = self._best[self._cells.state_of(observation.position)]
        return Decision(*step_of(action, self._cells.side, towards_goal(observation).distance))
