"""The paper's controller as data: Tables 2, 3 and 4, and the readings that make them work.

Lengths are in multiples of the standard step S_p, turns in multiples of the standard angle A_p
(Eq. 15).
"""

from __future__ import annotations

from functools import cache
from typing import Literal, TypeAlias

from fuzzyq_bullet.fuzzy.inference import FuzzyController
from fuzzyq_bullet.fuzzy.rules import RuleBase
from fuzzyq_bullet.fuzzy.sets import Variable

RuleTable: TypeAlias = Literal["corrected", "printed"]

# Table 2, as printed.
DISTANCE = Variable.parse(
    "d",
    (0.0, 5.0),
    """
    VN  Very Near  [1.100 -0.30]
    N   Near       [0.425  1.49]
    M   Medium     [0.425  2.49]
    F   Far        [0.425  3.57]
    VF  Very Far   [1.295  4.73]
    """,
)
"""d_ro: free distance ahead, in S_p; the detection range is 5·S_p."""

DIFFERENCE = Variable.parse(
    "Df",
    (-5.0, 5.0),
    """
    NB  Negative Big    [1.679 -5.31]
    NS  Negative Small  [0.944 -2.22]
    ZO  Zero            [0.943  0.00]
    PS  Positive Small  [0.944  2.22]
    PB  Positive Big    [1.964  5.43]
    """,
)
"""Df = left − right (Eq. 14), in S_p. PB is not the mirror of NB; it is kept as printed."""

NEAR_WORDS = ("very near", "near", "medium", "far", "very far")
"""What the sets of ``DISTANCE`` mean to a robot."""
SIDE_WORDS = ("right much freer", "right freer", "alike", "left freer", "left much freer")
"""What the sets of ``DIFFERENCE`` mean to a robot."""

# Table 3 is printed up to VL, L and NL only. Neighbouring sets cross at a membership of 0.5
# everywhere else; that and symmetry leave one completion. The paper also swaps the two domains:
# read literally, the robot reverses.
TURN = Variable.parse(
    "turn",
    (-2.0, 2.0),
    """
    NL  Negative Large  [0.639 -1.95]
    NS  Negative Small  [0.339 -0.80]
    ZO  Zero            [0.339  0.00]
    PS  Positive Small  [0.339  0.80]
    PL  Positive Large  [0.639  1.95]
    """,
)
"""N_a: scale of the turn, in A_p, positive to the left."""

STEP = Variable.parse(
    "step",
    (0.0, 2.0),
    """
    VL  Very Less  [0.237  0.12]
    L   Less       [0.170  0.60]
    ME  Medium     [0.170  1.00]
    M   More       [0.170  1.40]
    VM  Very More  [0.237  1.88]
    """,
)
"""N_s: scale of the step, in S_p."""

# Table 4, as printed: the cells name the outputs by the labels of the inputs.
_PRINTED = """
            NB       NS       ZO       PS       PB
    VN:  [NB VN]  [PB VN]  [ZO VN]  [PB VN]  [PB VN]
    N:   [NB N]   [NS N]   [NB M]   [NB F]   [NB VF]
    M:   [NS M]   [NS M]   [ZO M]   [PS M]   [PS M]
    F:   [NS F]   [NS F]   [ZO F]   [PS F]   [PS F]
    VF:  [NS VF]  [NS VF]  [ZO VF]  [PS VF]  [PS VF]
"""
_PRINTED_TURN = {"NB": "NL", "PB": "PL"}
_PRINTED_STEP = {"VN": "VL", "N": "L", "M": "ME", "F": "M", "VF": "VM"}

# Table 4 with the outputs' own labels and its own pattern restored in two places. (VN, NS) turns
# away from the side without room, as (VN, PS) does. Row N steps as its distance asks, and turns
# to the side with room.
_CORRECTED = """
            NB       NS       ZO       PS       PB
    VN:  [NL VL]  [NL VL]  [ZO VL]  [PL VL]  [PL VL]
    N:   [NL L]   [NS L]   [ZO L]   [PS L]   [PL L]
    M:   [NS ME]  [NS ME]  [ZO ME]  [PS ME]  [PS ME]
    F:   [NS M]   [NS M]   [ZO M]   [PS M]   [PS M]
    VF:  [NS VM]  [NS VM]  [ZO VM]  [PS VM]  [PS VM]
"""

RULES: dict[RuleTable, RuleBase] = {
    "corrected": RuleBase.parse(_CORRECTED, row=DISTANCE, column=DIFFERENCE, outputs=(TURN, STEP)),
    "printed": RuleBase.parse(
        _PRINTED,
        row=DISTANCE,
        column=DIFFERENCE,
        outputs=(TURN, STEP),
        aliases=(_PRINTED_TURN, _PRINTED_STEP),
    ),
}
"""Table 4, once as it must be meant and once as it is printed."""


def paper_controller(rules: RuleTable = "corrected", samples: int = 101) -> FuzzyController:
    """Return the controller of section 3.2; the same one each time, for it has no memory.

    Args:
        rules: ``corrected``, or ``printed`` to see what goes wrong with Table 4 as it stands.
        samples: n of Eq. 22, at least 3. The paper takes 5, which is too coarse for clutter.

    Raises:
        ValueError: If ``rules`` names no table, or ``samples`` is below 3.
    """
    return _paper_controller(rules, samples)


@cache
def _paper_controller(rules: RuleTable, samples: int) -> FuzzyController:
    if rules not in RULES:
        raise ValueError(f"no rule table {rules!r}; there are {', '.join(RULES)}")
    return FuzzyController(RULES[rules], samples=samples)
