"""A fuzzy controller as plain data, from which the page builds its own."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fuzzyq_bullet.fuzzy import paper_controller
from fuzzyq_bullet.fuzzy.paper import NEAR_WORDS, RULES, SIDE_WORDS

if TYPE_CHECKING:
    from fuzzyq_bullet.fuzzy import FuzzyController
    from fuzzyq_bullet.fuzzy.sets import Variable
    from fuzzyq_bullet.trajectory import Trajectory


def controller_data(controller: FuzzyController) -> dict[str, Any]:
    """Return the sets, the rules and the inference of a controller, ready for JSON.

    Each set has the key ``words`` and one for its shape, such as ``gaussian: [centre, width]``.
    ``rules`` has a row for each label of the distance, and in it a cell ``"TURN STEP"`` for each
    label of the difference.
    """
    base = controller.base
    turn, step = base.outputs
    return {
        "inputs": {
            "distance": _variable(base.row, NEAR_WORDS),
            "difference": _variable(base.column, SIDE_WORDS),
        },
        "outputs": {"turn": _variable(turn), "step": _variable(step)},
        "rules": {
            label: [" ".join(cell) for cell in cells]
            for label, cells in zip(base.row.labels, base.cells, strict=True)
        },
        "inference": {
            "and": "product",
            "defuzzification": "centroid",
            "samples": controller.samples,
        },
    }


def controller_of(trajectory: Trajectory) -> dict[str, Any] | None:
    """Return the controller that a run was driven with; None for a planner without rules."""
    planner = trajectory.scenario.planner
    rules = getattr(planner, "rules", None)
    if rules not in RULES:
        return None
    return controller_data(paper_controller(rules, int(getattr(planner, "samples", 101))))


def _variable(variable: Variable, words: tuple[str, ...] = ()) -> dict[str, Any]:
    said = words or tuple(one.words.lower() for one in variable.sets)
    return {
        "range": list(variable.domain),
        "sets": {
            one.label: {"words": called, "gaussian": [one.center, one.width]}
            for one, called in zip(variable.sets, said, strict=True)
        },
    }
