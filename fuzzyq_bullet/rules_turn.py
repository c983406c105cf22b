"""Which decisions of a record the fuzzy rules were asked for, and how far they turned them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.planning import MODES
from fuzzyq_bullet.trajectory import Decisions, Trajectory

CLEARLY = math.radians(3.0)
"""A smaller turn (rad) is not counted as one."""


def has_rules(decisions: Decisions) -> bool:
    """Whether a planner with fuzzy rules made these decisions."""
    return bool(np.isfinite(decisions.rules).any())


def asked(decisions: Decisions) -> NDArray[np.bool_]:
    """Return of each decision whether its rules were asked, shape (D,).

    They are not where the planner aims at a gap exactly. Version 0.1.0 did not record that; its
    ways out decided in place of the rules.
    """
    unknown = np.isnan(decisions.exact)
    routine = decisions.mode == MODES.index("routine")
    told = np.isfinite(decisions.turn)
    return np.asarray(told & np.where(unknown, routine, decisions.exact == 0.0))


def controller_turns(trajectory: Trajectory) -> NDArray[np.float64]:
    """Return by how much the rules turned each decision off its aim, ω2·N_a·A_p (rad), shape (D,).

    It is 0 where they were not asked, and NaN where it is not known: for a planner without rules,
    and for one that is not there any more, whose A_p was not kept.
    """
    decisions = trajectory.decisions
    unit = getattr(trajectory.scenario.planner, "turn_unit", math.nan)
    turns = decisions.weights[:, 1] * decisions.turn * float(unit)
    return np.where(np.isfinite(decisions.turn) & ~asked(decisions), 0.0, turns)


def share_turned(trajectory: Trajectory) -> float | None:
    """Return the share of decisions in which the rules turn by more than ``CLEARLY``.

    Returns:
        0 to 1; None for a planner without rules.
    """
    turns = controller_turns(trajectory)
    if not np.isfinite(turns).any():
        return None
    return float((np.abs(np.nan_to_num(turns)) > CLEARLY).mean())
