"""Claims about reading scenario files: every mistake has a line, a key and a remedy; none hangs."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.planning.registry import DEFAULT_PLANNER, planner_names, settings_for
from fuzzyq_bullet.planning.settings import PlannerSettings
from fuzzyq_bullet.scenario import (
    Scenario,
    bundled_scenarios,
    dump_scenario,
    load_scenario,
    parse_scenario,
    realise,
    save_scenario,
)

GOOD = """\
name: good
start: {position: [1.0, 5.0]}
goal: {position: [9.0, 5.0]}
"""


def problems(text: str) -> list[str]:
    with pytest.raises(UserError) as caught:
        parse_scenario(text, "x.yaml")
    for line in caught.value.problems:
        assert "\n" not in line
        assert "pydantic" not in line
        assert line.startswith("x.yaml")
    return list(caught.value.problems)


def only(text: str) -> str:
    (line,) = problems(text)
    return line


def test_the_least_scenario_is_read_with_defaults():
    scenario = parse_scenario(GOOD)
    assert scenario.goal.radius == 0.2
    assert scenario.arena.size == (10.0, 10.0)
    assert scenario.planner.name == DEFAULT_PLANNER


@pytest.mark.parametrize(
    ("added", "line"),
    [
        ("obstacles:\n  - {shape: cylinder, position: [4, 4], radius: -1}",
         "x.yaml:5: obstacles[0].radius: must be at least 0.02, got -1"),
        ("obstacles:\n  - shape: cylinder\n    position: [4, 4]\n    radius: abc",
         "x.yaml:7: obstacles[0].radius: expected a number, got 'abc'"),
        ("obstacles:\n  - {shape: cylinder, position: [4, 4]}",
         "x.yaml:5: obstacles[0].radius: is required"),
        ("obstacles:\n  - {shape: ring, position: [4, 4]}",
         "x.yaml:5: obstacles[0].shape: no shape 'ring'; allowed: cylinder, box, polygon"),
        ("obstacles:\n\n  - {position: [4, 4]}",
         "x.yaml:6: obstacles[0].shape: is required; allowed: cylinder, box, polygon"),
        ("obstacles:\n  - {shape: box, position: [4, 4], size: [1], yaw: 0}",
         "x.yaml:5: obstacles[0].size: needs 2 values, got [1]"),
        ("obstacles:\n  - {shape: box, position: [4, 4, 4], size: [1, 1]}",
         "x.yaml:5: obstacles[0].position: must have at most 2 values, got 3"),
        ("obstacles:\n  - {shape: box, position: [4, [5]], size: [1, 1]}",
         "x.yaml:5: obstacles[0].position[1]: expected a number, got [5]"),
        ("obstacles: 5", "x.yaml:4: obstacles: expected a list, got 5"),
        ("obstacles: [5]", "x.yaml:4: obstacles[0]: expected a mapping (key: value), got 5"),
        ("arena: {size: [.nan, 10.0]}", "x.yaml:4: arena.size[0]: must be finite, got nan"),
        ("arena: {size: [10.0, -.inf]}", "x.yaml:4: arena.size[1]: must be finite, got -inf"),
        ("arena: {size: [10.0, 0]}", "x.yaml:4: arena.size[1]: must be more than 0, got 0"),
        ("arena: {walls: yes}", "x.yaml:4: arena.walls: expected true or false, got 'yes'"),
        ("arena: [9, 9]", "x.yaml:4: arena: expected a mapping (key: value), got [9, 9]; "
         "write {size: [9, 9]}"),
        ("via: [[5, 2]]", "x.yaml:4: via[0]: expected a mapping (key: value), got [5, 2]; "
         "write {position: [5, 2]}"),
        ("robot: jackal", "x.yaml:4: robot: expected a mapping (key: value), got 'jackal'; "
         "write {model: jackal}"),
        ("arena: [a, b]", "x.yaml:4: arena: expected a mapping (key: value), got ['a', 'b']"),
        ("arena:", "x.yaml:4: arena: expected a mapping (key: value), got nothing"),
        ("seed: 1.5", "x.yaml:4: seed: expected a whole number, got 1.5"),
        ("seed: true", "x.yaml:4: seed: expected a whole number, got true"),
        ("seed: -1", "x.yaml:4: seed: must be at least 0, got -1"),
        ("seed: 9223372036854775808",
         "x.yaml:4: seed: must be at most 9223372036854775807, got 9223372036854775808"),
        ("drive: wheel", "x.yaml:4: drive: got 'wheel'; did you mean 'wheels'? "
         "allowed: wheels, kinematic"),
        ("robot: {max_speed: 3.01}", "x.yaml:4: robot.max_speed: must be at most 3, got 3.01"),
        ("description: 5", "x.yaml:4: description: expected text, got 5; put it in quotes"),
        ("random: {radius: 0.2}", "x.yaml:4: random.count: is required"),
        ("planner: {name: fuzzy, weights: [1, x]}",
         "x.yaml:4: planner.weights[1]: expected a number, got 'x'"),
        ("planner: {weights: [1, 1]}", "x.yaml:4: planner.weights: unknown key for the planner "
         "fuzzy-q-lambda, known to fuzzy, improved-fuzzy; allowed: name, line_angle, turn_unit, "
         "distance, clear, rules, samples, closing_speed, guard, breakout, breakout_at, following, "
         "policy"),
        ("planner: {name: vfh, rats: 5}", "x.yaml:4: planner.rats: unknown key for the planner "
         "vfh; did you mean 'rate'? allowed: name, closing_speed, rate, guard, safety, high, low, "
         "steepness, wide, goal_cost, turn_cost, change_cost, dense"),
        ("planner: {closing_speed: 3.5}",
         "x.yaml:4: planner.closing_speed: must be at most 3, got 3.5"),
        ("planner: {name: dwa, heading: 0, clearance: 0, velocity: 0}",
         "x.yaml:4: planner.velocity: heading, clearance and velocity are all 0: one must be "
         "greater"),
        ("planner: {name: vfh, goal_cost: 0, turn_cost: 0, change_cost: 0}",
         "x.yaml:4: planner.change_cost: goal_cost, turn_cost and change_cost are all 0: one must "
         "be greater"),
    ],
)  # fmt: skip
def test_a_wrong_value_is_named_with_line_key_and_what_is_allowed(added, line):
    assert only(GOOD + added) == line


def test_a_misspelt_key_gets_a_suggestion_and_the_allowed_keys():
    obstacle = "obstacles:\n  - {shape: cylinder, position: [4, 4], radius: 0.2, raduis: 3}\n"
    assert only(GOOD + obstacle) == (
        "x.yaml:5: obstacles[0].raduis: unknown key; did you mean 'radius'? "
        "allowed: shape, position, motion, radius"
    )
    assert only(GOOD + "robot: {max_sped: 1}") == (
        "x.yaml:4: robot.max_sped: unknown key; did you mean 'max_speed'? "
        "allowed: model, left_wheel, right_wheel, radius, track, wheel_radius, mass, max_speed, "
        "max_turn_rate, acceleration, turn_acceleration, slip, latency"
    )
    assert "did you mean 'obstacles'?" in only(GOOD + "obstacle: []")
    assert "did you mean 'weights'?" in only(GOOD + "planner: {name: fuzzy, wieghts: [1, 1]}")
    assert "did you mean" not in only(GOOD + "zzz: 1")


def test_a_missing_key_is_reported_on_the_line_of_what_should_hold_it():
    assert problems("name: a\nstart:\n  heading: 0.0\n") == [
        "x.yaml:1: goal: is required",
        "x.yaml:2: start.position: is required",
    ]


@pytest.mark.parametrize("name", ["", "a/b", "../x", ".hidden", "a b", "ü", "-x", "a" * 101])
def test_a_name_that_could_not_name_a_file_is_refused(name):
    assert "allowed: letters, digits" in only(GOOD.replace("good", f'"{name}"'))


def test_problems_come_in_order_of_lines_and_only_the_first_ten_are_told():
    bad = "".join("  - {shape: cylinder, position: [4, 4], radius: x}\n" for _ in range(25))
    lines = problems(GOOD + "zzz: 1\nobstacles:\n" + bad)
    assert len(lines) == 11
    assert [int(line.split(":")[1]) for line in lines[:10]] == [4, *range(6, 15)]
    assert lines[10] == "x.yaml: and 16 more"


def test_yaml_1_2_numbers_are_numbers_and_yaml_1_1_oddities_are_text():
    text = GOOD + "arena: {size: [1e1, 1.0E+1]}\nseed: 010\nlimits: {time: +6e1}\n"
    scenario = parse_scenario(text)
    assert scenario.arena.size == (10.0, 10.0)
    assert scenario.seed == 10
    assert scenario.limits.time == 60.0
    assert parse_scenario(GOOD + "description: 2024-01-01").description == "2024-01-01"
    assert parse_scenario(GOOD + "description: 1:30").description == "1:30"
    assert parse_scenario(GOOD + "description: off").description == "off"
    assert "got '0x10'" in only(GOOD + "seed: 0x10")
    assert "got '1_000'" in only(GOOD + "seed: 1_000")


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("", "x.yaml:1: the file is empty"),
        ("# a comment\n", "x.yaml:1: the file is empty"),
        ("---\n", "x.yaml:2: expected a mapping with the keys name, start and goal, got nothing"),
        ("\n- 1\n- 2\n",
         "x.yaml:2: expected a mapping with the keys name, start and goal, got [1, 2]"),
        ("hello", "x.yaml:1: expected a mapping with the keys name, start and goal, got 'hello'"),
        (GOOD + "name: again\n", "x.yaml:4: the key 'name' is given twice, first on line 1"),
        (GOOD + "---\n" + GOOD, "x.yaml:4: a second document begins; one in a file"),
        (GOOD + "5: a\n", "x.yaml:4: a key must be text, got 5; put it in quotes"),
        (
            GOOD + "limits: {time: 4, 3: 1}\n",
            "x.yaml:4: a key must be text, got 3; put it in quotes",
        ),
        (GOOD + "seed: 1\n2: a\n", "x.yaml:5: a key must be text, got 2; put it in quotes"),
        (
            GOOD + "arena: {size: [9, 9], 3: a}\n",
            "x.yaml:4: a key must be text, got 3; put it in quotes",
        ),
        (GOOD + "null: a\n", "x.yaml:4: a key must be text, got null; put it in quotes"),
        (GOOD + "[a]: b\n", "x.yaml:4: a key must be text, got a list or mapping"),
        (GOOD + "seed: !!python/object/apply:os.system [id]\n",
         "x.yaml:4: tags are not allowed, got tag:yaml.org,2002:python/object/apply:os.system"),
        (GOOD + "seed: !!int 5\n", "x.yaml:4: tags are not allowed, got tag:yaml.org,2002:int"),
        ("%TAG ! tag:x\n---\n" + GOOD,
         "x.yaml:1: YAML directives (lines that begin with %) are not allowed"),
        (GOOD + "seed: *nowhere\n", "x.yaml:4: the alias *nowhere has no anchor before it"),
        (GOOD + "obstacles: &a [*a]\n", "x.yaml:4: the alias *a contains itself"),
        (GOOD + "obstacles: " + "[" * 99, "x.yaml:4: nested deeper than 20 levels"),
    ],
)  # fmt: skip
def test_what_is_not_one_plain_mapping_is_refused_with_its_line(text, line):
    assert only(text) == line


@pytest.mark.parametrize(
    ("text", "line"), [(GOOD + "a: [1\n", 5), (GOOD + "a: b: c\n", 4), (GOOD + "\ta: 1\n", 4)]
)
def test_broken_yaml_names_its_line(text, line):
    assert only(text).startswith(f"x.yaml:{line}: not valid YAML: ")


def test_an_unprintable_character_names_its_line():
    expected = "x.yaml:4: not valid YAML: an unprintable character"
    assert only(GOOD + "description: a\x07b\n") == expected


def test_anchors_and_aliases_may_be_used_and_mistakes_behind_them_keep_their_line():
    text = "name: a\nstart: {position: &p [1.0, 5.0]}\ngoal: {position: [9.0, 5.0]}\nobstacles:\n"
    pillar = "  - &o {shape: cylinder, position: [5, 5], radius: 0.2}\n  - *o\n"
    first, second = parse_scenario(text + pillar).obstacles
    assert first == second
    assert problems(text + pillar.replace("[5, 5]", "*p")) == [
        "x.yaml:5: obstacles[0]: overlaps the start at (1, 5), which is 0.2 m inside it; "
        "the robot needs more than 0.2 m: move it by more than 0.4 m",
        "x.yaml:6: obstacles[1]: overlaps the start at (1, 5), which is 0.2 m inside it; "
        "the robot needs more than 0.2 m: move it by more than 0.4 m",
    ]
    assert problems(text + pillar.replace("0.2", "x")) == [
        "x.yaml:5: obstacles[0].radius: expected a number, got 'x'",
        "x.yaml:5: obstacles[1].radius: expected a number, got 'x'",
    ]


LAUGHS = "a: &a [1, 1]\n" + "".join(
    f"{chr(98 + i)}: &{chr(98 + i)} [{', '.join([f'*{chr(97 + i)}'] * 9)}]\n" for i in range(15)
)


@pytest.mark.slow
@pytest.mark.parametrize(
    "text",
    [
        pytest.param(LAUGHS, id="billion laughs"),
        pytest.param("[" * 1_900_000, id="deep flow"),
        pytest.param("{a: " * 450_000, id="deep flow mappings"),
        pytest.param("- " * 950_000, id="deep block"),
        pytest.param("? " * 950_000, id="deep keys"),
        pytest.param("a:\n" + "- 1\n" * 470_000, id="long list"),
        pytest.param("".join(f"k{i}: 1\n" for i in range(150_000)), id="many keys"),
        pytest.param("%TAG !a! b\n" * 170_000, id="directives"),
        pytest.param("".join(f"%TAG !{i}! b\n" for i in range(120_000)), id="many directives"),
        pytest.param("---\n" * 490_000, id="many documents"),
        pytest.param("a: " + "9" * 1_900_000, id="long number"),
        pytest.param("seed: 0." + "9" * 1_900_000, id="long fraction"),
        pytest.param("a: '" + "'' " * 600_000, id="quotes"),
        pytest.param("a: |\n" + " \n" * 900_000, id="blank lines"),
        pytest.param("#" * 1_900_000, id="comment"),
        pytest.param("a" * 1_900_000 + ": 1", id="long key"),
        pytest.param("&a " * 600_000, id="anchors"),
        pytest.param("obstacles: [" + "{}, " * 240_000 + "]", id="empty mappings"),
        pytest.param("obstacles: [" + "{}, " * 9_999 + "]", id="many mistakes"),
        pytest.param("".join(f"k{i}: 1\n" for i in range(90_000)), id="unknown keys"),
        pytest.param("obstacles:\n" + "- {a: , b: , c: , d: }\n" * 9_999, id="wrong obstacles"),
        pytest.param(f"a{'b' * 1000}: &{'c' * 9999} *{'d' * 9999}", id="long names"),
        pytest.param("\0" * 1_900_000, id="nulls"),
    ],
)
def test_hostile_text_is_refused_soon_and_in_few_short_lines(text):
    lines = problems(text)
    assert len(lines) <= 11
    assert max(map(len, lines)) < 400


def test_aliases_count_as_often_as_they_are_used():
    assert only(LAUGHS) == "x.yaml:6: holds more than 200000 values, aliases expanded"


@settings(max_examples=200)
@given(st.text(max_size=200) | st.text(alphabet="ab:-[]{}&*!|>'\"#%@, \n?0.", max_size=80))
def test_any_text_is_a_scenario_or_a_user_error(text):
    with contextlib.suppress(UserError):
        parse_scenario(text)


# Files ------------------------------------------------------------------------------------------


def refusal(path: object) -> str:
    with pytest.raises(UserError) as caught:
        load_scenario(path)
    (line,) = caught.value.problems
    return line


def test_what_cannot_be_read_as_a_file_is_refused_by_its_path(tmp_path):
    missing = tmp_path / "no.yaml"
    assert f"{missing}: there is no such file" in refusal(missing)
    assert refusal(tmp_path) == f"{tmp_path}: is a folder; give a scenario file"
    fifo = tmp_path / "fifo"
    os.mkfifo(fifo)
    assert "is not a regular file" in refusal(fifo)
    assert "is not a regular file" in refusal("/dev/zero")
    assert "cannot be read" in refusal("a\0b") or "no such file" in refusal("a\0b")
    assert "a" * 50 in refusal("a" * 5000)
    (tmp_path / "junk").write_bytes(bytes(range(256)))
    assert refusal(tmp_path / "junk").endswith(":2: is not UTF-8 text")
    (tmp_path / "wide").write_text(GOOD, encoding="utf-16")
    assert "is not UTF-8 text" in refusal(tmp_path / "wide")
    (tmp_path / "empty").write_bytes(b"")
    assert "the file is empty" in refusal(tmp_path / "empty")


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root reads anything")
def test_a_file_without_permission_is_refused(tmp_path):
    path = tmp_path / "secret.yaml"
    path.write_text(GOOD)
    path.chmod(0)
    assert refusal(path) == f"{path}: cannot be read: Permission denied"


def test_a_file_that_fails_while_it_is_read_is_refused(tmp_path, monkeypatch):
    path = tmp_path / "x.yaml"
    path.write_text(GOOD)

    def fail(*args, **kwargs):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(os, "open", fail)
    assert refusal(path) == f"{path}: cannot be read: Permission denied"


def test_a_million_obstacles_are_refused_by_size_at_once(tmp_path):
    path = tmp_path / "big.yaml"
    path.write_text(GOOD + "obstacles:\n" + "- {shape: cylinder, position: [4, 4]}\n" * 1_000_000)
    assert "too large" in refusal(path)


def test_a_byte_order_mark_and_dos_lines_do_no_harm(tmp_path):
    path = tmp_path / "dos.yaml"
    path.write_bytes(b"\xef\xbb\xbf" + GOOD.replace("\n", "\r\n").encode())
    assert load_scenario(path).name == "good"


def test_bundled_scenarios_are_found_by_name_described_and_named_after_their_files():
    described = bundled_scenarios()
    assert {"open-field", "sparse", "paper-50", "boxes", "mixed"} <= set(described)
    for name, description in described.items():
        assert load_scenario(name).name == name
        assert description


def test_every_bundled_scenario_can_be_realised_and_is_still_without_conflict():
    for name in bundled_scenarios():
        parse_scenario(dump_scenario(realise(load_scenario(name))))


def test_a_file_wins_over_a_bundled_scenario_of_its_name_but_a_folder_does_not(
    tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    Path("boxes").mkdir()
    assert load_scenario("boxes").name == "boxes"
    Path("mixed").write_text(GOOD)
    assert load_scenario("mixed").name == "good"


def test_an_unknown_name_suggests_a_bundled_one():
    line = refusal("spars")
    assert "did you mean 'sparse'?" in line
    assert "open-field" not in line


# Writing ----------------------------------------------------------------------------------------

number = st.floats(0.3, 5.0)
item = st.one_of(
    st.fixed_dictionaries(
        {
            "shape": st.just("cylinder"),
            "position": st.tuples(number, number),
            "radius": st.floats(0.025, 1.0),
        }
    ),
    st.fixed_dictionaries(
        {
            "shape": st.just("box"),
            "position": st.tuples(number, number),
            "size": st.tuples(number, number),
            "yaw": st.floats(-3, 3) | st.sampled_from([1e-7, 5e-324, 1e-05]),
        }
    ),
)


@pytest.mark.slow
@settings(max_examples=100)
@given(
    st.lists(item, max_size=3),
    st.text(max_size=30) | st.sampled_from(["yes", "null", "1e5", "~", "a: b", "x\u2028y", "😀"]),
    st.sampled_from(planner_names()),
    st.none() | st.floats(-3, 3),
    st.integers(0, 2**63 - 1),
)
def test_what_is_written_reads_back_equal(obstacles, description, planner, heading, seed):
    scenario = Scenario.model_validate(
        {
            "name": "on",
            "description": description,
            "seed": seed,
            "start": {"position": [15.0, 15.0], "heading": heading},
            "goal": {"position": [18.0, 18.0]},
            "arena": {"size": [20.0, 20.0]},
            "planner": {"name": planner},
            "obstacles": obstacles,
            "random": {"count": 3},
        }
    )
    text = dump_scenario(scenario)
    again = parse_scenario(text)
    assert again == scenario
    assert type(again.planner) is type(scenario.planner)
    assert Scenario.model_validate(yaml.safe_load(text)) == scenario  # other readers agree


def test_saving_replaces_the_file_whole_and_says_when_it_cannot(tmp_path):
    scenario = load_scenario("mixed")
    path = tmp_path / "m.yaml"
    save_scenario(scenario, path)
    assert load_scenario(path) == scenario
    assert list(tmp_path.iterdir()) == [path]
    with pytest.raises(UserError, match="cannot be written"):
        save_scenario(scenario, tmp_path / "none" / "m.yaml")


# Planner ----------------------------------------------------------------------------------------


def test_a_planner_is_given_by_name_by_parameters_or_by_both():
    other = next(name for name in planner_names() if name != DEFAULT_PLANNER)
    assert parse_scenario(GOOD + f"planner: {other}").planner.name == other
    assert parse_scenario(GOOD + f"planner: {{name: {other}}}").planner.name == other
    only_parameters = parse_scenario(GOOD + "planner: {turn_unit: 0.75}").planner
    assert only_parameters.name == DEFAULT_PLANNER
    assert only_parameters.model_dump()["turn_unit"] == 0.75
    assert parse_scenario(GOOD + "planner:").planner == parse_scenario(GOOD).planner


def test_the_settings_of_the_chosen_planner_are_kept_whole_when_serialised():
    scenario = parse_scenario(GOOD + "planner: {name: fuzzy, weights: [1, 0.75]}")
    assert scenario.model_dump(mode="json")["planner"]["weights"] == [1.0, 0.75]
    assert Scenario.model_validate_json(scenario.model_dump_json()) == scenario


@pytest.mark.parametrize("planner", ["improved-fuzy", "{name: improved-fuzy}"])
def test_an_unknown_planner_gets_a_suggestion(planner):
    line = only(GOOD + f"planner: {planner}")
    assert line.startswith("x.yaml:4: planner")
    assert "no planner 'improved-fuzy'; did you mean 'improved-fuzzy'? allowed: fuzzy," in line


@pytest.mark.parametrize("planner", ["5", "[a]", "{name: 5}", "{name: [a]}", "{name: }", "true"])
def test_a_planner_of_a_wrong_kind_is_refused(planner):
    assert only(GOOD + f"planner: {planner}").startswith("x.yaml:4: planner")


def test_finished_settings_are_taken_and_those_of_no_planner_refused():
    data = {"name": "a", "start": {"position": [1, 5]}, "goal": {"position": [9, 5]}}
    finished = settings_for("fuzzy").model_validate({"name": "fuzzy", "samples": 5})
    assert Scenario.model_validate({**data, "planner": finished}).planner is finished
    with pytest.raises(ValidationError, match="must be one of"):
        Scenario.model_validate({**data, "planner": PlannerSettings(name="no-such")})


@pytest.mark.parametrize(
    ("radius", "right"), [("0,3", "0.3"), ("0,25", "0.25"), ("-0,5", "-0.5"), ("10,05", "10.05")]
)
def test_a_decimal_comma_is_told_with_the_number_to_write(radius: str, right: str):
    told = f"obstacles[1].radius: {radius} has a decimal comma; write {right}"
    inline, below = "{{shape: cylinder, position: [5, 3], {0}}}", "shape: cylinder\n    {0}"
    for form in (inline, below):
        obstacle = form.format(f"radius: {radius}").replace(
            "\n    ", "\n    position: [5, 3]\n    "
        )
        text = GOOD + f"obstacles:\n  - {inline.format('radius: 1')}\n  - {obstacle}\n"
        line = 6 if form is inline else 8
        assert only(text) == f"x.yaml:{line}: {told}"


def test_all_decimal_commas_of_a_file_are_told_at_once():
    one = "{shape: cylinder, position: [5, 3], radius: 0,3, motion: {kind: line, speed: 1,5}}"
    told = problems(GOOD + f"limits: {{time: 9,5}}\nobstacles: [{one}, {one}]\n")
    assert [line.split()[1] for line in told] == [
        "limits.time:",
        *(f"obstacles[{i}].{key}:" for i in (0, 1) for key in ("radius", "motion.speed")),
    ]
    assert len(problems(GOOD + f"obstacles: [{', '.join([one] * 20)}]\n")) == 10


MAPS = Path(__file__).parent / "maps"


@pytest.mark.parametrize(
    ("name", "what"),
    [
        ("lab.yaml", "a ROS map"),
        ("house.world", "a Gazebo world"),
        ("irsim.yaml", "a world of ir-sim"),
        ("cave.map", "a MovingAI map"),
    ],
)
def test_a_map_of_another_program_is_one_line_that_names_the_import(name: str, what: str):
    with pytest.raises(UserError) as caught:
        load_scenario(MAPS / name)
    [line] = caught.value.problems
    assert line.startswith(f"{MAPS / name}: looks like {what}: fuzzyq import {MAPS / name} ")


@pytest.mark.parametrize(
    ("name", "told"),
    [
        (
            "ofice",
            "ofice: there is no such file and no bundled scenario of that name; did you mean",
        ),
        ("lift.yaml", "lift.yaml: there is no such file"),
        ("office.yaml", "office.yaml: there is no such file; office alone is the bundled scenario"),
        ("hal.yaml", "hal.yaml: there is no such file; did you mean 'hall.yaml'?"),
    ],
)
def test_a_file_that_is_not_there_is_told_with_the_nearest_name_at_most(
    name: str, told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "hall.yaml").write_text(GOOD)
    with pytest.raises(UserError) as caught:
        load_scenario(name)
    [line] = caught.value.problems
    assert line.startswith(told)
    assert "warehouse" not in line


def test_a_via_point_in_an_obstacle_is_told_at_its_own_line():
    via = "via:\n  - {position: [4, 5]}\n  - {position: [6, 5]}\n"
    box = "obstacles:\n  - {shape: box, position: [6, 5.1], size: [0.5, 0.5]}\n"
    assert only(GOOD + via + box).startswith(
        "x.yaml:6: via[1].position: is 0.15 m inside obstacles[0], a box; "
    )
