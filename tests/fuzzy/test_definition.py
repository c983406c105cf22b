"""Controllers as files: what they may hold, what is wrong with them, and all three formats."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.fuzzy import (
    ControllerDefinition,
    definition_of,
    load_controller,
    paper_definition,
    save_controller,
)
from fuzzyq_bullet.fuzzy.definition_checks import gaps_of
from fuzzyq_bullet.fuzzy.memberships import SHAPES, Bell, Gaussian, Trapezoidal, Triangular
from fuzzyq_bullet.studies.speed.inference import FuzzyliteTwin
from tests.helpers.rules import SMOOTH, THREE

TEXTS = {"three": THREE, "smooth": SMOOTH}
DEFINITIONS = {
    **{name: ControllerDefinition.model_validate(yaml.safe_load(t)) for name, t in TEXTS.items()},
    "paper": paper_definition(),
    "printed": paper_definition("printed"),
}


def outputs(definition: ControllerDefinition) -> list[tuple[float, float]]:
    controller = definition.controller()
    grid = [(d, df) for d in np.linspace(0, 5, 11) for df in np.linspace(-5, 5, 11)]
    return [(one.turn, one.stride) for one in (controller.infer(*pair) for pair in grid)]


# Shapes


@pytest.mark.parametrize(
    ("one", "expected"),
    [
        (Gaussian(2, 0.5), {2: 1.0, 2.5: np.exp(-0.5), 1.0: np.exp(-2.0)}),
        (Triangular(1, 2, 4), {1: 0.0, 1.5: 0.5, 2: 1.0, 3: 0.5, 4: 0.0, 9: 0.0}),
        (Triangular(1, 1, 2), {0.99: 0.0, 1: 1.0, 1.5: 0.5}),
        (Trapezoidal(0, 1, 2, 4), {-1: 0.0, 0.5: 0.5, 1: 1.0, 2: 1.0, 3: 0.5, 4: 0.0}),
        (Trapezoidal(0, 0, 1, 1), {-0.01: 0.0, 0: 1.0, 1: 1.0, 1.01: 0.0}),
        (Bell(3, 2, 1.5), {3: 1.0, 5: 0.5, 1: 0.5, 1e300: 0.0}),
    ],
)
def test_a_shape_is_what_its_name_says(one: Any, expected: dict[float, float]) -> None:
    for x, degree in expected.items():
        assert one.degree(x) == pytest.approx(degree, abs=1e-12)
    assert one.degrees(np.array(list(expected))) == pytest.approx(
        list(expected.values()), abs=1e-12
    )


@given(st.sampled_from(sorted(DEFINITIONS)), st.floats(0, 5), st.floats(-5, 5))
def test_memberships_lie_between_0_and_1_and_outputs_in_their_ranges(
    name: str, distance: float, difference: float
) -> None:
    fired = DEFINITIONS[name].controller().infer(distance, difference)
    for degrees in (fired.near, fired.side, *fired.rules):
        assert all(0.0 <= degree <= 1.0 for degree in degrees)
    assert -2.0 <= fired.turn <= 2.0
    assert 0.0 <= fired.stride <= 2.0


# Files


@pytest.mark.parametrize("suffix", [".yaml", ".yml", ".fll", ".fis"])
@pytest.mark.parametrize("name", sorted(DEFINITIONS))
def test_what_is_written_is_read_back_as_the_same_controller(
    name: str, suffix: str, tmp_path: Path
) -> None:
    path = tmp_path / f"mine{suffix}"
    save_controller(DEFINITIONS[name], path)
    back = load_controller(path)
    assert back.digest() == DEFINITIONS[name].digest()
    assert outputs(back) == outputs(DEFINITIONS[name])
    if suffix in (".yaml", ".yml"):
        assert back == DEFINITIONS[name]


@pytest.mark.parametrize("name", sorted(DEFINITIONS))
def test_a_controller_is_told_as_data_and_made_from_it_again(name: str) -> None:
    definition = DEFINITIONS[name]
    assert definition_of(definition.controller(), definition.name) == definition
    told = definition.model_dump(mode="json")
    assert ControllerDefinition.model_validate(told) == definition
    assert set(told["inference"]) == {"and", "defuzzification", "samples"}


def test_words_do_not_count_for_what_a_controller_is_and_numbers_do() -> None:
    renamed = SMOOTH.replace("near: {", "near: {words: close, ")
    moved = SMOOTH.replace("[0, 1.5]", "[0.1, 1.5]")
    digests = [
        ControllerDefinition.model_validate(yaml.safe_load(text)).digest()
        for text in (SMOOTH, renamed, moved)
    ]
    assert digests[0] == digests[1] != digests[2]


@pytest.mark.parametrize("name", sorted(DEFINITIONS))
def test_pyfuzzylite_reads_what_we_write_and_agrees(name: str) -> None:
    pytest.importorskip("fuzzylite", reason="it does not take NumPy 2")
    controller = DEFINITIONS[name].controller(None if name == "three" else 1001)
    twin = FuzzyliteTwin(controller)
    # An average has no samples. Of n, pyfuzzylite takes the middles of parts, Eq. 22 both ends.
    near = 1e-9 if name == "three" else 0.004
    for distance in np.linspace(0, 5, 11):
        for difference in np.linspace(-5, 5, 11):
            ours = controller.infer(distance, difference)
            assert (ours.turn, ours.stride) == pytest.approx(
                twin.infer(distance, difference), abs=near
            )


TOOLBOX = """\
% a system as the Toolbox writes one
[System]
Name='mine'
Type='mamdani'
AndMethod='min'
ImpMethod='min'
AggMethod='max'
DefuzzMethod='centroid'

