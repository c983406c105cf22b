"""Training over many episodes with an ε-greedy exploration policy: problems, learners, the loop.

It can be interrupted anywhere and resumed exactly.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Protocol, TypeVar

import numpy as np

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.learning.checkpoint import LARGEST, ROW, Checkpoint, Curve, Plain, is_sound
from fuzzyq_bullet.learning.learners import Floats
from fuzzyq_bullet.learning.schedules import EXPLORATION, LEARNING_RATE, TRACE_DECAY, Schedule
from fuzzyq_bullet.version import __version__

MAX_EPISODES = 1_000_000
_CHOICES = 0
"""The random stream of an episode that chooses actions; a problem takes others."""

State = TypeVar("State")
Action = TypeVar("Action")
StateOut = TypeVar("StateOut", covariant=True)
StateIn = TypeVar("StateIn", contravariant=True)
ActionIn = TypeVar("ActionIn", contravariant=True)


class Problem(Protocol[StateOut, ActionIn]):
    """A Markov decision process to be learned in episodes.

    Nothing may be carried from one episode into the next, and all chance must come from the
    episode's number (``episode_rng``): this is what lets a training be interrupted and
    resumed without a trace.
    """

    def reset(self, episode: int, /) -> StateOut:
        """Begin an episode, counted from 1, and return its first state."""
        ...

    def step(self, action: ActionIn, /) -> tuple[StateOut, float, bool]:
        """Do an action.

        Returns:
            The state it leads to; the reward; and whether the task is over, so that nothing
            more can be earned and the state does not count. Running out of steps is not the end
            of the task: leave that to ``Setup.max_steps``.
        """
        ...

    @property
    def outcome(self) -> str:
        """How the episode stands, in at most 16 plain letters, such as ``goal``."""
        ...


class Learner(Protocol[StateIn, Action]):
    """Learns the values of actions: of one at a time, or of one for each rule."""

    def begin(self, rate: float, trace_decay: float) -> None:
        """Begin an episode with the learning rate α and trace decay λ; all traces are 0."""
        ...

    def choose(
        self, state: StateIn, epsilon: float, rng: np.random.Generator, *, random_ties: bool = False
    ) -> Action:
        """Choose ε-greedily: with the chance ``epsilon`` any action, else the best."""
        ...

    def learn(
        self, state: StateIn, action: Action, reward: float, after: StateIn | None, /
    ) -> float:
        """Learn from one step and return its error δ; ``after`` is None when the task is over."""
        ...

    @property
    def table(self) -> Floats:
        """All that was learned, shape (S, A); may be assigned."""
        ...

    @table.setter
    def table(self, table: Floats, /) -> None: ...

    def describe(self) -> Mapping[str, str | float]:
        """Return what it takes to build such a learner, beside its table."""
        ...


@dataclass(frozen=True, slots=True)
class Setup:
    """How to train; by default as the paper says.

    Attributes:
        episodes: Max.Episodes of Eqs. 20 and 21.
        seed: Where all chance comes from.
        rate: The learning rate η or α (Eq. 20).
        trace_decay: λ (Eq. 21), or a constant: ``Schedule(0.9)``.
        exploration: ε, the chance of an action at random.
        max_steps: M_s, after which an episode is cut short. What could still have been earned
            then counts: the last step is learned from like any other.
        random_ties: Whether actions of equal value are drawn from; else the first is taken.
    """

    episodes: int = 200
    seed: int = 0
    rate: Schedule = LEARNING_RATE
    trace_decay: Schedule = TRACE_DECAY
    exploration: Schedule = EXPLORATION
    max_steps: int = 3000
    random_ties: bool = False

    def __post_init__(self) -> None:
        if not 1 <= self.episodes <= MAX_EPISODES:
            raise UserError(f"episodes: must be 1 to {MAX_EPISODES}, got {self.episodes}")
        if self.seed < 0:
            raise UserError(f"seed: must be at least 0, got {self.seed}")
        if self.max_steps < 1:
            raise UserError(f"max_steps: must be at least 1, got {self.max_steps}")

    def describe(self) -> dict[str, Plain]:
        """Return all of it as plain values by name, such as ``rate.start``."""
        flat: dict[str, Plain] = {}
        for name, value in asdict(self).items():
            if isinstance(value, dict):
                flat.update({f"{name}.{part}": number for part, number in value.items()})
            else:
                flat[name] = value
        return flat


def episode_rng(seed: int, episode: int, stream: int) -> np.random.Generator:
    """Return a random generator of one episode's own, the same whatever was drawn before.

    Args:
        seed: The seed of the training.
        episode: Its number, counted from 1.
        stream: 0 chooses the actions; a problem takes 1 and above.
    """
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(episode, stream)))


def train(
    problem: Problem[State, Action],
    learner: Learner[State, Action],
    setup: Setup,
    *,
    made: Mapping[str, Plain] | None = None,
    checkpoint: Path | None = None,
    resume: bool = False,
    on_episode: Callable[[Curve], None] | None = None,
) -> Curve:
    """Let a learner learn a problem.

    Args:
        problem: What is to be learned.
        learner: What learns; it begins with the table that it has.
        setup: For how long, and how fast.
        made: What else the result depends on, such as the problem's parameters. A checkpoint
            keeps it, and is resumed with the same only.
        checkpoint: File that is renewed after every episode, whole or not at all.
        resume: Go on from ``checkpoint``, to the very table that an uninterrupted training ends
            with. Without that file the training begins at the first episode.
        on_episode: Called after each finished episode, once it is safe on disk, with the curve
            so far.

    Returns:
        The learning curve: ``total`` (sum of rewards), ``steps`` and ``outcome`` of each episode.

    Raises:
        UserError: If the checkpoint cannot be written, or read, or is that of another training;
            or if the learning diverges.
        ValueError: If the problem gives a reward that is not finite, or an unfit outcome.
    """
    plan = {"version": __version__, **setup.describe(), **learner.describe(), **(made or {})}
    curve = np.zeros(setup.episodes, ROW)
    done = 0
    saved = Checkpoint.find(checkpoint) if resume and checkpoint is not None else None
    if saved is not None and checkpoint is not None:
        saved.check(checkpoint, plan, learner.table.shape)
        done = len(saved.curve)
        curve[:done] = saved.curve
        learner.table = saved.table
    elif checkpoint is not None:  # now rather than after an episode, should that not be possible
        Checkpoint(plan, learner.table, curve[:0]).save(checkpoint)
    for episode in range(done + 1, setup.episodes + 1):
        curve[episode - 1] = _play(problem, learner, setup, episode)
        table = learner.table
        if not is_sound(table):
            raise UserError(
                f"episode {episode}: the learning diverges, to values beyond {LARGEST:g}; "
                "take a smaller learning rate or trace decay"
            )
        finished = curve[:episode]
        if checkpoint is not None:
            Checkpoint(plan, table, finished).save(checkpoint)
        if on_episode is not None:
            on_episode(finished)
    return curve


def _play(
    problem: Problem[State, Action], learner: Learner[State, Action], setup: Setup, episode: int
) -> tuple[float, int, bytes]:
    """Play one episode, learning all the way, and return its row of the curve."""
    rng = episode_rng(setup.seed, episode, _CHOICES)
    epsilon = setup.exploration.at(episode, setup.episodes)
    learner.begin(
        setup.rate.at(episode, setup.episodes), setup.trace_decay.at(episode, setup.episodes)
    )
    state = problem.reset(episode)
    total, steps, over = 0.0, 0, False
    while not over and steps < setup.max_steps:
        action = learner.choose(state, epsilon, rng, random_ties=setup.random_ties)
        after, reward, over = problem.step(action)
        learner.learn(state, action, reward, None if over else after)
        state = after
        total += reward
        steps += 1
    if not math.isfinite(total):
        raise ValueError(f"episode {episode}: its rewards sum to {total}")
    outcome = problem.outcome.encode("ascii", "replace")
    if len(outcome) > ROW["outcome"].itemsize:
        raise ValueError(f"episode {episode}: the outcome {problem.outcome!r} is too long")
    return total, steps, outcome
