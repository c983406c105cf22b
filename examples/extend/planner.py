"""A planner of your own: among 16 headings it takes the one that leads nearest to the goal.

    fuzzyq run SCENARIO --planner greedy --plugin examples/extend/planner.py

A scenario file chooses it with ``planner: {name: greedy}``, or ``{name: greedy, room: 0.5}``.
"""

from __future__ import annotations

import math
from typing import Literal

from pydantic import Field

from fuzzyq_bullet import Decision, Observation, PlannerSettings, register_planner


class GreedySettings(PlannerSettings):
    """The keys of the scenario file. ``name`` must be the name that is registered."""

    name: Literal["greedy"] = "greedy"
    room: float = Field(default=0.3, gt=0.0, description="How much must be free to go (m).")


class GreedyPlanner:
    """Lives for one episode; what it keeps in its attributes is its memory."""

    def __init__(self, settings: GreedySettings) -> None:
        self._room = settings.room

    def decide(self, observation: Observation, /) -> Decision:
        """Return the next step.

        A planner cannot see the map. What it senses is how far the robot can move along headings.
        """
        (x, y), (goal_x, goal_y) = observation.position, observation.goal
        to_goal = math.atan2(goal_y - y, goal_x - x)
        headings = [to_goal + math.tau * k / 16 for k in range(16)]
        lengths = observation.sense(headings)
        left = math.dist(observation.position, observation.goal)
        choices = [
            (math.cos(heading - to_goal), heading, length)
            for heading, length in zip(headings, lengths, strict=True)
            if length >= min(self._room, left)
        ]
        if not choices:  # it knows that it cannot go on: the episode ends as stuck
            return Decision(heading=observation.heading, step=0.0, hopeless=True)
        _, heading, length = max(choices)
        # The wheels brake so that the robot could stop within ``reach``.
        step = min(0.4, left, length / 2.0)
        return Decision(heading=heading, step=step, reach=max(0.0, length - 0.05))


register_planner("greedy", GreedySettings, lambda settings, rng: GreedyPlanner(settings))
