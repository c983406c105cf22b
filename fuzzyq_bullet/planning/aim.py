"""An aim: where the robot goes next, the goal or a temporary goal on a way out (Fig. 6)."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from fuzzyq_bullet.planning.base import Observation
from fuzzyq_bullet.planning.decision import Mode
from fuzzyq_bullet.planning.scan import Point

NOWHERE = (math.nan, math.nan)


class Aim(NamedTuple):
    """Towards this the detection lines are cast, and the controller drives (Steps 6 to 11).

    Attributes:
        point: Where it is (m).
        distance: How far from the robot (m).
        bearing: World heading of it (rad).
        mode: The part of the planner that proposes it.
        exact: Whether the robot must head for it exactly: the rules do not turn it.
        reach: How far the robot may move before it decides again (m).
        target: The temporary goal that it lies on the way to (m); NaN for the goal.
        hopeless: Whether no way is left to try.
        backward: Whether the robot backs up towards it.
    """

    point: Point
    distance: float
    bearing: float
    mode: Mode = "routine"
    exact: bool = False
    reach: float = math.inf
    target: Point = NOWHERE
    hopeless: bool = False
    backward: bool = False

    def told(self) -> dict[str, Any]:
        """Return what a decision on the way there tells of it, by the decision's fields."""
        return {
            "reach": self.reach,
            "mode": self.mode,
            "target": self.target,
            "aim": self.point,
            "exact": float(self.exact),
            "hopeless": self.hopeless,
            "backward": self.backward,
        }


def towards_goal(observation: Observation) -> Aim:
    """Return the goal as the aim; the robot brakes so that it could stop at its centre."""
    (x, y), (goal_x, goal_y) = observation.position, observation.goal
    distance = math.hypot(goal_x - x, goal_y - y)
    return Aim(observation.goal, distance, math.atan2(goal_y - y, goal_x - x), reach=distance)


def along_heading(
    observation: Observation, heading: float, distance: float, mode: Mode, target: Point
) -> Aim:
    """Return an aim at a distance (m) along a world heading (rad), on the way to a target (m)."""
    x, y = observation.position
    point = x + distance * math.cos(heading), y + distance * math.sin(heading)
    return Aim(point, distance, heading, mode, target=target)
