"""Claims about scenarios that cannot be run though every value is allowed, and JSON Schema."""

from __future__ import annotations

import copy

import jsonschema
import pytest
import yaml
from pydantic import ValidationError

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.planning.registry import DEFAULT_PLANNER, planner_names
from fuzzyq_bullet.platforms import data_folder
from fuzzyq_bullet.robots import FUZZYQ
from fuzzyq_bullet.scenario import (
    Scenario,
    check,
    find_conflicts,
    parse_scenario,
    scenario_schema,
)

BASE = {"name": "s", "start": {"position": [1.0, 5.0]}, "goal": {"position": [9.0, 5.0]}}


def pillar(x, y, radius=0.2):
    return {"shape": "cylinder", "position": [x, y], "radius": radius}


def crate(x, y, sx, sy, yaw=0.0):
    return {"shape": "box", "position": [x, y], "size": [sx, sy], "yaw": yaw}


def conflicts(**rest):
    return find_conflicts(Scenario.model_validate({**BASE, **rest}))


def where(**rest):
    return [loc for loc, _ in conflicts(**rest)]


def test_a_sound_scenario_has_no_conflicts():
    obstacles = [pillar(5, 5), pillar(5.1, 5), crate(0, 2, 3, 0.3), pillar(10.1, 3, 0.3)]
    assert conflicts(obstacles=obstacles, random={"count": 9}) == []


def test_an_obstacle_on_the_start_or_goal_is_named_and_one_just_clear_of_it_is_not():
    assert where(obstacles=[pillar(5, 5), pillar(1.39, 5)]) == [("obstacles", 1)]
    assert where(obstacles=[pillar(1.4, 5)]) == [("obstacles", 0)]  # a touch is a collision
    assert where(obstacles=[pillar(1.41, 5)]) == []
    assert where(obstacles=[pillar(8.7, 5.2)]) == [("obstacles", 0)]
    assert where(obstacles=[crate(9, 5.5, 2.0, 0.58)]) == []
    assert where(obstacles=[crate(9, 5.5, 2.0, 0.62)]) == [("obstacles", 0)]
    (found,) = conflicts(obstacles=[pillar(1.33, 5)])
    assert found[1] == (
        "overlaps the start at (1, 5), which is 0.13 m from it; the robot needs more than 0.2 m: "
        "move it by more than 0.07 m"
    )
    (found,) = conflicts(obstacles=[pillar(9, 5, 0.5)])
    assert "overlaps the goal at (9, 5), which is 0.5 m inside it" in found[1]


@pytest.mark.parametrize("key", ["start", "goal"])
def test_start_and_goal_lie_in_the_arena_and_clear_of_its_walls(key):
    for position in ([-0.1, 5.0], [3.0, 10.1]):
        ((loc, why),) = conflicts(**{key: {"position": position}})
        assert loc == (key, "position")
        assert "is outside the arena, 10 × 10 m" in why
    close = {key: {"position": [3.0, FUZZYQ.radius - 0.01]}}
    assert where(**close) == [(key, "position")]
    assert where(**close, arena={"walls": False}) == []


def test_a_start_within_the_goal_is_no_run():
    assert where(goal={"position": [1.5, 5.0], "radius": 0.5}) == [("start", "position")]
    assert where(goal={"position": [1.5, 5.0], "radius": 0.49}) == []


@pytest.mark.parametrize(
    ("item", "outside"),
    [
        (pillar(10.3, 5, 0.29), True),
        (pillar(10.3, 5, 0.31), False),
        (
            pillar(10.25, 10.25, 0.3),
            True,
        ),  # beyond the corner: nearer to both lines than its radius
        (pillar(10.25, 10.25, 0.36), False),
        (crate(10.3, 5, 0.59, 2), True),
        (crate(10.3, 5, 0.61, 2), False),
        (crate(10.4, 5, 0.6, 0.6, 0.785), False),
        (crate(10.5, 10.5, 1.9, 0.1, -0.785), True),  # its bounding box reaches in, it does not
        (crate(10.5, 10.5, 1.9, 0.1, 0.785), False),
        (crate(10.5, 10.5, 1.35, 0.1, 0.785), True),  # points at the corner and stops short of it
        (crate(5, 5, 40, 0.1), False),
    ],
)
def test_obstacles_wholly_outside_the_walls_are_refused_and_those_that_poke_through_are_not(
    item, outside
):
    rest = {"start": {"position": [1.0, 3.0]}, "goal": {"position": [9.0, 3.0]}}
    found = [("obstacles", 0, "position")] if outside else []
    assert where(obstacles=[item], **rest) == found
    assert where(obstacles=[item], arena={"walls": False}, **rest) == []


