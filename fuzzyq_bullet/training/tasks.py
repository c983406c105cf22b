"""The scenarios that planners are trained on. No study uses one of them."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.ground_truth import feasible
from fuzzyq_bullet.scenario import (
    Drive,
    Limits,
    Scenario,
    cellular_task,
    random_task,
    realise,
)

FIRST_SEED = 2**62
"""Scenarios with seeds from here on are for training. Sweeps stay below."""
SEEDS_APART = 2**24
"""Scenario seeds that each seed of a training reserves: ``TRIES`` for every episode."""
TRIES = 16
"""Scenarios that may be drawn for one episode until one has a path to the goal."""
MOST_SEED = (2**63 - FIRST_SEED) // SEEDS_APART - 1
"""Greatest seed of a training."""
ROOM = 0.22
"""Radius (m) of the disc for which there must be a path: half the width of a detection line."""
COUNTS = (25, 50, 75, 100)
"""Numbers of obstacles of the random scenarios, taken in turn."""
LIMITS = Limits(time=300.0, steps=5000)


@dataclass(frozen=True)
class Tasks:
    """Scenarios for the episodes of a training: random ones, or always the same.

    Attributes:
        drive: What moves the robot.
        seed: Of the training.
        counts: Numbers of scattered obstacles, taken in turn.
        cellular: Whether a corridor of clumped pillars follows after the last of them.
        scenario: If given, every episode is this one, its obstacles drawn anew if it draws any.
    """

    drive: Drive = "wheels"
    seed: int = 0
    counts: tuple[int, ...] = COUNTS
    cellular: bool = False
    scenario: Scenario | None = None

    def __post_init__(self) -> None:
        if not 0 <= self.seed <= MOST_SEED:
            raise UserError(f"seed: must be from 0 to {MOST_SEED}, got {self.seed}")

    def scenario_of(self, episode: int) -> Scenario:
        """Return the scenario of an episode, counted from 1, with every obstacle in its place.

        It has a path to the goal, unless ``TRIES`` scenarios in a row had none.
        """
        first = FIRST_SEED + self.seed * SEEDS_APART + episode * TRIES
        for seed in range(first, first + TRIES):
            scenario = realise(self._asked(seed, episode))
            if feasible(scenario, ROOM):
                break
        return scenario

    def is_corridor(self, episode: int) -> bool:
        """Return whether an episode is in a corridor of pillars."""
        return self.scenario is None and self._turn(episode) == len(self.counts)

    def digest(self) -> str:
        """Return a hash of everything that the scenarios depend on."""
        asked = {
            "seed": self.seed,
            "counts": list(self.counts),
            "limits": LIMITS.model_dump(mode="json"),
            "scenario": None if self.scenario is None else self.scenario.model_dump(mode="json"),
        }
        if self.cellular:
            asked["cellular"] = True
        return hashlib.sha256(json.dumps(asked, sort_keys=True).encode()).hexdigest()[:32]

    def _turn(self, episode: int) -> int:
        return episode % (len(self.counts) + self.cellular)

    def _asked(self, seed: int, episode: int) -> Scenario:
        if self.scenario is not None:
            return self.scenario.model_copy(update={"seed": seed, "drive": self.drive})
        if self.is_corridor(episode):
            task = cellular_task(seed)
        else:
            task = random_task(seed, count=self.counts[self._turn(episode)])
        return task.model_copy(update={"drive": self.drive, "limits": LIMITS})
