"""Policy files: the same training gives the same bytes, and nothing unfit gets in."""

from __future__ import annotations

import json
import math
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from examples.exercises import Corridor
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.learning import Policy, PolicySpec, QLambda, Setup, load_policy, train
from fuzzyq_bullet.learning.policy import MAX_BYTES
from fuzzyq_bullet.version import __version__

STATES = tuple(f"place {i}" for i in range(4))
ACTIONS = ("back", "forth")


def trained(**changes: Any) -> Policy:
    learner, setup = QLambda(4, 2), Setup(20, seed=3, max_steps=30)
    train(Corridor(4), learner, setup)
    made: dict[str, Any] = {
        "planner": "corridor",
        "learner": "q-lambda",
        "command": "train corridor --seed 3",
        "seed": 3,
        "version": __version__,
        "drive": "none",
        "scenario": "0123abcd",
        "episodes": 20,
        "parameters": {**setup.describe(), **learner.describe(), "note": None},
        "states": STATES,
        "actions": ACTIONS,
        "table": learner.table.tolist(),
    }
    return Policy(**{**made, **changes})


GOOD = json.loads(trained().dumps())
POLICY_SPEC = PolicySpec("corridor", STATES, ACTIONS, "q-lambda")


def refusal(path: Path, content: str | bytes, expect: PolicySpec | None = None) -> str:
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(UserError) as caught:
        load_policy(path, expect)
    message = str(caught.value)
    assert message.startswith(str(path))
    assert message.isprintable()  # one line, and nothing that plays tricks with a terminal
    assert len(message) < len(str(path)) + 400
    return message.removeprefix(str(path))


# Written and read


def test_a_policy_reads_back_as_it_was_and_fits_its_planner(tmp_path: Path) -> None:
    path, policy = tmp_path / "policy.json", trained()
    policy.save(path)
    assert load_policy(path, POLICY_SPEC) == policy
    assert policy.array().shape == (4, 2)
    assert policy.array().tolist() == [list(row) for row in policy.table]


def test_the_same_training_gives_the_same_bytes(tmp_path: Path) -> None:
    for name in ("one", "other"):
        trained().save(tmp_path / name)
    assert (tmp_path / "one").read_bytes() == (tmp_path / "other").read_bytes()


def test_the_file_is_sorted_json_with_a_line_for_each_state() -> None:
    text = trained().dumps()
    assert list(GOOD) == sorted(GOOD)
    assert list(GOOD["parameters"]) == sorted(GOOD["parameters"])
    assert all(f"  {json.dumps(row)}" in text for row in GOOD["table"])


@given(
    table=st.lists(st.lists(st.floats(-1e9, 1e9), min_size=2, max_size=2), min_size=4, max_size=4)
)
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=30)
def test_every_number_reads_back_to_the_bit(tmp_path: Path, table: list[list[float]]) -> None:
    path = tmp_path / "policy.json"
    trained(table=table).save(path)
    assert load_policy(path).array().tobytes() == np.array(table).tobytes()


def test_words_of_any_kind_can_be_kept(tmp_path: Path) -> None:
    path = tmp_path / "policy.json"
    odd = os.fsdecode(b"caf\xe9.yaml")  # what a shell hands over of a name that is no UTF-8
    trained(command=f"train {odd}", parameters={"path": odd, "ω1": 1.5}).save(path)
    read = load_policy(path)
    assert "udce9" in read.command
    assert read.parameters["ω1"] == 1.5


@pytest.mark.parametrize(
    "wrong",
    [
        {"table": [[0.0, 0.0]] * 3},
        {"table": [[0.0]] * 4},
        {"table": [[0.0, math.nan]] * 4},
        {"table": [[0.0, 1e10]] * 4},
        {"states": ("a", "a", "b", "c")},
        {"seed": -1},
        {"planner": ""},
        {"parameters": {"x": [1]}},
        {"parameters": {"x": math.inf}},
    ],
)
def test_a_policy_that_could_not_be_read_cannot_be_made(wrong: dict[str, Any]) -> None:
    with pytest.raises(ValidationError):
        trained(**wrong)