[Input1]
Name='Df'
Range=[-5 5]
MF1='R':'trimf',[-10 -5 5]
MF2='L':'trimf',[-5 5 10]

[Input2]
Name='d'
Range=[0 5]
MF1='N':'gbellmf',[2 3 0]
MF2='F':'gaussmf',[1.5 5]

[Output1]
Name='turn'
Range=[-2 2]
MF1='left':'trapmf',[0 1 2 2]
MF2='right':'trapmf',[-2 -2 -1 0]

[Output2]
Name='step'
Range=[0 2]
MF1='all':'trimf',[0 1 2]

[Rules]
1 1, 2 1 (1) : 1
1 2, 2 1 (1) : 1
2 1, 1 1 (1) : 1
2 2, 1 1 (1) : 1
"""


def test_a_toolbox_file_is_read_by_the_names_of_its_variables(tmp_path: Path) -> None:
    (tmp_path / "mine.fis").write_text(TOOLBOX)
    mine = load_controller(tmp_path / "mine.fis")
    assert mine.rules == {"N": ["right all", "left all"], "F": ["right all", "left all"]}
    assert mine.inputs.distance.sets["N"].bell == (0.0, 2.0, 3.0)
    assert mine.inputs.distance.sets["F"].gaussian == (5.0, 1.5)
    assert mine.inference.conjunction == "minimum"
    assert mine.controller().infer(1.0, 4.0).turn > 0.5


def test_the_numbers_of_the_sets_count_and_not_their_lines(tmp_path: Path) -> None:
    first, second = "MF1='N':'gbellmf',[2 3 0]", "MF2='F':'gaussmf',[1.5 5]"
    turned = TOOLBOX.replace(f"{first}\n{second}", f"{second}\n{first}")
    assert turned != TOOLBOX
    for name, text in (("a.fis", TOOLBOX), ("b.fis", turned)):
        (tmp_path / name).write_text(text)
    a, b = (load_controller(tmp_path / name) for name in ("a.fis", "b.fis"))
    assert outputs(a) == outputs(b)


# Mistakes


def refusal(text: str, tmp_path: Path, name: str = "mine.yaml") -> str:
    (tmp_path / name).write_text(text)
    with pytest.raises(UserError) as caught:
        load_controller(tmp_path / name)
    return "\n".join(caught.value.problems).replace(f"{tmp_path}/", "")


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("R short, S short, L short", "R short, S short",
         "mine.yaml:29: rules.near: needs 3 cells, for right, alike, left; got 2"),
        ("L short]", "X short]",
         "mine.yaml:29: rules.near[2]: (near, left): turn has no label 'X'; it has R, S, L"),
        ("L short]", "L]", "rules.near[2]: (near, left): expected the labels of turn"),
        ("  middle: [", "  midle: [",
         "mine.yaml:30: rules.midle: no label of distance; did you mean 'middle'? it has near, "),
        ("  far:    [S long,  S long,  S long]\n", "",
         "mine.yaml:27: rules: has no row far; it needs one for each label of distance"),
        ("triangular: [1, 2.5, 4]", "triangular: [1, 2.5]",
         "mine.yaml:7: inputs.distance.sets.middle.triangular: needs 3 values"),
        ("triangular: [1, 2.5, 4]", "triangular: [4, 2.5, 1]",
         "mine.yaml:7: inputs.distance.sets.middle.triangular: the numbers must rise, got [4, 2.5"),
        ("triangular: [1, 2.5, 4]", "triangular: [6, 7, 8]",
         "mine.yaml:7: inputs.distance.sets.middle: none of 1001 points of the range"),
        ("triangular: [1, 2.5, 4]", "triangel: [1, 2.5, 4]",
         "mine.yaml:7: inputs.distance.sets.middle.triangel: unknown key; did you mean 'tri"),
        ("triangular: [1, 2.5, 4]", "gaussian: [1, 0]",
         "inputs.distance.sets.middle.gaussian: the width must be at least 1e-06, got 0"),
        ("triangular: [1, 2.5, 4]", "gaussian: [.nan, 1]",
         "mine.yaml:7: inputs.distance.sets.middle.gaussian[0]: must be finite, got nan"),
        ("{triangular: [1, 2.5, 4]}", "{}",
         "mine.yaml:7: inputs.distance.sets.middle: needs one of gaussian, triangular"),
        ("{triangular: [1, 2.5, 4]}", "{triangular: [1, 2, 4], singleton: 2}",
         "got triangular and singleton"),
        ("middle: {triangular", "2nd: {triangular",
         "mine.yaml:7: inputs.distance.sets.'2nd': a label has letters, digits and '_'"),
        ("alike: {bell: [0, 1.5, 2]}", "alike: {singleton: 0}",
         "mine.yaml:13: inputs.difference.sets.alike: a singleton has no width"),
        ("average}", "centroid}", "mine.yaml:19: outputs.turn.sets.R: a singleton has no width"),
        ("singleton: -1.5", "singleton: -9", "mine.yaml:19: outputs.turn.sets.R: lies outside"),
        ("range: [0, 2]", "range: [-1, 2]", "mine.yaml:23: outputs.step.range: a step cannot be"),
        ("range: [-2, 2]", "range: [1, 2]", "mine.yaml:17: outputs.turn.range: straight on, 0"),
        ("range: [0, 5]", "range: [5, 0]", "mine.yaml:4: inputs.distance.range: its first number"),
        ("and: minimum", "and: maximum",
         "mine.yaml:32: inference.and: got 'maximum'; did you mean 'minimum'? allowed: product"),
        ("and: minimum", "end: minimum", "inference.end: unknown key; did you mean 'and'"),
        ("inputs:", "input:", "mine.yaml:2: input: unknown key; did you mean 'inputs'?"),
    ],
)  # fmt: skip
def test_a_mistake_is_told_with_file_line_and_key(
    old: str, new: str, line: str, tmp_path: Path
) -> None:
    assert old in THREE
    told = refusal(THREE.replace(old, new), tmp_path)
    assert any(one.startswith(line) or line in one for one in told.splitlines()), told


def test_a_set_that_no_sample_of_the_centroid_meets_is_refused(tmp_path: Path) -> None:
    narrow = SMOOTH.replace("trapezoidal: [0, 0, 0.4, 0.9]", "triangular: [0.201, 0.204, 0.207]")
    told = refusal(narrow, tmp_path)
    assert "outputs.step.sets.short: none of 101 points of the range belongs to it" in told
    (tmp_path / "fine.yaml").write_text(narrow + "inference: {samples: 2001}\n")
    assert load_controller(tmp_path / "fine.yaml").controller().infer(0.0, 0.0).stride > 0.1


def test_all_mistakes_are_told_at_once_in_the_order_of_the_lines(tmp_path: Path) -> None:
    text = THREE.replace("L short]", "X short]").replace("R long", "R lang")
    assert [one.split(": ")[1] for one in refusal(text, tmp_path).splitlines()] == [
        "rules.near[2]",
        "rules.middle[0]",
    ]


@pytest.mark.parametrize(
    ("name", "text", "complaint"),
    [
        ("mine.txt", THREE, "a file of rules ends in .yaml, .yml, .fll, .fis, got '.txt'"),
        ("mine.yaml", "- 1", "mine.yaml:1: expected a mapping with the keys inputs, outputs"),
        ("mine.yaml", "a: [", "mine.yaml:2: not valid YAML"),
        ("mine.fis", TOOLBOX.replace("'min'", "'product'"), "AndMethod: no method 'product'"),
        ("mine.fis", TOOLBOX.replace("2 2, 1 1 (1) : 1", "2 2, 1 9 (1) : 1"),
         "step has the sets 1 to 1, got 9"),
        ("mine.fis", TOOLBOX.replace("2 2, 1 1 (1) : 1\n", ""), "no rule for distance F and"),
        ("mine.fis", TOOLBOX.replace("2 2, 1 1 (1) : 1", "2 2, 1 1 (0.5) : 1"), "with weight 1"),
        ("mine.fis", TOOLBOX.replace("trimf',[0 1", "sigmf',[0 1"), "no kind of set 'sigmf'"),
        ("mine.fis", TOOLBOX.replace("[0 1 2]", "[0 1]"), "MF1: trimf needs 3 numbers, got 2"),
        ("mine.fis", TOOLBOX.replace("[0 1 2]", "[0 x 2]"), "expected a number, got 'x'"),
        ("mine.fis", TOOLBOX.replace("2 2, 1 1 (1) : 1", "2 2, 1 1 (.) : 1"), "expected a rule"),
        ("mine.fis", TOOLBOX.replace("MF2='F'", "MF1='F'"), "MF1' is there already"),
        ("mine.fis", "Name=1", "expected a section such as [System]"),
        ("mine.fll", "x", "expected KEY: VALUE"),
        ("mine.fll", "Engine: e\n", "needs one RuleBlock, got 0"),
    ],
)  # fmt: skip
def test_a_wrong_file_gets_one_line(name: str, text: str, complaint: str, tmp_path: Path) -> None:
    told = refusal(text, tmp_path, name)
    assert complaint in told
    assert len(told.splitlines()) == 1


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ("conjunction: AlgebraicProduct", "conjunction: EinsteinProduct", "no norm 'EinsteinProd"),
        ("implication: AlgebraicProduct", "implication: Minimum", "implication: must be Algebraic"),
        ("Centroid 101", "Bisector 101", "no defuzzifier 'Bisector'"),
        ("aggregation: Maximum", "aggregation: AlgebraicSum", "it must be Maximum"),
        ("then turn is L and", "then turn is L with 0.5 and", "without a weight"),
        (
            "  rule: if distance is far and difference is d",
            "  # if",
            "no rule for distance far and",
        ),
        ("near and difference is b", "near and difference is a", "there is one for near and a"),
        ("Gaussian 0.0 1.5", "Sigmoid 0.0 1.5", "no kind of set 'Sigmoid'"),
        ("InputVariable: difference", "InputVariable: distance", "needs two inputs"),
        ("InputVariable: difference", "InputVariable: step", "step is an input and an output"),
        ("activation: General", "activation: First", "activation: must be General"),
        ("default: nan", "default: 1.5", "default: must be nan"),
    ],
)
def test_a_wrong_engine_gets_one_line(old: str, new: str, complaint: str, tmp_path: Path) -> None:
    save_controller(DEFINITIONS["smooth"], tmp_path / "good.fll")
    text = (tmp_path / "good.fll").read_text()
    assert old in text
    told = refusal(text.replace(old, new), tmp_path, "mine.fll")
    assert complaint in told
    assert len(told.splitlines()) == 1


def test_a_gap_between_the_sets_is_told_and_allowed() -> None:
    text = THREE.replace("triangular: [1, 2.5, 4]", "triangular: [1.5, 2.5, 4]").replace(
        "[0, 0, 1, 2.5]", "[0, 0, 0.5, 1]"
    )
    gappy = ControllerDefinition.model_validate(yaml.safe_load(text))
    [(loc, why)] = gaps_of(gappy)
    assert loc == ("inputs", "distance", "sets")
    assert why.startswith("from 1 to 1.5 belongs to no set")
    fired = gappy.controller().infer(1.2, 0.0)
    assert (fired.turn, fired.stride) == (0.0, 0.0)
    assert all(gaps_of(one) == [] for one in DEFINITIONS.values())


@given(st.sampled_from(sorted(SHAPES)), st.lists(st.floats(-2000, 2000), min_size=1, max_size=4))
def test_whatever_numbers_a_set_is_given_it_is_made_or_refused(
    shape: str, numbers: list[float]
) -> None:
    data = yaml.safe_load(SMOOTH)
    data["inputs"]["distance"]["sets"]["near"] = {
        shape: numbers[0] if shape == "singleton" else numbers
    }
    try:
        definition = ControllerDefinition.model_validate(data)
    except ValueError:
        return
    for x in (0.0, 2.5, 5.0):
        assert 0.0 <= definition.controller().infer(x, 0.0).stride <= 2.0
