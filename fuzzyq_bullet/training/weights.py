"""Learning weights, the paper's problem: at every decision, choose what to put on the situation."""

from __future__ import annotations

import math

from fuzzyq_bullet.episode import Episode
from fuzzyq_bullet.learning.linear import Features
from fuzzyq_bullet.physics.world import World
from fuzzyq_bullet.planning.improved import Weighed
from fuzzyq_bullet.planning.settings import FuzzyQLambdaSettings
from fuzzyq_bullet.planning.weighing import ACTIONS, features_of
from fuzzyq_bullet.training.rewards import Reward
from fuzzyq_bullet.training.tasks import Tasks


class WeightsProblem:
    """The problem that ``fuzzy-q-lambda`` learns (``learning.Problem``).

    States and actions are those of ``planning.weighing``, the reward is ``training.rewards``.

    Args:
        tasks: Where it is learned.
    """

    def __init__(self, tasks: Tasks) -> None:
        self._tasks = tasks
        self._world: World | None = None

    def reset(self, episode: int, /) -> Features:
        """Begin an episode."""
        if self._world is not None:
            self._world.close()
        scenario = self._tasks.scenario_of(episode)
        self._scenario = scenario
        self._world = World(scenario.obstacles, scenario.arena)
        self._episode = Episode(self._world, scenario)
        self._planner = Weighed(FuzzyQLambdaSettings())
        return self._look()

    def step(self, action: int, /) -> tuple[Features, float, bool]:
        """Decide with the weights of an action."""
        weights = ACTIONS[action]
        before, goal = self._episode.now, self._scenario.goal.position
        self._episode.advance(
            self._planner.act(self._observation, self._situation, weights[:2], weights.breakout_at)
        )
        now, outcome = self._episode.now, self._episode.outcome
        reward = Reward.of(
            seconds=now.time - before.time,
            nearer=math.dist((before.x, before.y), goal) - math.dist((now.x, now.y), goal),
            max_speed=self._scenario.robot.max_speed,
            outcome=outcome,
        )
        return self._look(), reward.total, outcome is not None

    @property
    def outcome(self) -> str:
        """How the episode stands."""
        return self._episode.outcome or "going on"

    def _look(self) -> Features:
        self._observation = self._episode.observe()
        self._situation = self._planner.sense(self._observation)
        return features_of(self._situation, self._planner.mode)
