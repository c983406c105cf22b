"""The paper's controller: its Tables 2, 3 and 4, from the files in ``assets/controllers``.

Lengths are in multiples of the standard step S_p, turns in multiples of the standard angle A_p
(Eq. 15). The files say what is missing or misprinted in the tables, and how it was put right.
"""

from __future__ import annotations

from functools import cache
from typing import Literal, TypeAlias, get_args

from fuzzyq_bullet.fuzzy.definition import ControllerDefinition
from fuzzyq_bullet.fuzzy.formats import load_controller
from fuzzyq_bullet.fuzzy.inference import FuzzyController
from fuzzyq_bullet.platforms import asset

RuleTable: TypeAlias = Literal["corrected", "printed"]
RULE_TABLES: tuple[RuleTable, ...] = get_args(RuleTable)
_FILES = {"corrected": "paper.yaml", "printed": "paper-as-printed.yaml"}


@cache
def paper_definition(rules: RuleTable = "corrected") -> ControllerDefinition:
    """Return the controller of section 3.2 as data.

    Args:
        rules: ``corrected``, or ``printed`` to see what goes wrong with Table 4 as it stands.

    Raises:
        ValueError: If ``rules`` names no table.
    """
    if rules not in _FILES:
        raise ValueError(f"no rule table {rules!r}; there are {', '.join(_FILES)}")
    return load_controller(asset("controllers") / _FILES[rules])


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
    return paper_definition(rules).controller(samples)
