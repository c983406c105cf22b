"""What was going on at any time of a record: pose in between ticks, decision, what was sensed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fuzzyq_bullet.video.map.footprints import Floats, corridor

if TYPE_CHECKING:
    from fuzzyq_bullet.recording.trajectory import Trajectory

NO_DECISION = -1

_LEAST_SHIFT = 0.4
"""A smaller shift (pixels) is not seen."""
_ROUNDING = 1e-9
"""Times that differ by less are the same (s)."""
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
        shown: Index of the decision that panels and sentence explain, or ``NO_DECISION``.
    """

    time: float
    tick: int
    position: tuple[float, float]
    heading: float
    speed: float
    clearance: float
    decision: int
    over: bool = False
    shown: int = NO_DECISION


class Timeline:
    """A record, asked by time. It holds nothing that grows with the record but the record.

    Wheels roll from tick to tick. The point robot of the kinematic drive jumps: until its next tick
    it stands where it decided.
    """

    def __init__(self, trajectory: Trajectory) -> None:
        self._ticks = trajectory.ticks
        self._decisions = trajectory.decisions
        self._jumps = jumps(trajectory)
        self.start = float(self._ticks.time[0])
        self.end = float(self._ticks.time[-1])

    def at(self, time: float) -> Moment:
        """Return the moment at a time (s), which is moved to the nearest one of the record."""
        ticks = self._ticks
        time = min(max(time, self.start), self.end)
        if self._jumps:  # at a tick it has jumped, however the two times were rounded
            time = min(time + _ROUNDING, self.end)
        last = len(ticks.time) - 1
        tick = int(np.searchsorted(ticks.time, time, side="right")) - 1
        after = min(tick + 1, last)
        span = float(ticks.time[after] - ticks.time[tick])
        part = (time - float(ticks.time[tick])) / span if span > 0.0 and not self._jumps else 0.0

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


def jumps(trajectory: Trajectory) -> bool:
    """Whether the robot is nowhere between two ticks: the point robot of the kinematic drive."""
    return trajectory.scenario.drive == "kinematic"


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


@dataclass(frozen=True, slots=True)
class Sensed:
    """One decision in the plane.

    Attributes:
        origin: Where the robot was when it sensed (m).
        lines: Heading (rad) and free length (m) of the left, middle and right detection line;
            empty for a planner without lines.
        corridors: What the front half of the disc sweeps along each line (m), shape (N, 2) each.
        radius: Radius of the disc that the lengths are meant for (m).
        heading: The heading decided (rad).
        target: The planner's temporary goal (m); None without one, or beyond the walls.
        aim: What the middle line points at (m); None if it is not known, or beyond the walls.
    """

    origin: tuple[float, float]
    lines: tuple[tuple[float, float], ...]
    corridors: tuple[Floats, ...]
    radius: float
    heading: float
    target: tuple[float, float] | None
    aim: tuple[float, float] | None = None


def sensed_at(trajectory: Trajectory, decision: int) -> Sensed | None:
    """Return what decision number ``decision`` was made of, None before the first."""
    if decision == NO_DECISION:
        return None
    decisions = trajectory.decisions
    x, y = trajectory.ticks.position[int(decisions.tick[decision])].tolist()
    headings, lengths = decisions.lines[decision].tolist(), decisions.lengths[decision].tolist()
    known = all(map(math.isfinite, (*headings, *lengths)))
    radius = trajectory.scenario.robot.radius
    lines = tuple(zip(headings, lengths, strict=True)) if known else ()
    return Sensed(
        origin=(x, y),
        lines=lines,
        corridors=tuple(corridor((x, y), *line, radius) for line in lines),
        radius=radius,
        heading=float(decisions.heading[decision]),
        target=_marked(trajectory, decisions.target[decision].tolist()),
        aim=_marked(trajectory, decisions.aim[decision].tolist()),
    )


def _marked(trajectory: Trajectory, point: list[float]) -> tuple[float, float] | None:
    """Return a point (m) that can be marked; None if it is blank, or lies beyond the walls."""
    arena, (x, y) = trajectory.scenario.arena, point
    inside = arena.bounds.holds(x, y)
    return (x, y) if math.isfinite(x + y) and (inside or not arena.walls) else None


def sensor_range(trajectory: Trajectory) -> float:
    """Return the longest detection line (m) of a run: what they measure where nothing is near."""
    lengths = trajectory.decisions.lengths
    longest = trajectory.scenario.sensor_range
    known = lengths[np.isfinite(lengths)]
    return float(known.max()) if known.size and known.max() > 0.0 else longest


def _between(
    column: np.ndarray[tuple[int, ...], np.dtype[np.float64]], a: int, b: int, part: float
) -> float:
    first, second = float(column[a]), float(column[b])
    # An infinite clearance must not meet an infinite difference.
    return first if part == 0.0 or first == second else first + (second - first) * part
