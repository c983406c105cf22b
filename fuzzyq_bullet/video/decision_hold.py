"""Which decision the panels and the sentence show: one for all, for long enough to be read."""

from __future__ import annotations

import math
from bisect import bisect_right
from typing import TYPE_CHECKING

from fuzzyq_bullet.video.explanation import gives_way, is_clear, side_of
from fuzzyq_bullet.video.timeline import NO_DECISION

if TYPE_CHECKING:
    from fuzzyq_bullet.recording.trajectory import Trajectory
    from fuzzyq_bullet.video.timeline import Moment

HOLD = 0.5
"""Least time that a decision is shown (s of video), unless what it means is no longer so."""
_OTHER_WAY = math.radians(90.0)
"""A robot that gives way and now turns farther than this (rad) gives way to another side."""


class DecisionHold:
    """The decision shown at any time of a run; it depends on nothing but the time.

    Each is held for a while, then the one in force takes its place. Another mode, a turn to the
    other side, something on a way that was clear, or that the robot gives way, and to which side,
    is shown at once.

    Args:
        trajectory: The run.
        speed: Seconds of the run in one second of video.
    """

    def __init__(self, trajectory: Trajectory, speed: float = 1.0) -> None:
        decisions = trajectory.decisions
        times = trajectory.ticks.time[decisions.tick].tolist()
        modes = decisions.mode.tolist()
        sides = [side_of(trajectory, k) for k in range(len(times))]
        clear = [is_clear(decisions, k) for k in range(len(times))]
        giving = [gives_way(trajectory, k) for k in range(len(times))]
        ways = decisions.heading.tolist()
        self._last = len(times) - 1
        self._times: list[float] = []
        self._decisions: list[int] = []
        held, due = NO_DECISION, -math.inf
        for k, (time, until) in enumerate(zip(times, [*times[1:], math.inf], strict=True)):
            at_once = held == NO_DECISION or (
                modes[k] != modes[held]
                or sides[k] * sides[held] < 0
                or (clear[held] and not clear[k])
                or (giving[k] and not giving[held])
                or (giving[k] and abs(math.remainder(ways[k] - ways[held], math.tau)) > _OTHER_WAY)
            )
            since = time if at_once else max(time, due)
            if since < until:
                self._times.append(since)
                self._decisions.append(k)
                held, due = k, since + HOLD * speed

    def at(self, moment: Moment) -> int:
        """Return the decision to show, ``NO_DECISION`` before the first; at last the last."""
        if moment.over:
            return self._last
        number = bisect_right(self._times, moment.time)
        return self._decisions[number - 1] if number else NO_DECISION
