"""``fuzzyq explain``: what it says is what the controller does, legible without colour."""

from __future__ import annotations

import json
import subprocess
import sys
from itertools import chain

import numpy as np
import pytest
import typer
from typer.testing import CliRunner, Result

from fuzzyq_bullet.cli.explain import CONTEXT_SETTINGS, explain
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.fuzzy import paper_controller

app = typer.Typer()
app.command("explain", context_settings=CONTEXT_SETTINGS)(explain)
app.command("other")(lambda: None)  # with a second command typer keeps the names of both


def call(*args: str, width: int = 80) -> Result:
    return CliRunner().invoke(app, ["explain", *args], env={"COLUMNS": str(width)})


def page(*args: str, width: int = 80) -> str:
    result = call(*args, width=width)
    assert result.exit_code == 0, result.output
    return result.stdout


def test_a_negative_difference_is_a_number_and_not_an_option() -> None:
    for number in ("-0.8", "-5", "-.5", "-1e-3"):
        assert json.loads(page("1.2", number, "--json"))["difference"] == float(number)


def test_a_misspelt_option_is_still_refused() -> None:
    result = call("1.2", "-0.8", "--jsn")
    assert result.exit_code == 2
    assert "--jsn" in result.output


@pytest.mark.parametrize("rules", ["corrected", "printed"])
def test_json_stands_alone_and_is_the_inference(rules: str) -> None:
    answer = json.loads(page("1.2", "-0.8", "--json", "--rules", rules, "--samples", "5"))
    inference = paper_controller(rules, 5).infer(1.2, -0.8)  # type: ignore[arg-type]
    assert answer["turn"] == inference.turn
    assert answer["stride"] == inference.stride
    assert list(answer["near"].values()) == list(inference.near)
    assert answer["side"]["ZO"] == inference.side[2]
    assert (answer["table"], answer["samples"]) == (rules, 5)
    strengths = [rule["strength"] for rule in answer["rules"]]
    assert strengths == sorted(chain(*inference.rules), reverse=True)
    strongest = {"d": "N", "Df": "ZO", "turn": "ZO", "step": "L"}
    if rules == "printed":
        strongest |= {"turn": "NL", "step": "ME"}
    assert answer["rules"][0] == {**strongest, "strength": strengths[0]}


def test_the_rules_that_fire_are_sentences_strongest_first() -> None:
    text = page("1.2", "-0.8", width=140)
    assert "0.55 if d is Near (0.79) and Df is Zero (0.70) then turn Zero, step Less" in text
    sentences = [line for line in text.splitlines() if " if d is " in line]
    strengths = [float(line.split()[0]) for line in sentences]
    assert strengths == sorted(strengths, reverse=True)
    assert len(sentences) == (np.array(paper_controller().infer(1.2, -0.8).rules) >= 0.01).sum()
    assert f"other {25 - len(sentences)} rules" in text


def test_the_strongest_rule_stands_out_without_colour() -> None:
    lines = page("1.2", "-0.8").splitlines()
    assert "\x1b" not in "".join(lines)
    (row,) = (line for line in lines if "◀" in line and "strongest" not in line)
    assert row.split()[0] == "N"
    assert "ZO L  0.55◀" in row
    assert "PS L    ·" in row  # a rule that does not fire shows no number


def test_it_says_which_way_the_turn_goes() -> None:
    assert "turn to the right by 0.36·ω2·A_p" in page("1.2", "-0.8")
    assert "turn to the left by" in page("1.2", "0.8")
    assert "no turn" in page("5", "0")
    assert "a step of 0.52·ω1·S_p" in page("1.2", "-0.8")


def test_the_mark_of_a_left_turn_is_on_the_left() -> None:
    for difference, before in (("3", True), ("-3", False)):
        (ruler,) = (line for line in page("1", difference).splitlines() if "N_a" in line)
        assert (ruler.index("●") < ruler.index("┼")) is before


@pytest.mark.parametrize("distance", ["0", "1.2", "2.5", "5"])
@pytest.mark.parametrize("difference", ["-5", "-0.8", "0", "5"])
def test_it_fits_into_eighty_columns_unbroken(distance: str, difference: str) -> None:
    text = page(distance, difference, width=80)
    assert max(map(len, text.splitlines())) <= 80
    # A sentence breaks before its "then" if at all, the outputs and the table never.
    for line in text.splitlines():
        if " if d is " in line:
            assert line.rstrip().endswith(")")
        if "N_a" in line:
            assert "right" in line
    assert sum(line.split()[:1] in ([["VN"]], ["VN"]) for line in text.splitlines()) == 2


@pytest.mark.parametrize(
    ("args", "name"),
    [
        ((5.1, 0.0), "D: 5.1"),
        ((-0.1, 0.0), "D: -0.1"),
        ((float("nan"), 0.0), "D: nan"),
        ((1.0, 5.5), "DF: 5.5"),
        ((1.0, float("-inf")), "DF: -inf"),
        ((1.0, float("nan")), "DF: nan"),
    ],
)
def test_inputs_outside_their_domains_are_refused_in_one_line(
    args: tuple[float, float], name: str
) -> None:
    with pytest.raises(UserError) as caught:
        explain(*args)
    (line,) = caught.value.problems
    assert line.startswith(name)
    assert "\n" not in line
    assert " to 5" in line


def test_too_few_samples_are_refused() -> None:
    with pytest.raises(UserError, match="--samples: must be from 3 to 10001, got 2"):
        explain(1.0, 0.0, samples=2)


def test_explaining_loads_neither_the_physics_nor_the_pictures() -> None:
    code = (
        "import sys, fuzzyq_bullet.cli.explain, fuzzyq_bullet.cli.report\n"
        "print([name for name in ('pybullet', 'matplotlib', 'fuzzylite') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