def test_an_unwritable_place_is_told_and_what_was_there_stays(tmp_path: Path) -> None:
    for place in (tmp_path, tmp_path / "missing" / "policy.json"):
        with pytest.raises(UserError, match="cannot be written"):
            trained().save(place)
    big = [f"{i:0100}" for i in range(50_000)]
    with pytest.raises(UserError, match="too large"):
        trained(states=big, table=[[0.0, 0.0]] * len(big)).save(tmp_path / "big.json")
    assert not list(tmp_path.iterdir())


# Does it fit?


@pytest.mark.parametrize(
    ("expect", "complaint"),
    [
        (
            PolicySpec("maze", STATES, ACTIONS),
            ": is a policy of the planner 'corridor'; one of 'maze'",
        ),
        (
            PolicySpec("corridor", STATES, ACTIONS, "linear-q-lambda"),
            "one that was learned by 'linear",
        ),
        (PolicySpec("corridor", STATES[:3], ACTIONS), ": has 4 states; corridor has 3"),
        (PolicySpec("corridor", STATES, ("forth",)), ": has 2 actions; corridor has 1"),
        (
            PolicySpec("corridor", STATES, ACTIONS[::-1]),
            ": actions: number 0 is 'back'; that of corr",
        ),
        (
            PolicySpec("corridor", (*STATES[:3], "x"), ACTIONS),
            ": states: number 3 is 'place 3'; that",
        ),
    ],
)
def test_a_policy_of_another_planner_is_refused(
    tmp_path: Path, expect: PolicySpec, complaint: str
) -> None:
    assert complaint in refusal(tmp_path / "policy.json", trained().dumps(), expect)


def test_whatever_learner_will_do_if_none_is_asked_for(tmp_path: Path) -> None:
    trained().save(tmp_path / "policy.json")
    load_policy(tmp_path / "policy.json", PolicySpec("corridor", list(STATES), list(ACTIONS)))


# Bad files


def changed(**changes: Any) -> str:
    return json.dumps({**GOOD, **changes})


def without(key: str) -> str:
    return json.dumps({name: value for name, value in GOOD.items() if name != key})


