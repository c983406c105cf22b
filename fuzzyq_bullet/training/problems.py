"""What planners learn: headings (``q-learning``, ``q-lambda``) or weights (``fuzzy-q-lambda``).

Both are learned by driving: a ``TrainingEpisode`` is a world, what is observed in it, and what a
decision earns.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from fuzzyq_bullet.episode import Episode
from fuzzyq_bullet.ground_truth.distance_field import DistanceField
from fuzzyq_bullet.learning.learners import Floats
from fuzzyq_bullet.physics.engine import Engine
from fuzzyq_bullet.physics.robot import RobotState
from fuzzyq_bullet.physics.world import World
from fuzzyq_bullet.planning.base import Observation
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.planning.fuzzy_q_lambda import CHOICES, firing, weighed
from fuzzyq_bullet.planning.improved_fuzzy import ImprovedFuzzyBase
from fuzzyq_bullet.planning.q_learning import act, sense
from fuzzyq_bullet.planning.settings import FuzzyQLambdaSettings, PlannerSettings
from fuzzyq_bullet.scenario.models import Limits
from fuzzyq_bullet.scenario.places import Start
from fuzzyq_bullet.training.rewards import USUAL, Reward, RewardSettings, Transition
from fuzzyq_bullet.training.tasks import Tasks

PATIENCE = 10.0
"""How long the robot may stay at one place before the episode ends as stuck (s)."""
HOLD = 6
"""Decisions of one step of learning: 0.3 s on wheels."""


class TrainingEpisode:
    """The current episode of a training, which all problems that are learned by driving share.

    Args:
        tasks: Where it is learned.
        hits_end: Whether an episode is over with the first contact. If not, the robot is put back
            to where it decided, at rest, and goes on. The contact has its cost, and time is not
            put back.
        true_progress: Whether progress is measured along the true shortest path, which no planner
            knows, instead of the straight line to the goal.
        reward: What a decision earns.
        planner: Settings of the planner that drives, if not those of the tasks.
    """

    def __init__(
        self,
        tasks: Tasks,
        *,
        hits_end: bool = True,
        true_progress: bool = False,
        reward: RewardSettings = USUAL,
        planner: PlannerSettings | None = None,
    ) -> None:
        self._tasks = tasks
        self._reward = reward
        self._planner = planner
        self._hits_end = hits_end
        self._true_progress = true_progress
        self._engine: Engine | None = None

    def begin(self, episode: int) -> None:
        """Begin an episode, counted from 1."""
        if self._engine is None:
            self._engine = Engine()
        scenario = self._tasks.scenario_of(episode)
        if self._planner is not None:
            scenario = scenario.model_copy(update={"planner": self._planner})
        self._scenario = scenario
        self._world = World(
            scenario.obstacles, scenario.arena, engine=self._engine, model=scenario.robot.spec
        )
        self._episode = Episode(self._world, scenario, patience=PATIENCE)
        self._distances = DistanceField(scenario) if self._true_progress else None
        self._left = self._to_goal_now()
        self._decided = 0
        self._hit = False

    def observe(self) -> Observation:
        """Return what a planner may know now."""
        return self._episode.observe()

    def advance(self, decision: Decision) -> Reward:
        """Carry out a decision and return what it earns."""
        before, left = self._episode.now, self._left
        self._episode.advance(decision)
        self._decided += 1
        now, outcome = self._episode.now, self._episode.outcome
        if outcome == "collision" and not self._hits_end:
            self._put_back(before)
        self._left = self._to_goal_now()
        max_speed = self._scenario.robot.max_speed
        return self._reward.of(Transition(before, now, left - self._left, max_speed, outcome))

    @property
    def potential(self) -> float:
        """Φ: minus the time that what is left of the way takes at full speed (s).

        0 with a reward of the user's own, which says itself what counts.
        """
        counts = 0.0 if self._reward.own else self._reward.progress
        return -counts * self._left / self._scenario.robot.max_speed

    @property
    def over(self) -> bool:
        """Whether the episode has ended."""
        return self._episode.outcome is not None

    @property
    def outcome(self) -> str:
        """How the episode stands; ``collision`` once anything was hit, whatever came after."""
        return "collision" if self._hit else self._episode.outcome or "going on"

    def to_goal(self, x: float, y: float) -> float:
        """Return the distance to the goal from a point (m): true, or straight."""
        if self._distances is not None:
            return self._distances.at(x, y)
        return math.dist((x, y), self._scenario.goal.position)

    def _to_goal_now(self) -> float:
        return self.to_goal(self._episode.now.x, self._episode.now.y)

    def _put_back(self, tick: RobotState) -> None:
        """Go on from an earlier tick, unless the episode's time or decisions are used up."""
        self._hit = True
        time = self._scenario.limits.time - self._episode.now.time
        steps = self._scenario.limits.steps - self._decided
        if time <= 0.0 or steps <= 0:
            return
        self._scenario = self._scenario.model_copy(
            update={
                "start": Start(position=(tick.x, tick.y), heading=tick.heading),
                "limits": Limits(time=time, steps=steps),
            }
        )
        self._episode = Episode(self._world, self._scenario, patience=PATIENCE)
        self._decided = 0


