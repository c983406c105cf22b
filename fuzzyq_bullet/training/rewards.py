"""The reward of a decision, in seconds: r = −Δt + Δ(distance to the goal)/v_max − penalties."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from fuzzyq_bullet.geometry import Field, Floats
from fuzzyq_bullet.occupancy import SIXTEEN, OccupancyGrid
from fuzzyq_bullet.scenario.models import Scenario
from fuzzyq_bullet.trajectory import Outcome

HIT = 30.0
"""Penalty for a contact (s): more than any detour that avoids it."""
GIVEN_UP = 10.0
"""Penalty for an episode that ends outside the goal without a contact (s)."""
CELL = 0.05
"""Side of a cell (m)."""
ROOM = 0.21
"""Radius (m) of the disc that must fit: between that of the robot and what it can see."""


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


class DistanceField:
    """The true distance to the goal from everywhere: the lengths of the shortest paths.

    No planner ever sees it, but a reward may know more than who is rewarded. By the straight
    distance, a step into a dead end looks as good as a step towards the goal, and the mistake only
    shows many decisions later.

    Args:
        scenario: A realised scenario.
    """

    def __init__(self, scenario: Scenario) -> None:
        grid = OccupancyGrid.over((0.0, 0.0), scenario.arena.size, CELL)
        points = grid.points()
        field = Field.of(scenario.obstacles, scenario.arena)
        grid.free[:] = (field.clearance(points.reshape(-1, 2)) >= ROOM).reshape(grid.free.shape)
        at_goal = np.hypot(*np.moveaxis(points - scenario.goal.position, 2, 0))
        source = np.unravel_index(np.where(grid.free, at_goal, np.inf).argmin(), at_goal.shape)
        lengths = grid.distances((int(source[0]), int(source[1])), SIXTEEN, past_corners=True)
        known = np.isfinite(lengths)
        # Where no disc fits there is no robot, but the cells beside interpolate with these.
        lengths[~known] = at_goal[~known] + (lengths[known].max() if known.any() else 0.0)
        self._lengths = _spread(lengths, known)

    def at(self, x: float, y: float) -> float:
        """Return the length of the shortest path from a point (m)."""
        [length] = map_coordinates(self._lengths, [[x / CELL], [y / CELL]], order=1, mode="nearest")
        return float(length)


def _spread(lengths: Floats, known: NDArray[np.bool_]) -> Floats:
    """Give every cell without a path the least length around it, four cells deep."""
    lengths, known = lengths.copy(), known.copy()
    for _ in range(4):
        padded = np.pad(np.where(known, lengths, np.inf), 1, constant_values=np.inf)
        windows = np.lib.stride_tricks.sliding_window_view(padded, (3, 3))
        least = windows.min(axis=(2, 3))
        new = ~known & np.isfinite(least)
        lengths[new] = least[new] + CELL
        known |= new
    return lengths
