"""How fast an episode runs: against real time, against bare physics, and among many obstacles."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from statistics import median, quantiles
from unittest import mock

import numpy as np

from fuzzyq_bullet.episode import Episode
from fuzzyq_bullet.physics.engine import TIME_STEP, Contact
from fuzzyq_bullet.physics.world import World
from fuzzyq_bullet.planning import Decision
from fuzzyq_bullet.planning.consult import build_planner
from fuzzyq_bullet.scenario import (
    Arena,
    Goal,
    Limits,
    Random,
    Scenario,
    Start,
    random_task,
    realise,
)
from fuzzyq_bullet.scenario.layouts import Wanderers
from fuzzyq_bullet.studies.speed import Row, interleaved, median_ratio

COUNTS = (125, 1000)
"""Numbers of obstacles that are compared."""
FIELDS = 3
"""Fields of each number."""
SIMULATED = 20.0
"""Simulated time of one timed episode (s)."""
MOVING, STANDING = 20, 25
"""Obstacles that move, or stand as well, beside those that stand."""
SIDE = math.sqrt(max(COUNTS) / (125 / 100.0))
"""Side of the arena (m) in which 1000 obstacles are as dense as the paper's 125 in 10 × 10 m."""


@dataclass(frozen=True)
class _LoopTimes:
    """Times of episodes among one number of obstacles.

    Attributes:
        whole: Processor time of a simulated second (s), one a round: sensing, planning, contacts
            and recording included.
        bare: The same of ``stepSimulation`` alone, with the wheel commands of the same episodes.
        decisions: Time of each decision (s), from asking for the observation to having decided.
    """

    whole: list[float]
    bare: list[float]
    decisions: list[float]


@dataclass(frozen=True)
class _Loop:
    """One world with an episode to run in it again and again."""

    world: World
    scenario: Scenario
    rate: int
    decisions: list[float] = field(default_factory=list)

    def whole(self) -> Episode:
        """Run the episode with its planner."""
        rng = np.random.default_rng(self.scenario.seed)
        planner = build_planner(self.scenario.planner, rng)
        episode = Episode(self.world, self.scenario, rate=self.rate)
        while episode.outcome is None:
            start = time.perf_counter()
            observation = episode.observe()
            answer = planner.decide(observation)
            self.decisions.append(time.perf_counter() - start)
            episode.carry_out(answer, observation)
        return episode

    def bare(self) -> tuple[Callable[[], object], float]:
        """Return what only steps the physics through the same motion, and for how long (s)."""
        commands, steps = self._commands()
        robot, engine, start = self.world.robot, self.world.engine, self.scenario.start

        def work() -> None:
            robot.place(*start.position, self.scenario.start_heading())
            for step in range(steps):
                if (command := commands.get(step)) is not None:
                    robot.command(*command)
                engine.api.stepSimulation(physicsClientId=engine.client)

        return work, steps * TIME_STEP

    def _commands(self) -> tuple[dict[int, tuple[float, float]], int]:
        """Run the episode once and return its wheel commands by physics step, and how many."""
        given: dict[int, tuple[float, float]] = {}
        taken = 0
        advance, command = self.world.advance, self.world.robot.command

        def counting(steps: int) -> tuple[int, Contact | None]:
            nonlocal taken
            done = advance(steps)
            taken += done[0]
            return done

        def noting(left: float, right: float) -> None:
            given[taken] = (left, right)
            command(left, right)

        with (
            mock.patch.object(self.world, "advance", counting),
            mock.patch.object(self.world.robot, "command", noting),
        ):
            self.whole()
        self.decisions.clear()  # the first are slower: much is loaded in them
        return given, taken


def episodes(rounds: int, rate: int) -> list[Row]:
    """Return how fast an episode is, with ``rate`` decisions a simulated second."""
    few, many = _compare(rounds, rate)
    among = f"125 obstacles, {rate} decisions a second"
    decisions = f"{len(few.decisions)} decisions among {among}"
    return [
        Row(
            f"real time factor of one core, {among}",
            1.0 / median(few.whole),
            40.0,
            "at least",
            f"{1e3 * median(few.whole):.1f} ms for a simulated second",
        ),
        Row(
            f"share of bare physics in that time, {among}",
            median_ratio(few.bare, few.whole),
            0.5,
            "at least",
            f"{1e3 * median(few.bare):.1f} ms for a simulated second",
        ),
        Row(
            "time of a simulated second, 1000 obstacles against 125",
            median_ratio(many.whole, few.whole),
            1.15,
            "at most",
            f"{1e3 * median(many.whole):.1f} ms against {1e3 * median(few.whole):.1f} ms",
        ),
        Row(
            "time of one decision, median (ms)",
            1e3 * median(few.decisions),
            0.6,
            "at most",
            decisions,
        ),
        Row(
            "time of one decision, 99th percentile (ms)",
            1e3 * quantiles(few.decisions, n=100)[-1],
            20.0,
            "at most",
            f"longest {1e3 * max(few.decisions):.1f} ms",
        ),
        _moving(rounds, rate),
    ]