class DirectProblem:
    """The problem that the direct planners learn (``learning.Problem``).

    States and actions are those of ``planning.q_learning``, the reward is ``training.rewards``. An
    episode does not end with a contact: the robot is put back and goes on. Otherwise, without a
    safety filter, most episodes would end soon, and most states would never be visited.

    Args:
        tasks: Where it is learned.
        reward: What a decision earns.
    """

    def __init__(self, tasks: Tasks, *, reward: RewardSettings = USUAL) -> None:
        self._episode = TrainingEpisode(tasks, hits_end=False, reward=reward)

    def reset(self, episode: int, /) -> int:
        """Begin an episode."""
        self._episode.begin(episode)
        return self._look()

    def step(self, action: int, /) -> tuple[int, float, bool]:
        """Take the step of an action."""
        reward = self._episode.advance(act(self._sensed, action))
        return self._look(), reward.total, self._episode.over

    @property
    def outcome(self) -> str:
        """How the episode stands; ``collision`` once anything was hit, whatever came after."""
        return self._episode.outcome

    def _look(self) -> int:
        self._sensed = sense(self._episode.observe())
        return self._sensed.state


class RuleWeightsProblem:
    """The problem that ``fuzzy-q-lambda`` learns (``learning.Problem``).

    States are the shares of the rules in all that fires, actions a choice of weights for each rule,
    which stands for ``HOLD`` decisions: the effect of a turn shows a while later. The reward of
    such a step is minus the seconds that it took, penalties, and γΦ(s') − Φ(s) with Φ minus the
    time that the true shortest path would take at full speed: this leaves the best behaviour as it
    is (potential-based shaping). With γ = 1 it is minus the delay, in seconds.

    Ways out are chosen by the truth about where they lead. What a wrong one costs is no rule's
    fault, and is so much more than what any weights gain that it would drown that: the return of
    an episode has a standard deviation of 1.7 s instead of 10.9 s.

    Args:
        tasks: Where it is learned.
        settings: The planner's, with the rules that it weighs.
        discount: γ.
        reward: What a decision earns.
    """

    def __init__(
        self,
        tasks: Tasks,
        *,
        settings: FuzzyQLambdaSettings,
        discount: float,
        reward: RewardSettings = USUAL,
    ) -> None:
        self._episode = TrainingEpisode(tasks, true_progress=True, reward=reward, planner=settings)
        self._settings = settings
        self._discount = discount

    def reset(self, episode: int, /) -> Floats:
        """Begin an episode."""
        self._episode.begin(episode)
        self._planner = ImprovedFuzzyBase(self._settings)
        self._planner.know(self._episode.to_goal)
        self._look()
        return firing(self._situation.inferred)

    def step(self, choices: Sequence[int], /) -> tuple[Floats, float, bool]:
        """Drive ``HOLD`` decisions with the weights that each rule chose."""
        weights = np.array([CHOICES[choice] for choice in choices])
        before, spent = self._episode.potential, 0.0
        for _ in range(HOLD):
            used = weighed(firing(self._situation.inferred), weights)
            reward = self._episode.advance(
                self._planner.act(self._observation, self._situation, used)
            )
            spent += reward.unshaped
            self._look()
            if self._episode.over:
                break
        earned = spent + self._discount * self._episode.potential - before
        return firing(self._situation.inferred), earned, self._episode.over

    @property
    def outcome(self) -> str:
        """How the episode stands."""
        return self._episode.outcome

    def _look(self) -> None:
        """Observe where the robot is now."""
        self._observation = self._episode.observe()
        self._situation = self._planner.sense(self._observation)
