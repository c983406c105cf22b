"""The fuzzy engine: sets, rule tables, inference. Nothing here knows the paper's tables."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyq_bullet.fuzzy import FuzzyController, Method
from fuzzyq_bullet.fuzzy.inference import MamdaniInference
from fuzzyq_bullet.fuzzy.memberships import Gaussian, MembershipFunction, Singleton
from fuzzyq_bullet.fuzzy.rules import Rule, RuleBase
from fuzzyq_bullet.fuzzy.sets import FuzzySet, Variable


def variable(name: str, low: float, high: float, **sets: MembershipFunction) -> Variable:
    return Variable(name, (low, high), tuple(FuzzySet(label, one) for label, one in sets.items()))


TEMPERATURE = variable("temperature", 0.0, 10.0, LO=Gaussian(0, 2), HI=Gaussian(10, 2))
HUMIDITY = variable("humidity", 0.0, 1.0, DRY=Gaussian(0, 0.3), WET=Gaussian(1, 0.3))
HEAT = variable(
    "heat", 0.0, 3.0, OFF=Gaussian(0, 0.4), SOME=Gaussian(1, 0.4), FULL=Gaussian(3, 0.4)
)
FAN = variable("fan", -1.0, 1.0, IN=Gaussian(-1, 0.5), OUT=Gaussian(1, 0.5))
CELLS = ((("FULL", "IN"), ("SOME", "IN")), (("OFF", "IN"), ("OFF", "OUT")))
Cells = tuple[tuple[tuple[str, ...], ...], ...]


def base(cells: Cells = CELLS, row: Variable = TEMPERATURE) -> RuleBase:
    return RuleBase(row, HUMIDITY, (HEAT, FAN), cells)


def engine(rules: RuleBase, samples: int = 101) -> MamdaniInference:
    method = Method(samples=samples)
    return MamdaniInference(rules, method, fallback=(0.0,) * len(rules.outputs))


# Sets


@given(x=st.floats(0.0, 10.0))
def test_memberships_lie_between_0_and_1(x: float) -> None:
    degrees = TEMPERATURE.memberships(x)
    assert degrees.shape == (2,)
    assert ((degrees >= 0) & (degrees <= 1)).all()


def test_a_set_without_words_is_called_by_its_label() -> None:
    assert FuzzySet("VN", Gaussian(0, 1)).meaning == "VN"
    assert FuzzySet("VN", Gaussian(0, 1), "Very Near").meaning == "Very Near"
    named = FuzzySet("VN", Gaussian(0, 1), "Very Near", "close")
    assert (named.words, named.meaning) == ("Very Near", "close")


def test_two_sets_with_one_label_or_none_at_all_are_refused() -> None:
    one = FuzzySet("A", Gaussian(0, 1))
    with pytest.raises(ValueError, match="share a label"):
        Variable("v", (0.0, 1.0), (one, one))
    with pytest.raises(ValueError, match="no fuzzy sets"):
        Variable("v", (0.0, 1.0), ())


@pytest.mark.parametrize("domain", [(1.0, 1.0), (2.0, 1.0), (0.0, math.inf), (math.nan, 1.0)])
def test_an_empty_domain_is_refused(domain: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match="not a domain"):
        Variable("v", domain, HEAT.sets)


# Rules


def test_a_rule_table_is_read_row_by_row() -> None:
    assert list(base()) == [
        Rule("LO", "DRY", ("FULL", "IN")),
        Rule("LO", "WET", ("SOME", "IN")),
        Rule("HI", "DRY", ("OFF", "IN")),
        Rule("HI", "WET", ("OFF", "OUT")),
    ]


@pytest.mark.parametrize(
    ("cells", "complaint"),
    [
        (CELLS[:1], "1 rows of rules; temperature has the labels LO, HI"),
        ((CELLS[0], CELLS[1][:1]), "row HI has 1 cells"),
        ((CELLS[0], (("OFF", "IN"), ("OFF",))), r"\(HI, WET\).*one label each of heat, fan"),
        ((CELLS[0], (("OFF", "IN"), ("OUT", "OFF"))), r"\(HI, WET\): heat has no label 'OUT'"),
        ((CELLS[0], (("OFF", "IN"), ("OFF", "AWAY"))), "no label 'AWAY'; it has IN, OUT"),
    ],
)
def test_a_wrong_rule_table_is_refused_and_says_where(cells: Cells, complaint: str) -> None:
    with pytest.raises(ValueError, match=complaint):
        base(cells)


# Inference


def by_hand(rules: RuleBase, samples: int, x: float, y: float) -> list[float]:
    """Eqs. 2, 3, 4 and 22, one after the other, rule by rule and point by point."""

    def degree(variable: Variable, label: str, value: float) -> float:
        (one,) = (s for s in variable.sets if s.label == label)
        assert isinstance(one.function, Gaussian)
        return math.exp(-((value - one.center) ** 2) / (2 * one.function.width**2))

    results = []
    for k, output in enumerate(rules.outputs):
        low, high = output.domain
        moment = area = 0.0
        for j in range(samples):
            u = low + (high - low) * j / (samples - 1)
            total = max(
                degree(rules.row, rule.row, x)
                * degree(rules.column, rule.column, y)
                * degree(output, rule.then[k], u)
                for rule in rules
            )
            moment += u * total
            area += total
        results.append(moment / area)
    return results


@given(x=st.floats(0.0, 10.0), y=st.floats(0.0, 1.0), samples=st.integers(3, 40))
def test_inference_is_the_equations_written_out(x: float, y: float, samples: int) -> None:
    *_, values = engine(base(), samples).infer(x, y)
    # The same sums in another order: only rounding may differ.
    assert values == pytest.approx(by_hand(base(), samples, x, y), abs=1e-12)


def test_strengths_are_products_of_the_memberships() -> None:
    row, column, strengths, _ = engine(base()).infer(4.0, 0.3)
    assert row == pytest.approx(TEMPERATURE.memberships(4.0))
    assert column == pytest.approx(HUMIDITY.memberships(0.3))
    for i in range(2):
        for j in range(2):
            assert strengths[i][j] == pytest.approx(row[i] * column[j])


def two_rules() -> RuleBase:
    row = variable("row", 0.0, 10.0, A=Gaussian(0, 2))
    column = variable("column", 0.0, 1.0, B=Gaussian(0, 1), C=Gaussian(0, 1))
    output = variable("output", 0.0, 1.0, L=Gaussian(0, 0.2), M=Gaussian(0.7, 0.1))
    return RuleBase(row, column, (output,), ((("L",), ("M",)),))


def test_with_the_minimum_rules_cut_off_what_they_conclude() -> None:
    x, samples = 3.0, 201
    method = Method(conjunction="minimum", samples=samples)
    _, _, rules, (value,) = MamdaniInference(two_rules(), method, fallback=(0.0,)).infer(x, 0.0)
    strength = math.exp(-(x**2) / 8)
    assert rules == ((pytest.approx(strength),) * 2,)
    u = np.linspace(0, 1, samples)
    joint = np.minimum(
        strength, np.maximum(np.exp(-(u**2) / 0.08), np.exp(-((u - 0.7) ** 2) / 0.02))
    )
    assert value == pytest.approx((u * joint).sum() / joint.sum(), abs=1e-12)


@given(x=st.floats(0.0, 10.0), y=st.floats(0.0, 1.0))
def test_an_average_weighs_the_centers_by_the_strengths(x: float, y: float) -> None:
    method = Method(defuzzification="average")
    fired = MamdaniInference(base(), method, fallback=(0.0, 0.0)).infer(x, y)
    centers = np.array([[[3, -1], [1, -1]], [[0, -1], [0, 1]]], dtype=float)
    strengths = np.array(fired.rules)
    wanted = (centers * strengths[:, :, np.newaxis]).sum(axis=(0, 1)) / strengths.sum()
    assert fired.values == pytest.approx(wanted.tolist(), abs=1e-12)


def test_an_average_stays_within_the_domain_though_a_center_does_not() -> None:
    far = variable("heat", 0.0, 3.0, FULL=Gaussian(9, 4))
    rules = RuleBase(TEMPERATURE, HUMIDITY, (far,), ((("FULL",),) * 2,) * 2)
    method = Method(defuzzification="average")
    assert MamdaniInference(rules, method, fallback=(0.0,)).infer(1.0, 0.5).values == (3.0,)


def test_an_average_takes_singletons() -> None:
    heat = variable("heat", 0.0, 3.0, OFF=Singleton(0), SOME=Singleton(1), FULL=Singleton(3))
    rules = RuleBase(TEMPERATURE, HUMIDITY, (heat, FAN), CELLS)
    method = Method(defuzzification="average")
    exact = MamdaniInference(rules, method, fallback=(0.0, 0.0)).infer(2.0, 0.3)
    smooth = MamdaniInference(base(), method, fallback=(0.0, 0.0)).infer(2.0, 0.3)
    assert exact.values == smooth.values


def test_rules_scale_what_they_conclude_and_do_not_cut_it() -> None:
    # One set for each input and two for each output: both rules fire with the same strength. When
    # that falls, scaled sets keep their shape and the centroid stays; cut ones flatten and move.
    rules = two_rules()
    values = [engine(rules).infer(x, 0.0)[3][0] for x in (0.0, 2.0, 4.0, 8.0)]
    assert values == pytest.approx([values[0]] * 4, abs=1e-12)


def test_a_label_that_no_rule_concludes_has_no_say() -> None:
    never = tuple(tuple(("OFF", fan) for _, fan in row) for row in CELLS)
    *_, (heat, _) = engine(base(never)).infer(0.0, 0.0)
    u = np.linspace(0, 3, 101)
    off = HEAT.memberships(u)[0]
    assert heat == pytest.approx((u * off).sum() / off.sum(), abs=1e-12)


def test_outputs_may_have_labels_in_different_numbers_and_orders() -> None:
    mirrored = Variable("fan", FAN.domain, FAN.sets[::-1])
    rules = RuleBase(TEMPERATURE, HUMIDITY, (HEAT, mirrored), CELLS)
    assert engine(rules).infer(3.0, 0.4)[3] == engine(base()).infer(3.0, 0.4)[3]


@pytest.mark.parametrize("samples", [-1, 0, 1, 2])
def test_fewer_than_three_samples_are_refused(samples: int) -> None:
    with pytest.raises(ValueError, match="at least 3"):
        engine(base(), samples)


def test_every_output_needs_its_fallback() -> None:
    with pytest.raises(ValueError, match="1 fallback values for 2 outputs"):
        MamdaniInference(base(), Method(samples=5), fallback=(0.0,))


def test_a_controller_needs_a_turn_and_a_step() -> None:
    lone = RuleBase(TEMPERATURE, HUMIDITY, (HEAT,), ((("OFF",),) * 2,) * 2)
    with pytest.raises(ValueError, match="1 outputs"):
        FuzzyController(lone)


def test_where_no_rule_fires_the_controller_goes_straight_and_least_far() -> None:
    # So narrow that every membership between the two centers is 0 in floating point.
    narrow = variable("temperature", 0.0, 10.0, LO=Gaussian(0, 0.001), HI=Gaussian(10, 0.001))
    rules = RuleBase(narrow, HUMIDITY, (FAN, HEAT), ((("IN", "FULL"),) * 2, (("OUT", "SOME"),) * 2))
    for method in (Method(), Method(defuzzification="average")):
        inference = FuzzyController(rules, method).infer(5.0, 0.5)
        assert np.max(inference.rules) == 0.0
        assert (inference.turn, inference.stride) == (0.0, HEAT.domain[0])
