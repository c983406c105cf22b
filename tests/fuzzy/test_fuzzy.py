"""The fuzzy engine: sets, rule tables, inference. Nothing here knows the paper's tables."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyq_bullet.fuzzy import FuzzyController
from fuzzyq_bullet.fuzzy.inference import ProductInference
from fuzzyq_bullet.fuzzy.rules import Rule, RuleBase
from fuzzyq_bullet.fuzzy.sets import FuzzySet, Variable

TEMPERATURE = Variable.parse("temperature", (0.0, 10.0), "LO low [2 0]\n HI high [2 10]")
HUMIDITY = Variable.parse("humidity", (0.0, 1.0), "DRY dry [0.3 0]\n WET wet [0.3 1]")
HEAT = Variable.parse("heat", (0.0, 3.0), "OFF off [0.4 0]\n SOME some [0.4 1]\n FULL full [0.4 3]")
FAN = Variable.parse("fan", (-1.0, 1.0), "IN in [0.5 -1]\n OUT out [0.5 1]")
TABLE = """
         DRY         WET
    LO: [FULL IN]  [SOME IN]
    HI: [OFF IN]   [OFF OUT]
"""


def base(table: str = TABLE, **changes: Variable) -> RuleBase:
    row, column = changes.get("row", TEMPERATURE), changes.get("column", HUMIDITY)
    return RuleBase.parse(table, row=row, column=column, outputs=(HEAT, FAN))


def engine(rules: RuleBase, samples: int = 101) -> ProductInference:
    return ProductInference(rules, samples=samples, fallback=(0.0,) * len(rules.outputs))


# Sets


def test_a_gaussian_is_one_at_its_center_and_falls_by_its_width() -> None:
    one = FuzzySet("A", "a", width=0.5, center=2.0)
    assert one.membership(2.0) == 1.0
    assert one.membership(2.5) == pytest.approx(math.exp(-0.5))
    assert one.membership(1.0) == pytest.approx(math.exp(-2.0))


@given(x=st.floats(0.0, 10.0))
def test_memberships_lie_between_0_and_1(x: float) -> None:
    degrees = TEMPERATURE.memberships(x)
    assert degrees.shape == (2,)
    assert ((degrees >= 0) & (degrees <= 1)).all()


def test_a_table_of_sets_is_read_as_it_stands() -> None:
    variable = Variable.parse("v", (-1.0, 1.0), "\n VN  Very Near  [1.100 -0.30]\n\n F Far [2 1]\n")
    assert variable.sets == (
        FuzzySet("VN", "Very Near", 1.1, -0.3),
        FuzzySet("F", "Far", 2.0, 1.0),
    )
    assert variable.words("VN") == "Very Near"


@pytest.mark.parametrize(
    ("table", "complaint"),
    [
        ("A a [1]", "LABEL words"),
        ("A a [1 2 3]", "LABEL words"),
        ("A a [wide 0]", "LABEL words"),
        ("A a", "LABEL words"),
        ("A a [0 1]", "positive width"),
        ("A a [-1 1]", "positive width"),
        ("A a [1 nan]", "positive width"),
        ("A a [1 0]\nA b [1 1]", "share a label"),
        ("", "no fuzzy sets"),
    ],
)
def test_a_wrong_table_of_sets_is_refused(table: str, complaint: str) -> None:
    with pytest.raises(ValueError, match=complaint):
        Variable.parse("v", (0.0, 1.0), table)


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


def test_aliases_are_read_once_and_only_for_their_own_output() -> None:
    # DRY means WET and WET means DRY: read twice, or for both outputs, nothing would change.
    swapped = RuleBase.parse(
        TABLE.replace("FULL", "OFF").replace("SOME", "OFF"),
        row=TEMPERATURE,
        column=HUMIDITY,
        outputs=(HEAT, FAN),
        aliases=({}, {"IN": "OUT", "OUT": "IN"}),
    )
    assert [rule.then for rule in swapped] == [
        ("OFF", "OUT"),
        ("OFF", "OUT"),
        ("OFF", "OUT"),
        ("OFF", "IN"),
    ]


@pytest.mark.parametrize(
    ("table", "complaint"),
    [
        (TABLE.replace("DRY         WET", "WET DRY"), "columns"),
        (TABLE.replace("HI:", "LO:"), "rows"),
        (TABLE.replace("HI:", "XX:"), "rows"),
        (TABLE[: TABLE.index("HI")], "rows"),
        (TABLE.replace("HI:", "HI"), "not 'ROW"),
        (TABLE.replace("[OFF OUT]", "[OFF OUT"), "not 'ROW"),
        (TABLE.replace("[OFF OUT]", ""), "row HI has 1 cells"),
        (TABLE.replace("[OFF OUT]", "[OFF]"), r"\(HI, WET\).*one label each of heat, fan"),
        (TABLE.replace("[OFF OUT]", "[OUT OFF]"), r"\(HI, WET\): heat has no label 'OUT'"),
        (TABLE.replace("[OFF OUT]", "[OFF AWAY]"), "fan has no label 'AWAY'; it has IN, OUT"),
    ],
)
def test_a_wrong_rule_table_is_refused_and_says_where(table: str, complaint: str) -> None:
    with pytest.raises(ValueError, match=complaint):
        base(table)


# Inference


def by_hand(rules: RuleBase, samples: int, x: float, y: float) -> list[float]:
    """Eqs. 2, 3, 4 and 22, one after the other, rule by rule and point by point."""

    def degree(variable: Variable, label: str, value: float) -> float:
        (one,) = (s for s in variable.sets if s.label == label)
        return math.exp(-((value - one.center) ** 2) / (2 * one.width**2))

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


def test_rules_scale_what_they_conclude_and_do_not_cut_it() -> None:
    # One set for each input and two for each output: both rules fire with the same strength. When
    # that falls, scaled sets keep their shape and the centroid stays; cut ones flatten and move.
    row = Variable.parse("row", (0.0, 10.0), "A a [2 0]")
    column = Variable.parse("column", (0.0, 1.0), "B b [1 0]\nC c [1 0]")
    output = Variable.parse("output", (0.0, 1.0), "L less [0.2 0]\nM more [0.1 0.7]")
    rules = RuleBase.parse("B C\nA: [L] [M]", row=row, column=column, outputs=(output,))
    values = [engine(rules).infer(x, 0.0)[3][0] for x in (0.0, 2.0, 4.0, 8.0)]
    assert values == pytest.approx([values[0]] * 4, abs=1e-12)


def test_a_label_that_no_rule_concludes_has_no_say() -> None:
    never = TABLE.replace("SOME", "OFF").replace("FULL", "OFF")
    *_, (heat, _) = engine(base(never)).infer(0.0, 0.0)
    u = np.linspace(0, 3, 101)
    off = HEAT.memberships(u)[0]
    assert heat == pytest.approx((u * off).sum() / off.sum(), abs=1e-12)


def test_outputs_may_have_labels_in_different_numbers_and_orders() -> None:
    mirrored = Variable("fan", FAN.domain, FAN.sets[::-1])
    rules = RuleBase.parse(TABLE, row=TEMPERATURE, column=HUMIDITY, outputs=(HEAT, mirrored))
    assert engine(rules).infer(3.0, 0.4)[3] == engine(base()).infer(3.0, 0.4)[3]


@pytest.mark.parametrize("samples", [-1, 0, 1, 2])
def test_fewer_than_three_samples_are_refused(samples: int) -> None:
    with pytest.raises(ValueError, match="at least 3"):
        engine(base(), samples)


def test_every_output_needs_its_fallback() -> None:
    with pytest.raises(ValueError, match="1 fallback values for 2 outputs"):
        ProductInference(base(), samples=5, fallback=(0.0,))


def test_a_controller_needs_a_turn_and_a_step() -> None:
    lone = RuleBase(TEMPERATURE, HUMIDITY, (HEAT,), ((("OFF",),) * 2,) * 2)
    with pytest.raises(ValueError, match="1 outputs"):
        FuzzyController(lone)


def test_where_no_rule_fires_the_controller_goes_straight_and_least_far() -> None:
    # So narrow that every membership between the two centers is 0 in floating point.
    narrow = Variable.parse("temperature", (0.0, 10.0), "LO low [0.001 0]\nHI high [0.001 10]")
    rules = RuleBase.parse(TABLE, row=narrow, column=HUMIDITY, outputs=(FAN, HEAT), aliases=(
        {"FULL": "IN", "SOME": "IN", "OFF": "OUT"}, {"IN": "FULL", "OUT": "SOME"},
    ))  # fmt: skip
    inference = FuzzyController(rules).infer(5.0, 0.5)
    assert np.max(inference.rules) == 0.0
    assert (inference.turn, inference.stride) == (0.0, HEAT.domain[0])
