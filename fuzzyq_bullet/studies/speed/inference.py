"""How fast the controller infers, against pyfuzzylite, an engine written by others.

pyfuzzylite is not needed to run anything else, so it is imported only when a twin is built.
"""

from __future__ import annotations

from statistics import median
from typing import Any

import numpy as np

from fuzzyq_bullet.fuzzy import FuzzyController, definition_of, paper_controller
from fuzzyq_bullet.fuzzy.formats import fll
from fuzzyq_bullet.fuzzy.formats.lines import INPUTS, OUTPUTS
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

    def __init__(self, controller: FuzzyController) -> None:
        """Write the controller in the FuzzyLite Language and let pyfuzzylite read it.

        Args:
            controller: Whose tables to take. Where we take n points of a domain for a centroid,
                pyfuzzylite samples the middles of n equal parts.

        Raises:
            ModuleNotFoundError: If pyfuzzylite is not installed.
        """
        from fuzzylite import FllImporter

        self._engine: Any = FllImporter().from_string(fll.write(definition_of(controller)))
        self._inputs = [self._engine.input_variable(name) for name in INPUTS]
        self._outputs = [self._engine.output_variable(name) for name in OUTPUTS]

    def infer(self, distance: float, difference: float) -> tuple[float, float]:
        """Return (turn, step) for one pair of inputs."""
        for variable, value in zip(self._inputs, (distance, difference), strict=True):
            variable.value = value
        self._engine.process()
        # Version 8 answers with arrays of one number, version 7 with numbers.
        turn, step = (np.asarray(output.value, dtype=float).item() for output in self._outputs)
        return turn, step
