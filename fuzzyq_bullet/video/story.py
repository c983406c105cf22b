"""Why the robot turns, in one plain sentence that stays long enough to be read."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fuzzyq_bullet.planning.base import MODES, Mode
from fuzzyq_bullet.video.timeline import NO_DECISION, Moment

if TYPE_CHECKING:
    from fuzzyq_bullet.trajectory import Decisions

READING_TIME = 0.9
"""Least time that a sentence stays (s of video), unless the mode of the planner changes."""
STRAIGHT = math.radians(5.0)
"""A smaller turn is called straight on (rad)."""
ALIKE = 0.03
"""Sides whose lengths differ by less are called alike (m)."""


class Narrator:
    """Chooses the sentence for each moment; moments must come in order of time.

    Args:
        decisions: What the planner decided.
        speed: Seconds of the run in one second of video.
    """

    def __init__(self, decisions: Decisions, speed: float = 1.0) -> None:
        self._decisions = decisions
        self._patience = READING_TIME * speed
        self._since = -math.inf
        self._decision = NO_DECISION
        self._mode: Mode | None = None
        self._sentence = "Waits for its first decision"

    def tell(self, moment: Moment) -> str:
        """Return the sentence to show."""
        if moment.decision in (NO_DECISION, self._decision):
            return self._sentence
        mode = MODES[int(self._decisions.mode[moment.decision])]
        if mode != self._mode or moment.time - self._since >= self._patience:
            sentence = reason(self._decisions, moment.decision, moment.heading)
            if sentence != self._sentence:
                self._since = moment.time
            self._sentence, self._mode, self._decision = sentence, mode, moment.decision
        return self._sentence


def reason(decisions: Decisions, index: int, facing: float) -> str:
    """Return why decision ``index`` turns a robot that faces ``facing`` (rad) as it does."""
    turn = math.remainder(float(decisions.heading[index]) - facing, math.tau)
    side = "left" if turn > 0.0 else "right"
    mode = MODES[int(decisions.mode[index])]
    left, ahead, right = decisions.lengths[index].tolist()
    known = all(map(math.isfinite, (left, ahead, right)))

    if mode == "breakout":
        if abs(turn) < STRAIGHT:
            return "Way to the goal is blocked: breaks out straight ahead"
        return f"Way to the goal is blocked: breaks out to the {side}"
    if mode == "following":
        along = "" if abs(turn) < STRAIGHT else f", turns {side}"
        return f"Large obstacle in the way: follows its edge{along}"
    if not known:
        if abs(turn) < STRAIGHT:
            return "Drives straight on"
        return f"Turns {side}"

    lean = off_goal_line(decisions, index)
    if not math.isfinite(lean) or abs(lean) < STRAIGHT:
        difference = float(decisions.difference[index])
        free = (
            math.isfinite(difference) and abs(difference) < 1e-9 and _is_longest(decisions, index)
        )
        if free:
            return "Way is clear: " + _to_goal(turn)
        if abs(left - right) < ALIKE:
            return f"Both sides alike ({left:.1f} m), {ahead:.1f} m ahead: straight on, slower"
        return f"Hardly any difference of the sides, {ahead:.1f} m ahead: " + _to_goal(turn)

    freer, room, other = ("left", left, right) if lean > 0.0 else ("right", right, left)
    digits = 1 if f"{room:.1f}" != f"{other:.1f}" else 2
    because = f"{freer.capitalize()} is freer ({room:.{digits}f} m against {other:.{digits}f} m)"
    if abs(room - other) < ALIKE:
        because = f"Blocked {ahead:.1f} m ahead"
    if abs(turn) < STRAIGHT:
        return f"{because}: keeps {freer}"
    if side == freer:
        return f"{because}: turns {freer}"
    return f"{because}: keeps {freer}, a little less"


def off_goal_line(decisions: Decisions, index: int) -> float:
    """Return how far (rad) the decided heading lies left of the middle line."""
    return math.remainder(
        float(decisions.heading[index]) - float(decisions.lines[index, 1]), math.tau
    )


def _to_goal(turn: float) -> str:
    if abs(turn) < STRAIGHT:
        return "straight to the goal"
    return f"turns {'left' if turn > 0.0 else 'right'}, to the goal"


def _is_longest(decisions: Decisions, index: int) -> bool:
    """Whether the controller was told that nothing is near (d at its greatest)."""
    return float(decisions.distance[index]) >= 4.5
