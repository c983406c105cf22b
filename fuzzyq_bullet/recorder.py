"""From what a drive and a planner left behind to the arrays of a trajectory."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import chain
from typing import Any

import numpy as np

from fuzzyq_bullet.drives import Driver
from fuzzyq_bullet.drives.base import Tick
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.planning import MODES, Decision
from fuzzyq_bullet.scenario.models import Scenario
from fuzzyq_bullet.trajectory import Decisions, Floats, Outcome, Ticks, Trajectory
from fuzzyq_bullet.version import __version__


def recorded(
    scenario: Scenario,
    field: Field,
    driver: Driver,
    decisions: Sequence[tuple[int, Decision]],
    outcome: Outcome,
) -> Trajectory:
    """Return the trajectory of a finished episode.

    Args:
        scenario: The scenario as it ran, every obstacle listed.
        field: Its obstacles and walls.
        driver: The drive, with its ticks.
        decisions: Each decision with the index of the tick it was taken at.
        outcome: How the episode ended.
    """
    ticks = _array(driver.ticks, len(driver.ticks), len(Tick._fields))
    taken = [decision for _, decision in decisions]

    def column(name: str, *shape: int) -> Floats:
        values = _array([getattr(decision, name) for decision in taken], len(taken), *shape)
        # What a planner cannot put into a number is not explained; only a reach may be endless.
        return values if name == "reach" else np.where(np.isinf(values), np.nan, values)

    return Trajectory(
        scenario=scenario,
        outcome=outcome,
        physics_steps=driver.steps,
        collision=driver.collision,
        ticks=Ticks(
            time=ticks[:, 0],
            position=ticks[:, 1:3],
            heading=ticks[:, 3],
            speed=ticks[:, 4],
            turn_rate=ticks[:, 5],
            wheel_speeds=ticks[:, 6:8],
            clearance=_clearance(field, ticks[:, 1:3], scenario.drive) - scenario.robot.radius,
        ),
        decisions=Decisions(
            tick=np.array([tick for tick, _ in decisions], dtype=np.int64),
            heading=column("heading"),
            step=column("step"),
            reach=column("reach"),
            mode=np.array([MODES.index(decision.mode) for decision in taken], dtype=np.int64),
            lines=column("lines", 3),
            lengths=column("lengths", 3),
            distance=column("distance"),
            difference=column("difference"),
            near=column("near", 5),
            side=column("side", 5),
            rules=column("rules", 5, 5),
            turn=column("turn"),
            stride=column("stride"),
            weights=column("weights", 2),
            breakout_at=column("breakout_at"),
            guard=column("guard"),
            target=column("target", 2),
        ),
        version=__version__,
    )


def _clearance(field: Field, positions: Floats, drive: str) -> Floats:
    """Return how far everything is from the robot's centre (m), shape (T,).

    The point robot's moves may be long: what counts is the least on the way to each tick.
    """
    if drive == "kinematic":
        return field.clearance_on_ways(positions[[0, *range(len(positions) - 1)]], positions)[0]
    return field.clearance(positions)


def _array(rows: Iterable[Any], *shape: int) -> Floats:
    """Return numbers in nested sequences as an array; numpy alone takes five times as long."""
    for _ in shape[1:]:
        rows = chain.from_iterable(rows)
    return np.fromiter(rows, np.float64).reshape(shape)
