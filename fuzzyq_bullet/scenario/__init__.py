"""What a run is asked to do: models, files, checks, layouts."""

from fuzzyq_bullet.scenario.checks import check, find_conflicts
from fuzzyq_bullet.scenario.expectations import Expect, OutcomeName, register_expectation
from fuzzyq_bullet.scenario.files import (
    bundled_scenarios,
    dump_scenario,
    find_scenario,
    load_scenario,
    parse_scenario,
    save_scenario,
)
from fuzzyq_bullet.scenario.layouts import realise
from fuzzyq_bullet.scenario.models import (
    MAX_OBSTACLES,
    MIN_RADIUS,
    Arena,
    Box,
    Cylinder,
    Drive,
    Goal,
    Limits,
    Obstacle,
    Random,
    Robot,
    Scenario,
    Start,
    scenario_schema,
)
from fuzzyq_bullet.scenario.options import with_options
from fuzzyq_bullet.scenario.random_tasks import random_task

__all__ = [
    "MAX_OBSTACLES",
    "MIN_RADIUS",
    "Arena",
    "Box",
    "Cylinder",
    "Drive",
    "Expect",
    "Goal",
    "Limits",
    "Obstacle",
    "OutcomeName",
    "Random",
    "Robot",
    "Scenario",
    "Start",
    "bundled_scenarios",
    "check",
    "dump_scenario",
    "find_conflicts",
    "find_scenario",
    "load_scenario",
    "parse_scenario",
    "random_task",
    "realise",
    "register_expectation",
    "save_scenario",
    "scenario_schema",
    "with_options",
]
