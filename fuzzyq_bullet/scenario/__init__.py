"""What a run is asked to do: models, files, checks, layouts."""

from fuzzyq_bullet.quantities import MAX_OBSTACLES, MIN_RADIUS
from fuzzyq_bullet.scenario.checks import check, find_conflicts
from fuzzyq_bullet.scenario.expectations import Expect, OutcomeName, register_expectation
from fuzzyq_bullet.scenario.files import (
    bundled_scenarios,
    dump_scenario,
    load_scenario,
    parse_scenario,
    save_scenario,
)
from fuzzyq_bullet.scenario.layouts import Random, realise
from fuzzyq_bullet.scenario.models import Drive, Limits, Scenario, scenario_schema
from fuzzyq_bullet.scenario.options import cellular_task, random_task, with_options
from fuzzyq_bullet.scenario.places import Arena, Goal, Start, Via
from fuzzyq_bullet.scenario.robot import Robot
from fuzzyq_bullet.scenario.sources import find_scenario
from fuzzyq_bullet.shapes import Box, Cylinder, Obstacle

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
    "Via",
    "bundled_scenarios",
    "cellular_task",
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
