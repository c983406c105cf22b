"""``--planner``, ``--seed`` and ``--drive``: what they change in a scenario and what not."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from fuzzyq_bullet import Scenario, Trajectory, with_options
from fuzzyq_bullet.planning import registry

if TYPE_CHECKING:
    from tests.helpers.commands import Call

SET: dict[str, Any] = {
    "weights": (1.0, 0.8),
    "line_angle": 0.6,
    "turn_unit": 0.9,
    "distance": "least",
    "rules": "printed",
    "samples": 5,
}


def asked(**planner: Any) -> Scenario:
    places = {"start": {"position": [1.0, 1.0]}, "goal": {"position": [9.0, 9.0]}}
    return Scenario.model_validate({"name": "s", **places, "planner": planner})


@pytest.mark.parametrize(
    ("before", "after"), [("fuzzy", "improved-fuzzy"), ("improved-fuzzy", "fuzzy")]
)
def test_another_planner_keeps_what_the_scenario_sets(before: str, after: str) -> None:
    planner = with_options(asked(name=before, **SET), planner=after).planner
    assert planner.model_dump(include=set(SET)) == SET
    assert (planner.name, type(planner)) == (after, registry.settings_for(after))


def test_what_the_other_planner_does_not_know_is_left_out_and_what_was_not_set_is_its_own() -> None:
    planner = with_options(
        asked(name="improved-fuzzy", weights=[1.0, 1.0], guard=False), planner="fuzzy"
    ).planner
    default = registry.settings_for("fuzzy").model_validate({"name": "fuzzy"})
    assert planner == default.model_copy(update={"weights": (1.0, 1.0)})
    back = with_options(asked(name="fuzzy", samples=7), planner="improved-fuzzy").planner
    expected = {"name": "improved-fuzzy", "samples": 7}
    assert back == registry.settings_for("improved-fuzzy").model_validate(expected)


def test_the_same_planner_keeps_everything() -> None:
    scenario = asked(name="improved-fuzzy", guard=False, **SET)
    assert with_options(scenario, planner="improved-fuzzy") == scenario


NARROW = """
import math
from typing import Literal
from fuzzyq_bullet import PlannerSettings, register_planner

class Narrow(PlannerSettings):
    name: Literal["narrow"] = "narrow"
    line_angle: Literal[1, 2] = 1
    turn_unit: float = math.pi

register_planner("narrow", Narrow, lambda settings, rng: None)
"""


def test_what_the_other_planner_refuses_is_told() -> None:
    # In a process of its own: what is registered stays.
    code = f"""{NARROW}
from tests.cli.test_options import SET, asked
from fuzzyq_bullet import UserError, with_options

try:
    with_options(asked(name="improved-fuzzy", **SET), planner="narrow")
except UserError as error:
    (line,) = error.problems
    print(line)
fits = with_options(asked(turn_unit=0.5, samples=5), planner="narrow").planner
print(fits == Narrow(turn_unit=0.5))
"""
    root = Path(__file__).parents[2]
    done = subprocess.run([sys.executable, "-c", code], cwd=root, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    line, fits = done.stdout.splitlines()
    assert line.startswith("planner: 'narrow' does not accept the scenario's planner.line_angle: ")
    assert fits == "True"


def test_planners_are_compared_at_the_same_speed(fuzzyq: Call, tmp_path: Path) -> None:
    options = ("--planner", "fuzzy", "--drive", "kinematic", "--no-video", "--out", tmp_path)
    done = fuzzyq("run", "figure-12a", *options)
    assert done.returncode in (0, 1), done.stderr
    record = Trajectory.load(tmp_path / "figure-12a-fuzzy-kinematic.npz")
    assert record.scenario.planner.name == "fuzzy"
    assert record.scenario.planner.model_dump()["weights"] == (1.0, 1.0)
