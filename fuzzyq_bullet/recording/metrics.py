"""Figures of one run, and its collision in words, from its record.

The shortest path alone is the truth about its world.
"""

from __future__ import annotations

import math
from typing import Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, SerializerFunctionWrapHandler, model_serializer

from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.ground_truth import feasible, shortest_path, spl
from fuzzyq_bullet.ground_truth.open_space import has_open_space
from fuzzyq_bullet.planning import MODES
from fuzzyq_bullet.recording.fault import at_fault, speeds_in_words
from fuzzyq_bullet.recording.rules_turn import share_turned
from fuzzyq_bullet.recording.trajectory import Outcome, Trajectory
from fuzzyq_bullet.scenario import Scenario
from fuzzyq_bullet.wording import plain

MOST_ROUND = 1500
"""Obstacles up to which the shortest path is looked for.

A box counts as its four corners, a polygon as those of its corners that point outwards.

The oracle takes about 0.03 s for 125 cylinders, 1 s for 1000, 2 s for 1500 (or 375 boxes), 8 s for
3000 and 100 s for 10 000: beyond this a person would wait longer for it than for the run.
"""


class ModeCounts(BaseModel):
    """Decisions taken in each mode."""

    model_config = ConfigDict(frozen=True)

    routine: int
    breakout: int
    following: int


