"""Learning a table of places in one field: the paper's baselines, as it may mean them.

It is learned by the point robot, whose contacts are exact, and without a simulation: the table
senses nothing. All the rest is as for the direct planners (``training.problems``): the reward, and
that a contact does not end an episode, but leaves the robot where it was.
"""

from __future__ import annotations

import math

from fuzzyq_bullet.drives.kinematic import STEP_TIME
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.learning import QLambda, QLearning, Schedule, Setup, greedy, train
from fuzzyq_bullet.planning.position import HEADINGS, Cells, PositionPlanner, step_of
from fuzzyq_bullet.scenario.models import Scenario
from fuzzyq_bullet.training.rewards import USUAL

LEARNERS = {"q-learning": QLearning, "q-lambda": QLambda}
"""What learns the table of each planner."""
SETUP = Setup(episodes=200, rate=Schedule(0.5), exploration=Schedule(0.1, 0.09), max_steps=600)
"""200 episodes, as the paper has it. A table of 5000 values that all begin at 0, which is more than
any of them is worth, is explored without much chance, and with Eq. 20 it would not be learned in so
few: rate and ε are others than the paper's."""


class PositionProblem:
    """To go to the goal of a field, knowing nothing but where one is (``learning.Problem``).

    Args:
        scenario: A realised scenario.
    """

    def __init__(self, scenario: Scenario) -> None:
        self.cells = Cells.over(scenario.arena.size, scenario.robot.radius, scenario.arena.origin)
        self._scenario = scenario
        self._field = Field.of(scenario.standing, scenario.arena)

    def reset(self, episode: int, /) -> int:
        """Begin an episode; all are the same."""
        self._position = self._scenario.start.position
        self._hit = self._arrived = False
        return self.cells.state_of(self._position)

    def step(self, action: int, /) -> tuple[int, float, bool]:
        """Take the step of an action."""
        robot, goal = self._scenario.robot, self._scenario.goal
        x, y = self._position
        before = math.dist(self._position, goal.position)
        heading, length = step_of(action, self.cells.side, before)
        [free] = self._field.free_distance((x, y), [heading], robot.radius, length).tolist()
        if free < length:
            self._hit = True
            return self.cells.state_of(self._position), -STEP_TIME - USUAL.hit, False
        self._position = x + length * math.cos(heading), y + length * math.sin(heading)
        after = math.dist(self._position, goal.position)
        self._arrived = after <= goal.radius
        earned = -STEP_TIME + USUAL.progress * (before - after) / robot.max_speed
        return self.cells.state_of(self._position), earned, self._arrived

    @property
    def outcome(self) -> str:
        """How the episode stands; ``collision`` once anything was hit, whatever came after."""
        return "collision" if self._hit else "goal" if self._arrived else "going on"


def learn_position(planner: str, scenario: Scenario) -> PositionPlanner:
    """Learn a realised field, and return the planner that has.

    Args:
        planner: ``q-learning`` or ``q-lambda``.
        scenario: The scenario; its drive is of no matter.
    """
    problem = PositionProblem(scenario)
    learner = LEARNERS[planner](problem.cells.count, HEADINGS)
    train(problem, learner, SETUP)
    return PositionPlanner(problem.cells, [greedy(row) for row in learner.table.tolist()])
