"""What planners learn: headings (``q-learning``, ``q-lambda``) or weights (``fuzzy-q-lambda``)."""

from __future__ import annotations

from fuzzyq_bullet.learning.linear import Features
from fuzzyq_bullet.planning.fuzzy_q_lambda import ACTIONS, OptionTermination, features_of
from fuzzyq_bullet.planning.improved_fuzzy import ImprovedFuzzyBase
from fuzzyq_bullet.planning.q_learning import act, sense
from fuzzyq_bullet.planning.settings import FuzzyQLambdaSettings
from fuzzyq_bullet.training.episode import TrainingEpisode
from fuzzyq_bullet.training.tasks import Tasks

MOST_LOST = 5.0
"""Greatest delay that counts for one option (s), because most of a longer search is chance."""


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
    with progress along the true shortest path (``training.distance_field``).

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
        return self._option.ends(seen.to_goal, self._planner.mode, clear=seen.clear)
