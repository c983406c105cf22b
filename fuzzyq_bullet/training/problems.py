"""What planners learn: headings (``q-learning``, ``q-lambda``) or weights (``fuzzy-q-lambda``).

Both are learned by driving: a ``TrainingEpisode`` is a world, what is observed in it, and what a
decision earns.
"""

from __future__ import annotations

import math

from fuzzyq_bullet.episode import Episode
from fuzzyq_bullet.ground_truth.distance_field import DistanceField
from fuzzyq_bullet.learning.learners import Features
from fuzzyq_bullet.physics.engine import Engine
from fuzzyq_bullet.physics.robot import RobotState
from fuzzyq_bullet.physics.world import World
from fuzzyq_bullet.planning.base import Observation
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.planning.fuzzy_q_lambda import ACTIONS, OptionTermination, features_of
from fuzzyq_bullet.planning.improved_fuzzy import ImprovedFuzzyBase
from fuzzyq_bullet.planning.q_learning import act, sense
from fuzzyq_bullet.planning.settings import FuzzyQLambdaSettings
from fuzzyq_bullet.scenario.models import Limits, Start
from fuzzyq_bullet.training.rewards import Reward
from fuzzyq_bullet.training.tasks import Tasks

PATIENCE = 10.0
"""How long the robot may stay at one place before the episode ends as stuck (s)."""
MOST_LOST = 5.0
"""Greatest delay that counts for one option (s), because most of a longer search is chance."""


class TrainingEpisode:
    """The current episode of a training, which all problems that are learned by driving share.

    Args:
        tasks: Where it is learned.
        hits_end: Whether an episode is over with the first contact. If not, the robot is put back
            to where it decided, at rest, and goes on. The contact has its cost, and time is not
            put back.
        true_progress: Whether progress is measured along the true shortest path, which no planner
            knows, instead of the straight line to the goal.
    """

    def __init__(self, tasks: Tasks, *, hits_end: bool = True, true_progress: bool = False) -> None:
        self._tasks = tasks
        self._hits_end = hits_end
        self._true_progress = true_progress
        self._engine: Engine | None = None

    def begin(self, episode: int) -> None:
        """Begin an episode, counted from 1."""
        if self._engine is None:
            self._engine = Engine()
        self._scenario = scenario = self._tasks.scenario_of(episode)
        self._world = World(
            scenario.obstacles, scenario.arena, engine=self._engine, model=scenario.robot.spec
        )
        self._episode = Episode(self._world, scenario, patience=PATIENCE)
        self._distances = DistanceField(scenario) if self._true_progress else None
        self._left = self._to_goal(self._episode.now)
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
        self._left = self._to_goal(self._episode.now)
        return Reward.of(
            seconds=now.time - before.time,
            nearer=left - self._left,
            max_speed=self._scenario.robot.max_speed,
            outcome=outcome,
        )

    @property
    def over(self) -> bool:
        """Whether the episode has ended."""
        return self._episode.outcome is not None

    @property
    def outcome(self) -> str:
        """How the episode stands; ``collision`` once anything was hit, whatever came after."""
        return "collision" if self._hit else self._episode.outcome or "going on"

    def _to_goal(self, tick: RobotState) -> float:
        """Return the distance to the goal that is left (m)."""
        if self._distances is not None:
            return self._distances.at(tick.x, tick.y)
        return math.dist((tick.x, tick.y), self._scenario.goal.position)

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
    """

    def __init__(self, tasks: Tasks) -> None:
        self._episode = TrainingEpisode(tasks, hits_end=False)

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


class WeightsProblem:
    """The problem that ``fuzzy-q-lambda`` learns (``learning.Problem``).

    States and actions are those of ``planning.fuzzy_q_lambda``, the reward is ``training.rewards``
    with progress along the true shortest path.

    Args:
        tasks: Where it is learned.
    """

    def __init__(self, tasks: Tasks) -> None:
        self._episode = TrainingEpisode(tasks, true_progress=True)

    def reset(self, episode: int, /) -> Features:
        """Begin an episode."""
        self._episode.begin(episode)
        self._planner = ImprovedFuzzyBase(FuzzyQLambdaSettings())
        self._option = OptionTermination()
        self._look()
        return features_of(self._situation)

    def step(self, action: int, /) -> tuple[Features, float, bool]:
        """Drive with the weights of an action until its option ends."""
        weights, lost, fate = ACTIONS[action], 0.0, 0.0
        while True:
            decision = self._planner.act(
                self._observation, self._situation, weights[:2], weights.breakout_at
            )
            reward = self._episode.advance(decision)
            lost += reward.time + reward.progress
            fate += reward.contact + reward.given_up
            if self._look() or self._episode.over:
                earned = max(lost, -MOST_LOST) + fate
                return features_of(self._situation), earned, self._episode.over

    @property
    def outcome(self) -> str:
        """How the episode stands."""
        return self._episode.outcome

    def _look(self) -> bool:
        """Observe where the robot is now, and return whether the option ends here."""
        self._observation = self._episode.observe()
        self._situation = seen = self._planner.sense(self._observation)
        mode = self._planner.mode
        return self._option.ends(seen.to_goal, mode, clear=seen.clear, unit=seen.unit)
