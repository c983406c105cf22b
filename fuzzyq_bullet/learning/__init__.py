"""Q-learning and Q(λ), training and policies; it knows nothing of robots."""

from fuzzyq_bullet.learning.choices import epsilon_greedy, greedy
from fuzzyq_bullet.learning.fuzzy import FuzzyQLambda
from fuzzyq_bullet.learning.learners import QLambda, QLearning
from fuzzyq_bullet.learning.policy import Policy, PolicySpec, hash_of, load_policy
from fuzzyq_bullet.learning.schedules import (
    EXPLORATION,
    LEARNING_RATE,
    TABLE_1,
    TRACE_DECAY,
    Schedule,
)
from fuzzyq_bullet.learning.training import (
    Learner,
    Problem,
    Setup,
    episode_rng,
    train,
)

__all__ = [
    "EXPLORATION",
    "LEARNING_RATE",
    "TABLE_1",
    "TRACE_DECAY",
    "FuzzyQLambda",
    "Learner",
    "Policy",
    "PolicySpec",
    "Problem",
    "QLambda",
    "QLearning",
    "Schedule",
    "Setup",
    "episode_rng",
    "epsilon_greedy",
    "greedy",
    "hash_of",
    "load_policy",
    "train",
]
