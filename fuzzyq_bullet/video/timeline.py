"""What was going on at any time of a record: pose in between ticks, decision in force."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from fuzzyq_bullet.trajectory import Trajectory

NO_DECISION = -1

_LEAST_SHIFT = 0.4
"""A smaller shift (pixels) is not seen."""
_LEAST_TURN = math.radians(0.7)


@dataclass(frozen=True, slots=True)
class Moment:
    """One instant of a run.

    Attributes:
        time: Since the start (s).
        tick: Last tick that is not later.
        position: Centre of the robot (m).
        heading: Direction it faces (rad).
        speed: Forward speed (m/s).
        clearance: Distance to the nearest thing (m).
        decision: Index of the decision in force, or ``NO_DECISION``.
        over: Whether the run has ended.
    """

    time: float
    tick: int
    position: tuple[float, float]
    heading: float
    speed: float
    clearance: float
    decision: int
    over: bool = False


class Timeline:
    """A record, asked by time. It holds nothing that grows with the record but the record."""

    def __init__(self, trajectory: Trajectory) -> None:
        self._ticks = trajectory.ticks
        self._decisions = trajectory.decisions
        self.start = float(self._ticks.time[0])
        self.end = float(self._ticks.time[-1])

    def at(self, time: float) -> Moment:
        """Return the moment at a time (s), which is moved to the nearest one of the record."""
        ticks = self._ticks
        time = min(max(time, self.start), self.end)
        last = len(ticks.time) - 1
        tick = int(np.searchsorted(ticks.time, time, side="right")) - 1
        after = min(tick + 1, last)
        span = float(ticks.time[after] - ticks.time[tick])
        part = (time - float(ticks.time[tick])) / span if span > 0.0 else 0.0

        (x0, y0), (x1, y1) = ticks.position[tick].tolist(), ticks.position[after].tolist()
        turn = math.remainder(float(ticks.heading[after] - ticks.heading[tick]), math.tau)
        return Moment(
            time=time,
            tick=tick,
            position=(x0 + (x1 - x0) * part, y0 + (y1 - y0) * part),
            heading=float(ticks.heading[tick]) + turn * part,
            speed=_between(ticks.speed, tick, after, part),
            clearance=_between(ticks.clearance, tick, after, part),
            decision=int(np.searchsorted(self._decisions.tick, tick, side="right")) - 1,
        )


class Steady:
    """Holds a pose until it has changed by as much as can be seen; a slow robot costs few redraws.

    Args:
        scale: Size of a metre in the picture (pixels).
    """

    def __init__(self, scale: float) -> None:
        self._far = _LEAST_SHIFT / max(scale, 1e-9)
        self._held: Moment | None = None

    def moved(self, moment: Moment) -> bool:
        """Tell whether the robot is to be drawn anew, and if so remember how it is drawn."""
        held = self._held
        if (
            held is not None
            and moment.over == held.over
            and math.dist(moment.position, held.position) < self._far
            and abs(math.remainder(moment.heading - held.heading, math.tau)) < _LEAST_TURN
        ):
            return False
        self._held = moment
        return True


def _between(
    column: np.ndarray[tuple[int, ...], np.dtype[np.float64]], a: int, b: int, part: float
) -> float:
    first, second = float(column[a]), float(column[b])
    # An infinite clearance must not meet an infinite difference.
    return first if part == 0.0 or first == second else first + (second - first) * part
