"""Q-learning and Q(λ), training and policies; it knows nothing of robots."""

from fuzzyq_bullet.learning.choice import epsilon_greedy, greedy
from fuzzyq_bullet.learning.expected import Expected
from fuzzyq_bullet.learning.linear import Features, LinearQLambda
from fuzzyq_bullet.learning.policy import Policy, load_policy
from fuzzyq_bullet.learning.problem import Learner, Problem
from fuzzyq_bullet.learning.schedules import (
    EXPLORATION,
    LEARNING_RATE,
    TABLE_1,
    TRACE_DECAY,
    Schedule,
)
from fuzzyq_bullet.learning.tabular import QLambda, QLearning
from fuzzyq_bullet.learning.training import Setup, episode_rng, train

__all__ = [
    "EXPLORATION",
    "LEARNING_RATE",
    "TABLE_1",
    "TRACE_DECAY",
    "Expected",
    "Features",
    "Learner",
    "LinearQLambda",
    "Policy",
    "Problem",
    "QLambda",
    "QLearning",
    "Schedule",
    "Setup",
    "episode_rng",
    "epsilon_greedy",
    "greedy",
    "load_policy",
    "train",
]
