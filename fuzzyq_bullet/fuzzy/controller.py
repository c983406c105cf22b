"""A fuzzy controller with two inputs and two outputs under their own names."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from fuzzyq_bullet.fuzzy.inference import ProductInference

if TYPE_CHECKING:
    from fuzzyq_bullet.fuzzy.rules import RuleBase


class Inference(NamedTuple):
    """One inference, with everything that led to it, in plain numbers.

    Attributes:
        near: Memberships of the distance in each of its labels, shape (5,) in the paper.
        side: Memberships of the difference in each of its labels, shape (5,) in the paper.
        rules: Firing strengths (Eq. 2), shape (5, 5) in the paper: a row for each label of the
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
        samples: n of Eq. 22.
    """

    __slots__ = ("_engine", "base", "samples")

    def __init__(self, base: RuleBase, *, samples: int = 101) -> None:
        """Prepare the inference.

        Should no rule fire, the controller does not turn and takes the smallest step: of all it
        could do unasked, that leads least far. Gaussian sets that cover their domain never let
        this happen.

        Raises:
            ValueError: If the rules have not two outputs, or ``samples`` is below 3.
        """
        if len(base.outputs) != 2:
            raise ValueError(f"{len(base.outputs)} outputs; the controller has a turn and a step")
        self.base = base
        self.samples = samples
        self._engine = ProductInference(
            base, samples=samples, fallback=(0.0, base.outputs[1].domain[0])
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
