"""What the tests of the peers share."""

from __future__ import annotations

import dataclasses

from fuzzyq_bullet import Scenario, load_scenario, run
from fuzzyq_bullet.planning import MODES, Motion
from tests.helpers.exploring import observe

MOTION = Motion(
    max_speed=0.6,
    max_turn_rate=2.0,
    acceleration=1.0,
    turn_acceleration=6.0,
    period=0.05,
    radius=0.2,
    margin=0.02,
)


def moving(field, here, *, goal, heading=0.0, speed=0.0, turn_rate=0.0, motion=MOTION, time=0.0):
    """What a robot on wheels observes with exact rays."""
    return dataclasses.replace(
        observe(field, here, goal=goal, time=time),
        heading=heading,
        speed=speed,
        turn_rate=turn_rate,
        motion=motion,
    )


def drive(planner, obstacles=(), **keys):
    """Run a planner from (1, 5) to (9, 5), or as the keys of the scenario say."""
    told = {
        "name": "peer",
        "start": {"position": [1.0, 5.0]},
        "goal": {"position": [9.0, 5.0]},
        "obstacles": list(obstacles),
        "planner": planner,
        "limits": {"time": 90.0},
        **keys,
    }
    return run(Scenario.model_validate(told))


def drive_bundled(name, planner, **keys):
    """Run a planner in a bundled scenario."""
    scenario = load_scenario(name)
    told = {**scenario.model_dump(exclude_unset=True), "planner": planner, **keys}
    return run(Scenario.model_validate(told))


def modes_of(record):
    """The parts of the planner that decided, one after the other."""
    return [MODES[number] for number in record.decisions.mode]