class Result(BaseModel):
    """What a run came to: the contents of ``NAME.json`` and of ``--json``.

    Attributes:
        scenario: Name of the scenario.
        planner: Name of the planner.
        drive: ``wheels`` or ``kinematic``.
        seed: Seed of the run.
        outcome: ``goal``, ``collision``, ``timeout`` or ``stuck``.
        steps: Steps of the simulation: physics steps with wheels, moves (Eq. 17) without.
        decisions: Decisions of the planner.
        time_s: Simulated time (s).
        path_length_m: Length of the driven path (m).
        shortest_path_m: Length of the robot's shortest path to the goal disc (m), through the discs
            of the via points (``ground_truth.tour``); null where there is no way at all, and where
            the obstacles have more than 1500 corners and cylinders: it is not looked for there.
        spl: Success weighted by path length, 0 to 1: shortest over driven path, 0 for a run that
            did not reach the goal; null where ``shortest_path_m`` is.
        min_clearance_m: Least distance to anything (m), negative for an overlap; null when there
            is nothing.
        collisions: Contacts: 0, or 1, since the first one ends the run.
        turning_rad: Sum of all changes of direction, left and right (rad).
        modes: Decisions in each mode.
        mean_jerk: Mean of |jerk|, the change of the acceleration from tick to tick (m/s³); null in
            the kinematic drive, which has no speed, and for less than four ticks.
        rules_turn: Share of the decisions with something within the range of the sensor in which
            the fuzzy rules turn the robot off its aim by more than 3° (ω2·N_a·A_p), 0 to 1; null
            for a planner without rules, and where nothing ever came so near.
        digest: Hash of the exact trajectory.
        version: Version of fuzzyq_bullet.
        no_shortest_path: Why ``shortest_path_m`` is null; not there if it is a length.
        via_passed: Via points that were passed; not there in a scenario without any.
        at_fault: Whether the robot touched something that stands still, or moved faster than
            0.05 m/s when it touched something that moves, or within 0.3 s before; not there if it
            touched nothing.
    """

    model_config = ConfigDict(frozen=True)

    scenario: str
    planner: str
    drive: Literal["wheels", "kinematic"]
    seed: int
    outcome: Outcome
    steps: int
    decisions: int
    time_s: float
    path_length_m: float
    shortest_path_m: float | None
    spl: float | None
    min_clearance_m: float | None
    collisions: int
    turning_rad: float
    mean_jerk: float | None = None
    modes: ModeCounts
    rules_turn: float | None = None
    digest: str
    version: str
    no_shortest_path: str | None = None
    via_passed: int | None = None
    at_fault: bool | None = None

    @model_serializer(mode="wrap")
    def _without_via(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Leave out what does not apply: the last three fields."""
        told: dict[str, Any] = handler(self)
        for name in ("no_shortest_path", "via_passed", "at_fault"):
            if getattr(self, name) is None:
                told.pop(name, None)
        return told

    def to_dict(self) -> dict[str, str | int | float | None]:
        """Return the result as a flat row: ``pandas.DataFrame([r.to_dict() for r in results])``.

        The keys are the names of the fields above, in their order; ``modes`` becomes
        ``modes_routine``, ``modes_breakout`` and ``modes_following``. What is null is None.
        """
        row: dict[str, str | int | float | None] = {}
        for name, value in self:
            parts = value if isinstance(value, BaseModel) else None
            row |= {name: value} if parts is None else {f"{name}_{key}": n for key, n in parts}
        return row


def result_of(trajectory: Trajectory) -> Result:
    """Return the figures of a run."""
    ticks, scenario = trajectory.ticks, trajectory.scenario
    moves = np.diff(ticks.position, axis=0)
    turns = np.remainder(np.diff(ticks.heading) + np.pi, 2 * np.pi) - np.pi
    clearance = float(ticks.clearance.min())
    counts = np.bincount(trajectory.decisions.mode, minlength=len(MODES))
    driven = float(np.hypot(*moves.T).sum())
    shortest = shortest_length(scenario)
    turned, jerk = share_turned(trajectory), _mean_jerk(trajectory)
    weighted = None if shortest is None else spl(trajectory.outcome == "goal", shortest, driven)
    return Result(
        scenario=scenario.name,
        planner=scenario.planner.name,
        drive=scenario.drive,
        seed=scenario.seed,
        outcome=trajectory.outcome,
        steps=trajectory.physics_steps,
        decisions=trajectory.decisions.tick.size,
        time_s=round(float(ticks.time[-1]), 6),
        path_length_m=round(driven, 6),
        shortest_path_m=None if shortest is None else round(shortest, 6),
        spl=None if weighted is None else round(weighted, 6),
        min_clearance_m=round(clearance, 6) + 0.0 if math.isfinite(clearance) else None,
        collisions=int(trajectory.collision is not None),
        turning_rad=round(float(np.abs(turns).sum()), 6),
        mean_jerk=None if jerk is None else round(jerk, 6),
        modes=ModeCounts(**dict(zip(MODES, counts.tolist(), strict=True))),
        rules_turn=None if turned is None else round(turned, 6),
        digest=trajectory.digest(),
        version=trajectory.version,
        no_shortest_path=_why_none(scenario) if shortest is None else None,
        via_passed=int(trajectory.via_passed[-1]) if scenario.via else None,
        at_fault=at_fault(trajectory),
    )


def has_way(scenario: Scenario) -> bool:
    """Return whether there is any way to the goal.

    Exactly; among more than ``MOST_ROUND`` obstacles, to about 0.1 mm.

    Args:
        scenario: A realised scenario.
    """
    return has_open_space(scenario) if _is_crowded(scenario) else feasible(scenario)


def collision_text(trajectory: Trajectory, listed: int) -> str:
    """Say what the robot touched, where and when; nothing if it touched nothing.

    Args:
        trajectory: The record of the run.
        listed: How many of its obstacles, the first ones, are in the scenario file.
    """
    collision = trajectory.collision
    if collision is None:
        return ""
    what = name_of(trajectory.scenario, collision.obstacle, listed)
    told = touch_in_words(what, collision.point, collision.time)
    speeds = speeds_in_words(trajectory)
    return f"{told}; {speeds}" if speeds else told


def name_of(scenario: Scenario, index: int, listed: int) -> str:
    """Return what an obstacle is called.

    Args:
        scenario: A realised scenario.
        index: Which of its obstacles; −1 for a wall.
        listed: How many of them, the first ones, are in the scenario file.
    """
    if index < 0:
        return "a wall"
    drawn = "" if index < listed else " (drawn)"
    return f"the {scenario.obstacles[index].shape} obstacles[{index}]{drawn}"


def touch_in_words(what: str, point: tuple[float, float], time: float, place: str = "") -> str:
    """Say what was touched, where and when.

    Args:
        what: Its name.
        point: Where the two touched (m).
        time: When (s).
        place: Where the file has it.
    """
    x, y = (plain(value, 2) for value in point)
    noted = f" ({place})" if place else ""
    return f"touched {what}{noted} at ({x}, {y}) after {time:.2f} s"


def _mean_jerk(trajectory: Trajectory) -> float | None:
    """Return the mean of |jerk| (m/s³) over all ticks but the last, which may be a short one."""
    ticks = trajectory.ticks
    if trajectory.scenario.drive != "wheels" or ticks.time.size < 4:
        return None
    period = ticks.time[1] - ticks.time[0]
    return float(np.abs(np.diff(ticks.speed[:-1], 2)).mean() / period**2)


def _why_none(scenario: Scenario) -> str:
    """Return why there is no length of a shortest path."""
    if _is_crowded(scenario):
        return f"not looked for among more than {MOST_ROUND} corners and cylinders"
    return "there is no way"


def _is_crowded(scenario: Scenario) -> bool:
    return len(Field.of(scenario.standing).discs) > MOST_ROUND


def shortest_length(scenario: Scenario) -> float | None:
    """Return the length of the shortest path (m); None if there is none, or too much in the way.

    Args:
        scenario: A realised scenario.
    """
    if _is_crowded(scenario):
        return None
    route = shortest_path(scenario)
    return None if route is None else route.length
