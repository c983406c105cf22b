"""Which decisions of a record the fuzzy rules were asked for, and how far they turned them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.planning import MODES
from fuzzyq_bullet.recording.trajectory import Decisions, Trajectory

ALL = slice(None)
CLEARLY = math.radians(3.0)
"""A smaller turn (rad) is not counted as one."""


def has_rules(decisions: Decisions) -> bool:
    """Whether a planner with fuzzy rules made these decisions."""
    return bool(np.isfinite(decisions.rules).any())


def asked(decisions: Decisions, which: int | slice = ALL) -> NDArray[np.bool_]:
    """Return of each decision, or of one, whether its rules were asked.

    They are not where the planner aims at a gap exactly. Version 0.1.0 did not record that; its
    ways out decided in place of the rules.
    """
    exact = decisions.exact[which]
    routine = decisions.mode[which] == MODES.index("routine")
    told = np.isfinite(decisions.turn[which])
    return np.asarray(told & np.where(np.isnan(exact), routine, exact == 0.0))


def controller_turns(trajectory: Trajectory, which: int | slice = ALL) -> NDArray[np.float64]:
    """Return by how much the rules turned each decision, or one, off its aim: ω2·N_a·A_p (rad).

    It is 0 where they were not asked, and NaN where it is not known: for a planner without rules,
    and for one that is not there any more, whose A_p was not kept.
    """
    decisions = trajectory.decisions
    unit = getattr(trajectory.scenario.planner, "turn_unit", math.nan)
    turn = decisions.turn[which]
    turns = decisions.weights[which, 1] * turn * float(unit)
    return np.where(np.isfinite(turn) & ~asked(decisions, which), 0.0, turns)


def share_turned(trajectory: Trajectory) -> float | None:
    """Return the share of decisions near something in which the rules turn by over ``CLEARLY``.

    Near is within the range of the sensor: elsewhere the rules have nothing to turn for.

    Returns:
        0 to 1; None for a planner without rules, and where nothing ever came near.
    """
    turns = controller_turns(trajectory)
    seen = trajectory.scenario.sensor_range
    near = trajectory.ticks.clearance[trajectory.decisions.tick] < seen
    if not near.any() or not np.isfinite(turns).any():
        return None
    return float((np.abs(np.nan_to_num(turns[near])) > CLEARLY).mean())
