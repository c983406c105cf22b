"""What the page shows of a record: its numbers, rounded and thinned out, and the film's words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from fuzzyq_bullet.fuzzy import definition_of
from fuzzyq_bullet.planning.controllers import controller_of
from fuzzyq_bullet.planning.decision import MODES
from fuzzyq_bullet.recording.moving import headings_of
from fuzzyq_bullet.recording.rules_turn import asked, has_rules
from fuzzyq_bullet.video.asked import asks
from fuzzyq_bullet.video.captions import outcome_lines, planner_name, routine_name
from fuzzyq_bullet.video.decision_hold import DecisionHold
from fuzzyq_bullet.video.explanation import aim_name, off_aim, reason
from fuzzyq_bullet.video.panels.rules import rule_weights
from fuzzyq_bullet.video.scene.viewpoint import extent_of
from fuzzyq_bullet.video.timeline import NO_DECISION, Timeline, sensor_range

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fuzzyq_bullet.recording.trajectory import Trajectory

MOST_TICKS = 6000
"""More are thinned out: at 20 a second those of five minutes are kept."""
MOST_DECISIONS = 3000
"""More are thinned out; those that the film would show stay longest."""

_DIGITS = {"heading": 4, "lines": 4, "near": 3, "side": 3, "rules": 3}
"""Decimals of the fields of a decision, where they are not three."""
_FIELDS = (
    "heading", "step", "mode", "lines", "lengths", "distance", "difference",
    "near", "side", "rules", "turn", "stride", "weights", "breakout_at", "target", "aim",
)  # fmt: skip


def run_data(trajectory: Trajectory) -> dict[str, Any]:
    """Return one run for the page, ready for JSON; what is not finite is None."""
    scenario = trajectory.scenario
    title, figures = outcome_lines(trajectory)
    asked = controller_of(scenario.planner) if has_rules(trajectory.decisions) else None
    controller = None if asked is None else definition_of(asked).model_dump(mode="json")
    model = scenario.robot.spec
    return {
        "name": scenario.name,
        "planner": planner_name(trajectory),
        "drive": scenario.drive,
        "seed": scenario.seed,
        "routine": routine_name(trajectory),
        "outcome": trajectory.outcome,
        "end": {"title": title, "figures": figures},
        "field": _field(trajectory),
        "robot": {
            "radius": scenario.robot.radius,
            "footprint": None if model.is_disc else [list(point) for point in model.footprint],
            "range": _number(sensor_range(trajectory)),
            "turn_unit": _number(float(getattr(scenario.planner, "turn_unit", math.nan)), 6),
        },
        "contact": None if trajectory.collision is None else list(trajectory.collision.point),
        "controller": controller,
        "rule_weights": None if controller is None else _numbers(rule_weights(trajectory), 3),
        "ticks": _ticks(trajectory),
        "movers": _movers(trajectory),
        **_decisions(trajectory),
    }


def _field(trajectory: Trajectory) -> dict[str, Any]:
    """Return what stands there; an obstacle is the polygon of its corners, grown by a radius."""
    scenario = trajectory.scenario
    solids = (obstacle.corners() for obstacle in scenario.standing)
    return {
        "bounds": list(scenario.arena.bounds),
        "walls": scenario.arena.walls,
        "extent": [_number(edge) for edge in extent_of(trajectory)],
        "start": list(scenario.start.position),
        "goal": {
            "position": list(scenario.goal.position),
            "radius": scenario.goal.radius,
            "heading": scenario.goal.heading,
        },
        "via": [
            {"position": list(one.position), "radius": one.radius, "passed": passed}
            for one, passed in zip(scenario.via, _passed(trajectory), strict=True)
        ],
        "obstacles": [
            {"corners": _numbers(points, 3), "radius": _number(radius)} for points, radius in solids
        ],
    }


def _passed(trajectory: Trajectory) -> list[float | None]:
    """Return when each via point was passed (s); None for those that never were."""
    first = np.searchsorted(trajectory.via_passed, np.arange(1, len(trajectory.scenario.via) + 1))
    times = trajectory.ticks.time
    return [_number(times[k]) if k < len(times) else None for k in first.tolist()]


def _ticks(trajectory: Trajectory) -> dict[str, Any]:
    ticks = trajectory.ticks
    kept = _kept_ticks(len(ticks.time))
    return {
        "time": _numbers(ticks.time[kept], 3),
        "x": _numbers(ticks.position[kept, 0], 3),
        "y": _numbers(ticks.position[kept, 1], 3),
        "heading": _numbers(np.unwrap(ticks.heading)[kept], 3),
        "speed": _numbers(ticks.speed[kept], 3),
        "clearance": _numbers(ticks.clearance[kept], 3),
    }


def _kept_ticks(count: int) -> NDArray[np.int64]:
    """Return the indices of the ticks that the page gets."""
    return np.unique(np.linspace(0, count - 1, min(count, MOST_TICKS)).round().astype(np.int64))


def _movers(trajectory: Trajectory) -> list[dict[str, Any]]:
    """Return each moving obstacle about its centre, and where it is at the ticks."""
    kept, headings = _kept_ticks(len(trajectory.ticks.time)), headings_of(trajectory)
    told = []
    for k, index in enumerate(trajectory.scenario.movers if trajectory.movers.size else ()):
        shape = trajectory.scenario.obstacles[index]
        points, radius = shape.corners()
        x, y, turn = trajectory.movers[kept, k].T
        told.append(
            {
                "corners": _numbers(points - shape.position, 3),
                "radius": _number(radius),
                "size": _number(min(shape.extent(), shape.thickness())),
                "x": _numbers(x, 3),
                "y": _numbers(y, 3),
                "turn": _numbers(np.unwrap(turn), 3),
                "heading": _numbers(headings[kept, k], 3),
            }
        )
    return told


def _decisions(trajectory: Trajectory) -> dict[str, Any]:
    """Return the decisions, which of them is held when, their sentences, and the events."""
    all_times = trajectory.ticks.time[trajectory.decisions.tick]
    held = _held(trajectory, all_times)
    kept = _kept(len(all_times), held)
    place = {index: number for number, index in enumerate(kept)}
    said: dict[str, int] = {}
    sentences = [said.setdefault(reason(trajectory, k), len(said)) for k in kept]
    decisions = trajectory.decisions
    table: dict[str, Any] = {"time": _numbers(all_times[kept], 3)}
    for name in _FIELDS:
        array = getattr(decisions, name)[kept]
        flat = array if array.ndim == 1 else array.reshape(len(kept), -1)
        table[name] = _numbers(flat, _DIGITS.get(name, 3))
    table["asks"] = [[*first, *second] for first, second in (asks(trajectory, k) for k in kept)]
    table["asked"] = [int(one) for one in asked(decisions)[kept]]
    table["off_aim"] = [_number(off_aim(trajectory, k), 4) for k in kept]
    table["aims_at"] = [aim_name(trajectory, k) for k in kept]
    table["sentence"] = sentences
    return {
        "decisions": table,
        "sentences": list(said),
        "waiting": reason(trajectory, NO_DECISION),
        "held": [[_number(time), place[index]] for time, index in held if index in place],
        "events": _events(trajectory, all_times),
    }


def _held(trajectory: Trajectory, times: NDArray[np.float64]) -> list[tuple[float, int]]:
    """Return from when on the film would show which decision: each long enough to be read."""
    hold, timeline = DecisionHold(trajectory), Timeline(trajectory)
    found: list[tuple[float, int]] = []
    for time in times.tolist():
        index = hold.at(timeline.at(time))
        if index != NO_DECISION and (not found or found[-1][1] != index):
            found.append((time, index))
    return found


def _kept(count: int, held: list[tuple[float, int]]) -> list[int]:
    """Return the indices of the decisions that the page gets, in their order."""
    if count <= MOST_DECISIONS:
        return list(range(count))
    shown = [index for _, index in held]
    if len(shown) > MOST_DECISIONS:
        shown = shown[:: -(-len(shown) // MOST_DECISIONS)]
    room = MOST_DECISIONS - len(shown)
    others = np.linspace(0, count - 1, max(room, 1)).round().astype(int).tolist()
    return sorted({*shown, *others})


def _events(trajectory: Trajectory, times: NDArray[np.float64]) -> list[dict[str, Any]]:
    """Return what the scrubber marks: where ways out begin and end, and how the run ends."""
    found: list[dict[str, Any]] = []
    names = [MODES[number] for number in trajectory.decisions.mode.tolist()]
    before = "routine"
    for k, (time, mode) in enumerate(zip(times.tolist(), names, strict=True)):
        if before != "breakout" == mode or (before == "routine" and mode == "following"):
            words = reason(trajectory, k)
            found.append({"time": _number(time), "kind": "breakout", "words": words})
        elif before != "routine" and mode == "routine":
            words = "Out of the trap: goes on"
            found.append({"time": _number(time), "kind": "routine", "words": words})
        before = mode
    kind = "contact" if trajectory.collision is not None else trajectory.outcome
    end = _number(float(trajectory.ticks.time[-1]))
    found.append({"time": end, "kind": kind, "words": outcome_lines(trajectory)[0]})
    return found


def _number(value: float, digits: int = 3) -> float | None:
    """Return a number with so many decimals; whole ones short, and None for what is not finite."""
    if not math.isfinite(value):
        return None
    rounded = round(float(value), digits)
    return int(rounded) if rounded == int(rounded) else rounded


def _numbers(array: NDArray[Any], digits: int) -> Any:
    """Return an array as lists of such numbers."""
    if array.ndim == 1:
        return [_number(one, digits) for one in array.tolist()]
    return [_numbers(row, digits) for row in array]
