"""What ways out cost: a simulated second among many obstacles against few, and the oracle."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from fuzzyq_bullet.episode import run
from fuzzyq_bullet.experiments.timing import interleaved
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.ground_truth.configuration_space import ConfigurationSpace
from fuzzyq_bullet.ground_truth.search import shortest_route
from fuzzyq_bullet.planning import ImprovedFuzzySettings
from fuzzyq_bullet.scenario import Limits, Scenario, random_task, realise

SEEDS = range(2, 6)
"""Fields of one count that are driven through in turn; among 125 obstacles all need ways out."""
SIMULATED = 25.0
"""Longest that one of them is driven (s)."""


@dataclass(frozen=True)
class Costs:
    """Processor times, one a round.

    Attributes:
        few: Of a simulated second among 25 obstacles (s).
        many: The same among 125.
        escaping: Share of the decisions among 125 obstacles that were breakout or following.
        oracle: Of the shortest path among 125 obstacles, nothing remembered (s); the slowest of
            the fields in each round.
    """

    few: list[float]
    many: list[float]
    escaping: float
    oracle: list[float]


def compare(rounds: int) -> Costs:
    """Time whole episodes, from building the world to the record, in turn."""
    few, many = ([_field(count, seed) for seed in SEEDS] for count in (25, 125))
    simulated = {}
    for name, fields in (("few", few), ("many", many)):
        runs = [run(field) for field in fields]
        simulated[name] = sum(float(one.ticks.time[-1]) for one in runs)
    modes = [mode for one in runs for mode in one.decisions.mode.tolist()]
    oracle = [_asking(field) for field in many]
    times = interleaved([_driving(few), _driving(many), *oracle], rounds)
    return Costs(
        few=[taken / simulated["few"] for taken in times[0]],
        many=[taken / simulated["many"] for taken in times[1]],
        escaping=sum(mode > 0 for mode in modes) / len(modes),
        oracle=[max(one) for one in zip(*times[2:], strict=True)],
    )


def _field(count: int, seed: int) -> Scenario:
    task = random_task(seed, count=count)
    return realise(
        task.model_copy(
            update={
                "planner": ImprovedFuzzySettings(weights=(1.0, 1.0)),
                "limits": Limits(time=SIMULATED),
            }
        )
    )


def _driving(fields: list[Scenario]) -> Callable[[], object]:
    def work() -> None:
        for field in fields:
            run(field)

    return work


def _asking(field: Scenario) -> Callable[[], object]:
    def work() -> object:
        world = ConfigurationSpace(Field.of(field.obstacles, field.arena), field.robot.radius)
        goal = field.goal
        return shortest_route(world, field.start.position, goal.position, goal.radius)

    return work
