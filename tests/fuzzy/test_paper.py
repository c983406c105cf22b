"""The paper's controller: what Tables 2–4 promise, and what the readings of them repair."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyq_bullet.fuzzy import FuzzyController, Method, RuleTable, paper_controller
from fuzzyq_bullet.fuzzy.memberships import Gaussian
from fuzzyq_bullet.fuzzy.sets import FuzzySet, Variable
from fuzzyq_bullet.studies.speed.inference import FuzzyliteTwin

RULES = {table: paper_controller(table).base for table in ("corrected", "printed")}
DISTANCE, DIFFERENCE = RULES["corrected"].row, RULES["corrected"].column
TURN, STEP = RULES["corrected"].outputs


def width(one: FuzzySet) -> float:
    assert isinstance(one.function, Gaussian)
    return one.function.width


distances = st.floats(0.0, 5.0)
differences = st.floats(-5.0, 5.0)
tables = st.sampled_from(["corrected", "printed"])
sample_counts = st.sampled_from([3, 4, 5, 101])

# Two orders of summing 101 numbers near 1: rounding and nothing else.
ROUNDING = 1e-12


# The tables


def test_table_2_and_3_name_what_the_paper_names() -> None:
    assert DISTANCE.labels == ("VN", "N", "M", "F", "VF")
    assert DIFFERENCE.labels == ("NB", "NS", "ZO", "PS", "PB")
    assert STEP.labels == ("VL", "L", "ME", "M", "VM")
    assert TURN.labels == ("NL", "NS", "ZO", "PS", "PL")
    assert (TURN.domain, STEP.domain) == ((-2.0, 2.0), (0.0, 2.0))


@pytest.mark.parametrize("variable", [TURN, STEP], ids=lambda variable: variable.name)
def test_the_completion_of_table_3_crosses_at_one_half_and_is_symmetric(
    variable: Variable,
) -> None:
    for left, right in zip(variable.sets, variable.sets[1:], strict=False):
        crossing = left.center + (right.center - left.center) * width(left) / (
            width(left) + width(right)
        )
        # The table gives three decimals of the widths: 0.5 to about two.
        assert left.function.degree(crossing) == pytest.approx(0.5, abs=0.01)
    middle = sum(variable.domain)
    for one, mirror in zip(variable.sets, reversed(variable.sets), strict=True):
        assert width(one) == width(mirror)
        assert one.center == pytest.approx(middle - mirror.center)


def test_the_printed_table_differs_from_the_corrected_in_two_places() -> None:
    pairs = zip(RULES["printed"], RULES["corrected"], strict=True)
    departures = {(a.row, a.column): (a.then, b.then) for a, b in pairs if a != b}
    assert departures == {
        ("VN", "NS"): (("PL", "VL"), ("NL", "VL")),
        ("N", "ZO"): (("NL", "ME"), ("ZO", "L")),
        ("N", "PS"): (("NL", "M"), ("PS", "L")),
        ("N", "PB"): (("NL", "VM"), ("PL", "L")),
    }


def test_the_corrected_table_is_its_own_mirror() -> None:
    mirror = dict(zip(TURN.labels, reversed(TURN.labels), strict=True))
    for cells in RULES["corrected"].cells:
        turns = [turn for turn, _ in cells]
        assert turns == [mirror[turn] for turn in reversed(turns)]
        assert len({step for _, step in cells}) == 1


def test_as_printed_the_robot_turns_where_there_is_no_room() -> None:
    printed = paper_controller("printed")
    corrected = paper_controller("corrected")
    # Very near, and less room on the left: (VN, NS).
    assert printed.infer(0.0, -2.22).turn > 0.5
    assert corrected.infer(0.0, -2.22).turn < -0.5
    # Near, and more room on the left: row N.
    assert printed.infer(1.49, 4.0).turn < -0.5
    assert corrected.infer(1.49, 4.0).turn > 0.5
    # Near, nothing to choose between the sides: a large step, and to the right.
    assert printed.infer(1.49, 0.0).turn < -0.5
    assert printed.infer(1.49, 0.0).stride > corrected.infer(1.49, 0.0).stride + 0.2


# An engine by others


@pytest.mark.parametrize("rules", ["corrected", "printed"])
def test_pyfuzzylite_agrees(rules: RuleTable) -> None:
    pytest.importorskip("fuzzylite", reason="it does not take NumPy 2")
    controller = paper_controller(rules)
    twin = FuzzyliteTwin(controller)
    for distance in np.linspace(0.0, 5.0, 21):
        for difference in np.linspace(-5.0, 5.0, 21):
            ours = controller.infer(distance, difference)
            turn, step = twin.infer(distance, difference)
            # It samples the middles of 101 parts, Eq. 22 both ends: half a part, 0.02 of a turn.
            assert ours.turn == pytest.approx(turn, abs=0.02)
            assert ours.stride == pytest.approx(step, abs=0.01)


# Any inputs


@given(distances, differences, tables, sample_counts)
def test_outputs_stay_within_their_domains(
    distance: float, difference: float, rules: RuleTable, samples: int
) -> None:
    inference = paper_controller(rules, samples).infer(distance, difference)
    assert -2.0 <= inference.turn <= 2.0
    assert 0.0 <= inference.stride <= 2.0
    for degrees in (inference.near, inference.side, inference.rules):
        assert np.min(degrees) >= 0.0
        assert np.max(degrees) <= 1.0
    # Table 2 leaves no gap: everything belongs to something.
    assert max(inference.near) > 0.4
    assert max(inference.side) > 0.4


@given(st.floats(5.0, math.inf), st.floats(5.0, math.inf))
def test_inputs_are_clipped_to_their_domains(far: float, wide: float) -> None:
    controller = paper_controller()
    assert controller.infer(far, wide).turn == controller.infer(5.0, 5.0).turn
    assert controller.infer(-far, -wide).stride == controller.infer(0.0, -5.0).stride
    assert controller.infer(-far, -wide).side == controller.infer(0, -5).side


@pytest.mark.parametrize(("distance", "difference"), [(math.nan, 0.0), (1.0, math.nan)])
def test_not_a_number_is_refused(distance: float, difference: float) -> None:
    with pytest.raises(ValueError, match="not a number"):
        paper_controller().infer(distance, difference)


@given(distances, differences)
def test_it_has_no_memory(distance: float, difference: float) -> None:
    controller = paper_controller()
    first = controller.infer(distance, difference)
    controller.infer(2.0 - distance, -difference)
    assert controller.infer(distance, difference) == first


@given(distances, differences, differences, sample_counts)
def test_the_step_depends_on_the_distance_alone(
    distance: float, one: float, other: float, samples: int
) -> None:
    # A row of the corrected table names one step, so Df only scales all of them alike. This holds
    # for product inference only: clipping (minimum) changes their shapes.
    controller = paper_controller("corrected", samples)
    strides = [controller.infer(distance, difference).stride for difference in (one, other)]
    assert strides[0] == pytest.approx(strides[1], abs=ROUNDING)


@given(distances, distances, differences, sample_counts)
def test_more_room_ahead_never_shortens_the_step(
    one: float, other: float, difference: float, samples: int
) -> None:
    controller = paper_controller("corrected", samples)
    near, far = sorted((one, other))
    assert (
        controller.infer(near, difference).stride
        <= controller.infer(far, difference).stride + ROUNDING
    )


@given(distances, differences, differences)
def test_more_room_on_the_left_never_turns_further_right(
    distance: float, one: float, other: float
) -> None:
    controller = paper_controller()
    less, more = sorted((one, other))
    assert controller.infer(distance, less).turn <= controller.infer(distance, more).turn + ROUNDING


@given(distances, st.floats(0.05, 5.0))
def test_the_turn_is_to_the_side_with_more_room(distance: float, difference: float) -> None:
    # Below 0.05·S_p, a centimetre, PB's greater width may outweigh the difference.
    controller = paper_controller()
    assert controller.infer(distance, difference).turn > 0.0
    assert controller.infer(distance, -difference).turn < 0.0


@given(distances, differences, sample_counts)
def test_left_and_right_are_alike_once_pb_mirrors_nb(
    distance: float, difference: float, samples: int
) -> None:
    nb, *others, pb = DIFFERENCE.sets
    mirrored = dataclasses.replace(pb, function=Gaussian(-nb.center, width(nb)))
    column = dataclasses.replace(DIFFERENCE, sets=(nb, *others, mirrored))
    controller = FuzzyController(
        dataclasses.replace(RULES["corrected"], column=column), Method(samples=samples)
    )
    there, back = (controller.infer(distance, sign * difference) for sign in (1, -1))
    assert there.turn == pytest.approx(-back.turn, abs=ROUNDING)
    assert there.stride == pytest.approx(back.stride, abs=ROUNDING)


@given(distances, differences)
def test_as_printed_pb_spoils_that_by_little(distance: float, difference: float) -> None:
    controller = paper_controller()
    there, back = (controller.infer(distance, sign * difference) for sign in (1, -1))
    # Measured on a grid: at most 0.0395, one hundredth of the domain of the turn.
    assert there.turn == pytest.approx(-back.turn, abs=0.045)


def test_the_mirror_is_not_perfect_as_printed() -> None:
    assert (
        abs(paper_controller().infer(1.95, -0.3).turn + paper_controller().infer(1.95, 0.3).turn)
        > 0.01
    )


@given(distances, differences, distances, differences)
def test_small_changes_of_the_inputs_make_small_changes_of_the_outputs(
    d1: float, df1: float, d2: float, df2: float
) -> None:
    controller = paper_controller()
    a, b = controller.infer(d1, df1), controller.infer(d2, df2)
    # Slopes measured on a grid: turn 1.28 over d and 0.98 over Df, step 0.77 over d.
    assert abs(a.turn - b.turn) <= 1.4 * abs(d1 - d2) + 1.1 * abs(df1 - df2) + ROUNDING
    assert abs(a.stride - b.stride) <= 0.85 * abs(d1 - d2) + ROUNDING


# n of Eq. 22


@given(distances, differences)
def test_five_points_are_a_rough_picture_of_101(distance: float, difference: float) -> None:
    rough = paper_controller(samples=5).infer(distance, difference)
    fine = paper_controller(samples=101).infer(distance, difference)
    # At most 0.3659 (d = 0.78, Df = 2.60) and 0.1673 (4.22, 2.23), on a grid of 1/32 that was made
    # finer about its maximum: a third of the distance between two points of n = 5.
    assert rough.turn == pytest.approx(fine.turn, abs=0.367)
    assert rough.stride == pytest.approx(fine.stride, abs=0.17)


@given(distances, st.floats(2.0, 5.0), st.sampled_from([-1, 1]))
def test_five_points_turn_harder(distance: float, size: float, sign: int) -> None:
    # The end points weigh a fifth each instead of a hundredth: why n = 5 costs steps in clutter.
    rough = paper_controller(samples=5).infer(distance, sign * size)
    fine = paper_controller(samples=101).infer(distance, sign * size)
    assert abs(rough.turn) > abs(fine.turn)


@given(distances, differences)
def test_more_points_than_101_change_little(distance: float, difference: float) -> None:
    one = paper_controller(samples=101).infer(distance, difference)
    many = paper_controller(samples=2001).infer(distance, difference)
    # One part in a hundred of the domains, 4 and 2, at most half of it from each end.
    assert one.turn == pytest.approx(many.turn, abs=0.02)
    assert one.stride == pytest.approx(many.stride, abs=0.01)


# The door


def test_the_controller_is_made_once() -> None:
    assert paper_controller() is paper_controller("corrected", 101)
    assert paper_controller() is paper_controller(samples=101, rules="corrected")
    assert paper_controller("printed") is not paper_controller("corrected")


def test_unknown_tables_and_too_few_samples_are_refused() -> None:
    with pytest.raises(ValueError, match="there are corrected, printed"):
        paper_controller("improved")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="at least 3"):
        paper_controller(samples=2)


def test_an_inference_cannot_be_changed() -> None:
    inference = paper_controller().infer(1.0, 1.0)
    with pytest.raises(AttributeError):
        inference.turn = 0.0  # type: ignore[misc]
    assert not hasattr(inference, "__dict__")
    hash(inference)  # nor can anything in it
