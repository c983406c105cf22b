"""What is run: a grid search where the training was, then a comparison where it never was."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.experiments.learning_gain.candidates import TRIPLES, label_of, settings_of
from fuzzyq_bullet.experiments.sweep.jobs import MOST_RUNS, Environment, Job
from fuzzyq_bullet.learning import Policy
from fuzzyq_bullet.planning.fuzzy_q_lambda import Weights
from fuzzyq_bullet.planning.settings import FuzzyQLambdaSettings
from fuzzyq_bullet.scenario import Drive, Limits
from fuzzyq_bullet.training.registry import recipe_of
from fuzzyq_bullet.training.tasks import FIRST_SEED, Tasks

LAYOUT = "scatter"
LEARNED = "learned"
"""What rows call the planner that has learned."""
LIMITS = Limits(time=600.0, steps=100_000)
"""Long enough to go round everything twice, so that slow weights are slow and not failures."""
MOST_SEED = (FIRST_SEED - 1) // MOST_RUNS - 1
"""Greatest seed of a comparison: all its environments lie below those of any training."""


@dataclass(frozen=True)
class Search:
    """The grid search, on the environments of a training.

    Attributes:
        drive: What moves the robot.
        seed: Of the training.
        episodes: How many of its environments: those of its first episodes.
        candidates: The weights to try.
    """

    drive: Drive
    seed: int
    episodes: int
    candidates: tuple[Weights, ...] = TRIPLES

    @property
    def tasks(self) -> Tasks:
        """Where the training took place."""
        return recipe_of("fuzzy-q-lambda").tasks(self.drive, self.seed)

    @cached_property
    def environments(self) -> tuple[Environment, ...]:
        """The environments of episodes 1 to ``episodes``, with the seeds that training uses."""
        found = []
        for episode in range(1, self.episodes + 1):
            scenario = self.tasks.scenario_of(episode)
            count = len(scenario.obstacles)
            found.append(Environment(LAYOUT, count, episode, scenario.seed))
        return tuple(found)

    def jobs(self) -> list[Job]:
        """Return all jobs; those of one environment are neighbours, which share its oracle."""
        return [
            Job(where, label_of(weights), settings_of(weights), self.drive, LIMITS)
            for where in self.environments
            for weights in self.candidates
        ]

    def described(self) -> dict[str, Any]:
        """Return all that the rows depend on, as JSON can say it."""
        return {
            "drive": self.drive,
            "training_seed": self.seed,
            "episodes": self.episodes,
            "tasks": self.tasks.digest(),
            "candidates": [label_of(weights) for weights in self.candidates],
            "limits": LIMITS.model_dump(mode="json"),
        }


@dataclass(frozen=True)
class Comparison:
    """The comparison, on environments that no training ever meets.

    Attributes:
        drive: What moves the robot.
        seed: Of the sweep, 0 to ``MOST_SEED``.
        number: How many environments.
        counts: Numbers of scattered obstacles, taken in turn.
        fixed: The weights to compare with, each once.
        learned: The planner that has learned.
        policy: What it learned.
    """

    drive: Drive
    seed: int
    number: int
    counts: tuple[int, ...]
    fixed: tuple[Weights, ...]
    learned: FuzzyQLambdaSettings
    policy: Policy

    @cached_property
    def environments(self) -> tuple[Environment, ...]:
        """The environments.

        Raises:
            UserError: If one of them might be a training's.
        """
        found = tuple(
            Environment.of(LAYOUT, self.counts[run % len(self.counts)], run, self.seed)
            for run in range(self.number)
        )
        unseen(found)
        return found

    def jobs(self) -> list[Job]:
        """Return all jobs; those of one environment are neighbours, which share its oracle."""
        planners = [(label_of(weights), settings_of(weights)) for weights in self.fixed]
        return [
            Job(where, label, settings, self.drive, LIMITS)
            for where in self.environments
            for label, settings in (*planners, (LEARNED, self.learned))
        ]

    def described(self) -> dict[str, Any]:
        """Return all that the rows depend on, as JSON can say it."""
        # The policy's contents and not its path: another training must not go by the same name.
        digest = hashlib.sha256(self.policy.dumps().encode()).hexdigest()[:32]
        return {
            "drive": self.drive,
            "seed": self.seed,
            "environments": self.number,
            "counts": list(self.counts),
            "fixed": [label_of(weights) for weights in self.fixed],
            "policy": digest,
            "limits": LIMITS.model_dump(mode="json"),
        }


def unseen(environments: Sequence[Environment]) -> tuple[int, int]:
    """Make sure that no training can have met an environment; return least and greatest seed.

    Every scenario of every training has a seed of at least ``FIRST_SEED``.

    Raises:
        UserError: If a seed is a training's.
    """
    seeds = [where.seed for where in environments]
    if max(seeds) >= FIRST_SEED:
        raise UserError(f"seed {max(seeds)}: from {FIRST_SEED} on they are for training")
    return min(seeds), max(seeds)


def learned_settings(policy: Path | None) -> FuzzyQLambdaSettings:
    """Return the planner that has learned; ``policy`` is its file, None for the one shipped.

    Raises:
        UserError: If that is no path a planner may have.
    """
    try:
        return FuzzyQLambdaSettings(policy=None if policy is None else str(policy))
    except ValidationError as error:
        raise UserError(f"--policy: {error.errors(include_url=False)[0]['msg']}") from error