def _moving(rounds: int, rate: int) -> Row:
    """Return what it costs that obstacles move, while the robot stands among them and looks."""
    works = [_Watch(seed, moves, rate) for moves in (True, False) for seed in range(FIELDS)]
    for work in works:
        work()  # the first time much is loaded
    times = interleaved(works, rounds)
    seconds = [work.seconds for work in works]
    moving, standing = (
        [sum(of_round) / sum(seconds[own]) for of_round in zip(*times[own], strict=True)]
        for own in (slice(FIELDS), slice(FIELDS, None))
    )
    return Row(
        f"time of a simulated second, {MOVING} of {MOVING + STANDING} obstacles moving",
        median_ratio(moving, standing),
        1.5,
        "at most",
        f"{1e3 * median(moving):.1f} ms against {1e3 * median(standing):.1f} ms",
    )


class _Watch:
    """A robot that stands in a field and casts its three lines for each decision.

    Attributes:
        seconds: Simulated time of the last call (s); a contact ends it.
    """

    def __init__(self, seed: int, moves: bool, rate: int) -> None:
        task = random_task(seed, count=STANDING if moves else STANDING + MOVING)
        if moves and task.random is not None:
            random = task.random.model_copy(update={"movers": Wanderers(count=MOVING)})
            task = task.model_copy(update={"random": random})
        self._scenario, self._rate = realise(task), rate
        self._world = World(self._scenario.obstacles, self._scenario.arena)
        self.seconds = 0.0

    def __call__(self) -> None:
        episode = Episode(self._world, self._scenario, patience=math.inf, rate=self._rate)
        still = Decision(0.0, 0.0, 0.0, mode="routine")
        while episode.outcome is None and episode.now.time < SIMULATED:
            episode.observe().sense((-0.8, 0.0, 0.8))
            episode.advance(still)
        self.seconds = episode.now.time


def _compare(rounds: int, rate: int) -> list[_LoopTimes]:
    """Time episodes of the default planner, and their bare physics, in turn.

    Args:
        rounds: How often each is timed.
        rate: Decisions a simulated second.

    Returns:
        One for each of ``COUNTS``.
    """
    loops = [_Loop(*_field(count, seed), rate) for count in COUNTS for seed in range(FIELDS)]
    bare = [loop.bare() for loop in loops]
    works = [
        work for loop, (only, _) in zip(loops, bare, strict=True) for work in (loop.whole, only)
    ]
    times = interleaved(works, rounds)
    results = []
    for k in range(len(COUNTS)):
        own = slice(k * FIELDS, (k + 1) * FIELDS)
        simulated = sum(seconds for _, seconds in bare[own])
        whole, only = (
            [sum(of_round) / simulated for of_round in zip(*times[kind::2][own], strict=True)]
            for kind in (0, 1)
        )
        results.append(_LoopTimes(whole, only, [t for loop in loops[own] for t in loop.decisions]))
    return results


def _field(count: int, seed: int) -> tuple[World, Scenario]:
    """Return a world of ``count`` obstacles and its scenario.

    Fewer obstacles are those nearest to the way of the robot out of the same 1000, so that the
    robot meets the same things and drives the same way, whatever the number.
    """
    full = realise(
        Scenario(
            name=f"speed-{count}",
            seed=seed,
            arena=Arena(size=(SIDE, SIDE)),
            start=Start(position=(1.0, 1.0)),
            goal=Goal(position=(9.0, 9.0)),
            random=Random(count=max(COUNTS)),
            limits=Limits(time=SIMULATED),
        )
    )
    nearest = sorted(full.obstacles, key=lambda one: math.dist(one.position, (5.0, 5.0)))
    scenario = full.model_copy(update={"obstacles": tuple(nearest[:count])})
    return World(scenario.obstacles, scenario.arena), scenario