TEXT = trained().dumps()
BAD_FILES: dict[str, tuple[str | bytes, str]] = {
    "empty": ("", ": is empty"),
    "blank": ("\n \n", ": is empty"),
    "junk": (bytes(range(256)) * 9, ": is not text"),
    "UTF-16": (TEXT.encode("utf-16"), ": is not text"),
    "truncated": (TEXT[: len(TEXT) // 2], "not valid JSON"),
    "cut inside a line": (TEXT[:-3], "not valid JSON"),
    "two": (TEXT + TEXT, "not valid JSON: Extra data"),
    "YAML": ("planner: corridor\n", ":1: not valid JSON"),
    "list": ("[]", ": holds a list of 0; a policy is an object"),
    "number": ("1", ": holds 1;"),
    "text": ('"' + "x" * 1000 + '"', ": holds 'xxxx"),
    "null": ("null", ": holds null;"),
    "NaN": (TEXT.replace("[\n  [", "[\n  [NaN,", 1), ": NaN is not allowed"),
    "Infinity": (changed(seed=math.inf), ": Infinity is not allowed"),
    "-Infinity": (changed(seed=-math.inf), ": -Infinity is not allowed"),
    "overflow": (
        TEXT.replace("[\n  [", "[\n  [1e999,", 1),
        "must hold numbers within ±1e+09, got inf",
    ),
    "key twice": (
        TEXT.replace('{\n "', '{\n "seed": 3,\n "', 1),
        ": the key 'seed' is given twice",
    ),
    "parameter twice": (
        changed()[:-1] + ', "x": {"a": 1, "a": 2}}',
        ": the key 'a' is given twice",
    ),
    "deep lists": ("[" * 1_000_000, ": is nested too deeply"),
    "deep objects": ('{"a":' * 500_000, ": is nested too deeply"),
    "deep table": (TEXT.replace("[\n  [", "[\n  " + "[" * 50_000, 1), ": is nested too deeply"),
    "long number": (
        changed().replace('"seed": 3', '"seed": ' + "9" * 1_000_000),
        ": a whole number of 1000000 digits",
    ),
    "large": (" " * (MAX_BYTES + 1), ": too large"),
    "no format": (without("format"), ": is not a policy: it has no format; fuzzyq train writes"),
    "next format": (changed(format=2), ": format: is 2; this version"),
    "true format": (changed(format=True), ": format: is true; this version"),
    "unknown key": (changed(**{"\x1b[31mextra\n": 1}), ": unknown key; a policy has actions, comm"),
    "million keys": (
        json.dumps({str(i): 0 for i in range(200_000)} | {"format": 1}),
        ": unknown key",
    ),
    "no table": (without("table"), ": table: Field required"),
    "planner a number": (changed(planner=1), ": planner: Input should be a valid string"),
    "seed text": (changed(seed="3"), ": seed: Input should be a valid integer"),
    "seed a float": (changed(seed=3.5), ": seed: Input should be a valid integer"),
    "episodes": (changed(episodes=-1), ": episodes: Input should be greater than or equal to 0"),
    "states": (changed(states="abcd"), ": states: must be a list of 1 to 50000 names, got 'abcd'"),
    "no states": (changed(states=[], table=[]), ": states: must be a list of 1 to"),
    "state twice": (
        changed(states=["a", "b", "a", "c"]),
        ": states: every name must be another, 'a'",
    ),
    "state a number": (
        changed(states=["a", 2, "c", "d"]),
        "a name is text of 1 to 100 letters, got 2",
    ),
    "million states": (changed(states=[1] * 1_000_000), ": states: must be a list of 1 to 50000"),
    "long name": (
        changed(states=["x" * 101, "b", "c", "d"]),
        ": states: a name is text of 1 to 100",
    ),
    "rows": (changed(table=GOOD["table"][:3]), ": table: 3 rows for 4 states"),
    "ragged": (
        changed(table=[*GOOD["table"][:3], [0.0]]),
        ": table: row 3 has 1 values for 2 actions",
    ),
    "flat": (changed(table=[0.0] * 4), ": table: row 0 must be a list of numbers, got 0.0"),
    "true": (
        changed(table=[[True, 0.0]] * 4),
        ": table: row 0 must hold numbers within ±1e+09, got tr",
    ),
    "null in table": (
        changed(table=[[None, 0.0]] * 4),
        "row 0 must hold numbers within ±1e+09, got nu",
    ),
    "text in table": (
        changed(table=[["1", 0.0]] * 4),
        "row 0 must hold numbers within ±1e+09, got '1'",
    ),
    "million rows": (changed(table=[[]] * 900_000), ": table: must be a list of 1 to 50000 rows"),
    "parameters": (changed(parameters=[1]), ": parameters: must be an object of at most 200 keys"),
    "parameter": (
        changed(parameters={"a": {}}),
        ": parameters: 'a' must be a number, true, false, nu",
    ),
    "many": (
        changed(parameters={str(i): 0 for i in range(300)}),
        "at most 200 keys, got an object of",
    ),
}


@pytest.mark.parametrize(("content", "complaint"), BAD_FILES.values(), ids=BAD_FILES.keys())
def test_a_bad_file_is_refused_in_a_line(
    tmp_path: Path, content: str | bytes, complaint: str
) -> None:
    assert complaint in refusal(tmp_path / "policy.json", content)


def test_what_is_no_file_is_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for path, complaint in (
        (tmp_path, "is not a file"),
        (tmp_path / "pipe", "is not a file"),
        (tmp_path / "missing.json", "No such file"),
        (tmp_path / ("x" * 300), "name too long"),
        (tmp_path / "a\0b", "null"),
    ):
        with pytest.raises(UserError, match=complaint) as caught:
            load_policy(path)
        assert len(caught.value.problems) == 1


@given(st.data())
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=60)
def test_a_damaged_file_is_refused_or_a_policy_and_nothing_else(
    tmp_path: Path, data: st.DataObject
) -> None:
    path = tmp_path / "policy.json"
    content = bytearray(TEXT.encode())
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path.write_bytes(content)
    told: tuple[str, ...] = ()
    try:
        policy = load_policy(path)
    except UserError as error:
        told = error.problems
    if told:
        assert len(told) == 1
        assert told[0].isprintable()
    else:
        assert np.isfinite(policy.array()).all()
        assert policy.array().shape == (len(policy.states), len(policy.actions))
