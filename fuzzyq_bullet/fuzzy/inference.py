"""Mamdani inference: the rules fire, meet by maximum, and become numbers (Eqs. 2–5 and 22).

``MamdaniInference`` takes any rule base of two inputs; ``FuzzyController`` has a turn and a step.

All that does not depend on the inputs is computed once.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fuzzyq_bullet.fuzzy.memberships import Floats
    from fuzzyq_bullet.fuzzy.rules import RuleBase

LEAST_SAMPLES = 3
_NO_AREA = 1e-300
"""Below this, sums of memberships lose their digits, and a centroid would be noise."""


class Method(NamedTuple):
    """How rules are combined, and how what they conclude becomes a number.

    Attributes:
        conjunction: What "and" and "then" are: the product (the paper's), which scales what a rule
            concludes; or the minimum, which cuts it off.
        defuzzification: ``centroid`` of the joint conclusions (the paper's); or ``average`` of the
            centers of what the rules conclude, weighed by how strongly they fire.
        samples: n of Eq. 22: points over each output's domain, its two ends included.
    """

    conjunction: Literal["product", "minimum"] = "product"
    defuzzification: Literal["centroid", "average"] = "centroid"
    samples: int = 101


USUAL = Method()
"""How the paper infers, with enough samples."""


class Fired(NamedTuple):
    """One inference, in plain numbers.

    Attributes:
        row: Memberships of the row variable, shape (R,).
        column: Memberships of the column variable, shape (C,).
        rules: Firing strengths of the rules (Eq. 2), shape (R, C).
        values: For each output its number (Eq. 22), or its fallback where no rule fires.
    """

    row: tuple[float, ...]
    column: tuple[float, ...]
    rules: tuple[tuple[float, ...], ...]
    values: tuple[float, ...]


class MamdaniInference:
    """Mamdani inference over a rule base of two inputs.

    Attributes:
        base: The rules, and through them the variables.
        method: How they are combined, and what becomes of them.
    """

    __slots__ = (
        "_centers",
        "_column_sets",
        "_concluding",
        "_domains",
        "_fallback",
        "_moments",
        "_row_sets",
        "_sampled",
        "base",
        "method",
    )

    def __init__(self, base: RuleBase, method: Method, *, fallback: Sequence[float]) -> None:
        """Sample every output set and sort the rules by the label that they conclude.

        Args:
            base: The rules.
            method: How to infer.
            fallback: For each output, the value where no rule fires to any measurable degree.

        Raises:
            ValueError: If there are too few samples, or ``fallback`` has not one value an output.
        """
        samples = method.samples
        if samples < LEAST_SAMPLES:
            raise ValueError(f"{samples} samples; Eq. 22 needs at least {LEAST_SAMPLES}")
        if len(fallback) != len(base.outputs):
            raise ValueError(f"{len(fallback)} fallback values for {len(base.outputs)} outputs")
        self.base = base
        self.method = method
        self._fallback = tuple(fallback)

        self._row_sets, self._column_sets = (
            [one.function for one in variable.sets] for variable in (base.row, base.column)
        )
        grids = [np.linspace(*output.domain, samples) for output in base.outputs]
        # The aggregates of all outputs, end to end, times this are first every Σ u·μ(u), then every
        # Σ μ(u): one small product instead of a pair for each output.
        count = len(grids)
        moments = np.zeros((count, samples, 2 * count))
        for k, u in enumerate(grids):
            moments[k, :, k] = u
            moments[k, :, count + k] = 1.0
        self._moments = moments.reshape(count * samples, 2 * count)

        # Every concluded label of every output, with the numbers of the rules that conclude it.
        rules = list(base)
        concluded = [
            {
                label: [i for i, rule in enumerate(rules) if rule.then[k] == label]
                for label in output.labels
                if any(rule.then[k] == label for rule in rules)
            }
            for k, output in enumerate(base.outputs)
        ]
        # Where there are fewer labels or rules, some are repeated: that changes no maximum.
        most = max(map(len, concluded))
        longest = max(len(numbers) for labels in concluded for numbers in labels.values())
        self._concluding = np.empty((most, count, longest), dtype=np.intp)
        self._sampled = np.empty((most, count, samples))
        for slot in range(most):
            for k, (output, u, labels) in enumerate(
                zip(base.outputs, grids, concluded, strict=True)
            ):
                name = list(labels)[slot % len(labels)]
                self._concluding[slot, k] = np.resize(labels[name], longest)
                self._sampled[slot, k] = output.memberships(u)[output.labels.index(name)]
        # For each rule the centers of what it concludes, and a 1 to add up the strengths.
        self._centers = np.array(
            [
                [
                    *(o.set_of(to).center for o, to in zip(base.outputs, rule.then, strict=True)),
                    1.0,
                ]
                for rule in rules
            ]
        )
        self._domains = [output.domain for output in base.outputs]

    def infer(self, x: float, y: float) -> Fired:
        """Fuzzify, fire the rules, aggregate and defuzzify.

        Args:
            x: Value of the row variable, within its domain.
            y: Value of the column variable, within its domain.

        Returns:
            What fired, and how strongly.
        """
        row = tuple([one.degree(x) for one in self._row_sets])
        column = tuple([one.degree(y) for one in self._column_sets])
        combine: np.ufunc = np.multiply if self.method.conjunction == "product" else np.minimum
        rules = combine.outer(row, column)
        values = (
            self._centroids(rules, combine)
            if self.method.defuzzification == "centroid"
            else self._averages(rules)
        )
        return Fired(row, column, tuple(map(tuple, rules.tolist())), values)

    def _centroids(self, rules: Floats, combine: np.ufunc) -> tuple[float, ...]:
        # Eqs. 3 and 4. Rules that conclude the same set differ only in their strength, so the
        # largest of them is that set times (or cut at) the largest strength.
        labels = rules.ravel()[self._concluding].max(axis=2, keepdims=True)
        aggregate = np.maximum.reduce(combine(labels, self._sampled))

        sums = aggregate.ravel().dot(self._moments).tolist()
        count = len(self._fallback)
        return tuple(
            [
                moment / area if area > _NO_AREA else fallback
                for moment, area, fallback in zip(
                    sums[:count], sums[count:], self._fallback, strict=True
                )
            ]
        )

    def _averages(self, rules: Floats) -> tuple[float, ...]:
        *sums, strength = rules.ravel().dot(self._centers).tolist()
        if strength <= _NO_AREA:
            return self._fallback
        # A center may lie outside the domain; a value may not.
        return tuple(
            [
                min(max(total / strength, low), high)
                for total, (low, high) in zip(sums, self._domains, strict=True)
            ]
        )


class Inference(NamedTuple):
    """One inference of the controller, with everything that led to it.

    Attributes:
        near: Memberships of the distance in each of its labels, shape (R,).
        side: Memberships of the difference in each of its labels, shape (C,).
        rules: Firing strengths (Eq. 2), shape (R, C): a row for each label of the
            distance, a column for each of the difference.
        turn: N_a, the scale of the turn, positive to the left.
        stride: N_s, the scale of the step.
    """

    near: tuple[float, ...]
    side: tuple[float, ...]
    rules: tuple[tuple[float, ...], ...]
    turn: float
    stride: float


class FuzzyController:
    """Turn and step from the distance ahead and the difference of the sides.

    It has no memory: the same inputs give the same outputs.

    Attributes:
        base: The rule table, with rows of the distance, columns of the difference and the outputs
            (turn, step).
        method: How it infers.
    """

    __slots__ = ("_engine", "base", "method")

    def __init__(self, base: RuleBase, method: Method = USUAL) -> None:
        """Prepare the inference.

        If no rule fires, the controller does not turn and takes the smallest step. With Gaussian
        sets that cover their domain this never happens.

        Raises:
            ValueError: If the rules have not two outputs, or there are fewer than 3 samples.
        """
        if len(base.outputs) != 2:
            raise ValueError(f"{len(base.outputs)} outputs; the controller has a turn and a step")
        self.base = base
        self.method = method
        straight = base.outputs[0].clip(0.0)
        self._engine = MamdaniInference(
            base, method, fallback=(straight, base.outputs[1].domain[0])
        )

    def infer(self, distance: float, difference: float) -> Inference:
        """Return turn and step for one pair of inputs, each clipped to its domain first.

        Args:
            distance: d, in the unit of its table.
            difference: Df, in the unit of its table; positive means more room on the left.

        Raises:
            ValueError: If an input is not a number.
        """
        near, side, rules, (turn, stride) = self._engine.infer(
            self.base.row.clip(distance), self.base.column.clip(difference)
        )
        return Inference(near, side, rules, turn, stride)