def test_random_obstacles_that_cannot_be_are_refused_before_they_are_drawn():
    assert where(random={"count": 1, "radius": 5.1}) == [("random", "radius")]
    assert where(random={"count": 10_000}, obstacles=[pillar(5, 5)]) == [("random", "count")]
    assert where(random={"count": 0, "radius": 5.1}) == []


def test_check_raises_what_is_found_and_counts_what_is_too_much():
    check(Scenario.model_validate(BASE))
    crowd = Scenario.model_validate({**BASE, "obstacles": [pillar(1, 5)] * 14})
    with pytest.raises(UserError) as caught:
        check(crowd)
    assert caught.value.problems[0].startswith("s: obstacles[0]: overlaps the start")
    assert caught.value.problems[10:] == ("s: and 4 more",)


def test_conflicts_in_a_file_have_lines():
    text = yaml.safe_dump({**BASE, "obstacles": [pillar(5, 5), pillar(1, 5)]}, sort_keys=False)
    with pytest.raises(UserError) as caught:
        parse_scenario(text, "x.yaml")
    (line,) = caught.value.problems
    number = 1 + text[: text.rindex("shape:")].count("\n")
    assert line.startswith(f"x.yaml:{number}: obstacles[1]: overlaps the start at (1, 5)")


# JSON Schema ------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def validator():
    schema = scenario_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def test_the_schema_says_which_dialect_it_is_and_is_made_anew_each_time():
    schema = scenario_schema()
    assert schema["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    assert schema["title"] == "Scenario"
    before = copy.deepcopy(schema)
    schema["properties"].clear()
    assert scenario_schema() == before


@pytest.mark.parametrize("path", sorted(data_folder("scenarios").glob("*.yaml")), ids=str)
def test_every_bundled_scenario_fits_the_schema(validator, path):
    validator.validate(yaml.safe_load(path.read_text()))


@pytest.mark.parametrize(
    "rest",
    [
        {},
        {"planner": DEFAULT_PLANNER},
        {"planner": {"name": "fuzzy", "weights": [1, 0.5]}},
        {"planner": {"turn_unit": 0.9}},
        *({"planner": {"name": name}} for name in planner_names()),
        {"random": None},
        {"start": {"position": [1, 5], "heading": None}},
    ],
)
def test_what_the_models_accept_fits_the_schema(validator, rest):
    Scenario.model_validate({**BASE, **rest})
    validator.validate({**BASE, **rest})


@pytest.mark.parametrize(
    "rest",
    [
        {"zzz": 1},
        {"name": "a/b"},
        {"goal": {}},
        {"seed": 1.5},
        {"seed": True},
        {"drive": "wheel"},
        {"obstacles": [{"shape": "ring", "position": [1, 1]}]},
        {"obstacles": [{"shape": "cylinder", "position": [1, 1]}]},
        {"obstacles": [pillar(3, 3, 0.01)]},
        {"obstacles": [pillar(3, "3")]},
        {"obstacles": [{**pillar(3, 3), "position": [3]}]},
        {"obstacles": [{**pillar(3, 3), "position": [3, 3, 3]}]},
        {"planner": "no-such"},
        {"planner": {"name": "no-such"}},
        {"planner": {"no_such": 1}},
        {"planner": {"name": "fuzzy", "weights": [0, 1]}},
        {"planner": {"weights": [1, 1]}},
    ],
)
def test_what_the_models_refuse_does_not_fit_the_schema(validator, rest):
    with pytest.raises(ValidationError):
        Scenario.model_validate({**BASE, **rest})
    with pytest.raises(jsonschema.ValidationError):
        validator.validate({**BASE, **rest})
