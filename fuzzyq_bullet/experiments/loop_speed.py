"""How much of an episode is physics: the whole loop against bare ``stepSimulation``."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from unittest import mock

import numpy as np

from fuzzyq_bullet.episode import run_in
from fuzzyq_bullet.physics.engine import TIME_STEP, Contact
from fuzzyq_bullet.physics.world import World
from fuzzyq_bullet.planning import ImprovedFuzzySettings, make_planner
from fuzzyq_bullet.scenario import Arena, Goal, Limits, Random, Scenario, Start, realise

SIMULATED = 20.0
"""Simulated time of one timed episode (s)."""
MOST = 1000
SIDE = math.sqrt(MOST / (125 / 100.0))
"""Side of the arena (m) in which 1000 obstacles are as dense as the paper's 125 in 10 × 10 m."""


@dataclass(frozen=True)
class Loop:
    """One prepared pair of works over the same motion.

    Attributes:
        whole: Runs the episode with sensing, planning, contacts and recording.
        bare: Only steps the physics, with the wheel commands of the same episode.
        simulated: Simulated time of either (s).
    """

    whole: Callable[[], object]
    bare: Callable[[], object]
    simulated: float


def prepare(count: int, seed: int) -> Loop:
    """Build a world of ``count`` obstacles, at most 1000, and return both works in it.

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
            planner=ImprovedFuzzySettings(weights=(1.0, 1.0)),
            random=Random(count=MOST),
            limits=Limits(time=SIMULATED),
        )
    )
    nearest = sorted(full.obstacles, key=lambda one: math.dist(one.position, (5.0, 5.0)))
    scenario = full.model_copy(update={"obstacles": tuple(nearest[:count])})
    world = World(scenario.obstacles, scenario.arena)

    def whole() -> int:
        planner = make_planner(scenario.planner, np.random.default_rng(seed))
        return run_in(world, scenario, planner).physics_steps

    commands, steps = _commands(world, whole)
    robot, api, client = world.robot, world.engine.api, world.engine.client

    def bare() -> None:
        robot.place(*scenario.start.position, scenario.start_heading())
        for step in range(steps):
            if (command := commands.get(step)) is not None:
                robot.command(*command)
            api.stepSimulation(physicsClientId=client)

    return Loop(whole, bare, steps * TIME_STEP)


def _commands(world: World, whole: Callable[[], int]) -> tuple[dict[int, tuple[float, float]], int]:
    """Run the episode once and return its wheel commands by physics step, and how many steps."""
    given: dict[int, tuple[float, float]] = {}
    taken = 0
    advance, command = world.advance, world.robot.command

    def counting(steps: int) -> tuple[int, Contact | None]:
        nonlocal taken
        done = advance(steps)
        taken += done[0]
        return done

    def noting(left: float, right: float) -> None:
        given[taken] = (left, right)
        command(left, right)

    with (
        mock.patch.object(world, "advance", counting),
        mock.patch.object(world.robot, "command", noting),
    ):
        whole()
    return given, taken
