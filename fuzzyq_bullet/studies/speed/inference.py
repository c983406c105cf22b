"""How fast the controller infers, against pyfuzzylite, an engine written by others.

pyfuzzylite is not needed to run anything else, so it is imported only when a twin is built.
"""

from __future__ import annotations

from statistics import median
from typing import Any

import numpy as np

from fuzzyq_bullet.fuzzy import paper_controller
from fuzzyq_bullet.fuzzy.inference import FuzzyController
from fuzzyq_bullet.fuzzy.sets import Variable
from fuzzyq_bullet.studies.speed import Row, interleaved, median_ratio


def controller(rounds: int, rate: int) -> list[Row]:
    """Return how many times faster one inference is than that of a twin."""
    mine = paper_controller()
    what = "one inference against pyfuzzylite"
    try:
        twin = FuzzyliteTwin(mine)
    except ImportError:
        return [Row(what, None, 80.0, "at least", "pyfuzzylite is not installed (extra: test)")]
    rng = np.random.default_rng(0)
    inputs = np.column_stack([rng.uniform(0, 5, 100), rng.uniform(-5, 5, 100)]).tolist()
    repeats = 20

    def ours() -> None:
        for _ in range(repeats):
            for d, df in inputs:
                mine.infer(d, df)

    def theirs() -> None:
        for d, df in inputs:
            twin.infer(d, df)

    own, other = interleaved([ours, theirs], rounds)
    each, twins = ([t / n for t in times] for times, n in ((own, 100 * repeats), (other, 100)))
    detail = f"{1e6 * median(each):.1f} µs against {1e6 * median(twins):.0f} µs"
    return [Row(what, median_ratio(twins, each), 80.0, "at least", detail)]


class FuzzyliteTwin:
    """A pyfuzzylite engine with the variables and rules of one of our controllers."""

    def __init__(self, controller: FuzzyController, *, resolution: int = 101) -> None:
        """Write the controller in the FuzzyLite Language and let pyfuzzylite read it.

        Args:
            controller: Whose tables to take.
            resolution: Points of the centroid; pyfuzzylite samples the middles of as many equal
                parts of the domain.

        Raises:
            ModuleNotFoundError: If pyfuzzylite is not installed.
        """
        from fuzzylite import FllImporter

        self._engine: Any = FllImporter().from_string(fll(controller, resolution=resolution))
        base = controller.base
        self._inputs = [self._engine.input_variable(one.name) for one in (base.row, base.column)]
        self._outputs = [self._engine.output_variable(one.name) for one in base.outputs]

    def infer(self, distance: float, difference: float) -> tuple[float, float]:
        """Return (turn, step) for one pair of inputs."""
        for variable, value in zip(self._inputs, (distance, difference), strict=True):
            variable.value = value
        self._engine.process()
        # Version 8 answers with arrays of one number, version 7 with numbers.
        turn, step = (np.asarray(output.value, dtype=float).item() for output in self._outputs)
        return turn, step


def fll(controller: FuzzyController, *, resolution: int) -> str:
    """Return the controller in the FuzzyLite Language.

    "And" and "then" are products (Eqs. 2 and 3), rules meet by maximum (Eq. 4), and the centroid
    (Eq. 22) has ``resolution`` points.
    """
    base = controller.base
    lines = ["Engine: paper"]
    for variable in (base.row, base.column):
        lines += [f"InputVariable: {variable.name}", *_domain(variable), "  lock-range: true"]
        lines += _terms(variable)
    for variable in base.outputs:
        lines += [f"OutputVariable: {variable.name}", *_domain(variable), "  lock-range: false"]
        lines += ["  aggregation: Maximum", f"  defuzzifier: Centroid {resolution}"]
        lines += ["  default: nan", "  lock-previous: false", *_terms(variable)]
    lines += ["RuleBlock:", "  enabled: true", "  conjunction: AlgebraicProduct"]
    lines += ["  disjunction: none", "  implication: AlgebraicProduct", "  activation: General"]
    for rule in base:
        then = " and ".join(
            f"{output.name} is {label}"
            for output, label in zip(base.outputs, rule.then, strict=True)
        )
        lines.append(
            f"  rule: if {base.row.name} is {rule.row} and {base.column.name} is {rule.column}"
            f" then {then}"
        )
    return "\n".join(lines)


def _domain(variable: Variable) -> list[str]:
    low, high = variable.domain
    return ["  enabled: true", f"  range: {low!r} {high!r}"]


def _terms(variable: Variable) -> list[str]:
    return [f"  term: {one.label} Gaussian {one.center!r} {one.width!r}" for one in variable.sets]
