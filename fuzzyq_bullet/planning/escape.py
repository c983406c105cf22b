"""Ways out where the controller finds none: breakout (4.2) and sustained avoidance (4.3).

The routine part goes on as long as it comes nearer to the goal. Where the way is blocked, or the
robot has come no nearer for a while, the breakout looks to both sides for the smaller turn that is
free, and the robot then follows the boundary of what stands in its way, on that side, until the
line to the goal leads to somewhere nearer than it has ever been.

Why it ends: see ``docs/escape.md``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from fuzzyq_bullet.geometry import wrap_angle
from fuzzyq_bullet.planning.base import LONGEST_STRIDE, STEP_UNIT, Decision, Mode, Observation
from fuzzyq_bullet.planning.sweep import Found, eased, first_free

ENOUGH = 1.0 * STEP_UNIT
"""c_f: a way free for less than this is blocked (m)."""
HALVINGS = 3
"""How often c_f is halved where no way is free for so long."""
GAIN = 1.0 * STEP_UNIT
"""By how much nearer than ever before the line to the goal must lead to be taken again (m)."""
PATIENCE = 6.0
"""Time without coming nearer to the goal after which the routine part has failed (s)."""
FIRST_STRETCH = 40.0 * STEP_UNIT
"""Way along a boundary after which the robot tries the other direction (m), doubled each time."""
CLOSED = 0.2
"""A boundary is closed when the robot comes back to within this of where it began (m) ..."""
AWAY = 0.5
"""... after having been this far away (m) ..."""
WHOLE_TURN = math.radians(300.0)
"""... and has turned round by about a whole turn (rad)."""
SLACK = 0.25 * STEP_UNIT
"""How much less than the best promise of a whole loop is taken on the second (m)."""
GRAZE = math.radians(70.0)
"""Where a ray that only just is blocked meets something, seen from the end of its way (rad)."""


@dataclass
class _Boundary:
    """The boundary that is being followed.

    Attributes:
        side: +1 turns left from the boundary, so that it stays on the right; −1 the reverse.
        hinge: Where the last blocked ray met it (m).
        way: Path since the last change of direction (m).
        stretch: Way after which the direction changes next (m).
        last: Where the robot was at the last decision (m).
        mark: Distance to the goal that the line to it must beat for the robot to leave (m).
        first: Where this stretch began (m), once it has.
        heading: Heading of the last step (rad).
        farthest: How far from there it has been since (m).
        turned: Sum of all turns of this stretch (rad); a whole loop has made a whole turn.
        promise: Least distance to the goal that the free line to it has promised so far (m).
        again: Whether a whole loop has been made, so that the promise is all there is to hope for.
    """

    side: int
    hinge: tuple[float, float]
    last: tuple[float, float]
    mark: float
    way: float = 0.0
    stretch: float = FIRST_STRETCH
    first: tuple[float, float] | None = None
    farthest: float = 0.0
    heading: float = 0.0
    turned: float = 0.0
    promise: float = math.inf
    again: bool = False

    def begin_stretch(self) -> None:
        """Forget the way so far: from here on the robot goes round anew."""
        self.way, self.turned, self.farthest, self.first = 0.0, 0.0, 0.0, None


class Escape:
    """Breakout and sustained avoidance for one episode."""

    def __init__(self, *, following: bool = True) -> None:
        self._follows = following
        self._boundary: _Boundary | None = None
        self._nearest = math.inf
        self._since = 0.0
        self._straight = False

    def decide(self, routine: Decision, observation: Observation) -> Decision:
        """Return the routine's decision while it serves, and another where it does not."""
        here, goal = observation.position, observation.goal
        to_goal = math.dist(here, goal)
        middle = float(routine.lengths[1])
        if to_goal < self._nearest - 0.05 * STEP_UNIT or math.isinf(self._nearest):
            self._nearest, self._since, self._straight = to_goal, observation.time, False

        if self._boundary is not None:
            if self._may_leave(self._boundary, to_goal, middle):
                self._boundary, self._straight = None, True
            else:
                return self._follow(routine, observation, self._boundary)
        blocked = middle < min(ENOUGH, to_goal)
        stalled = (
            not self._straight
            and observation.time - self._since > PATIENCE
            and middle < min(observation.range, to_goal)
        )
        if blocked or stalled:
            return self._break_out(routine, observation, middle)
        if self._straight:
            # What made the robot leave the boundary was this line: it is driven as promised, and
            # the controller has its turn again when the robot is nearer than ever before.
            return replace(routine, heading=float(routine.lines[1]))
        return routine

    def _may_leave(self, boundary: _Boundary, to_goal: float, middle: float) -> bool:
        """Return whether the line to the goal is free and leads nearer than the mark."""
        if middle < min(ENOUGH, to_goal):
            return False
        boundary.promise = min(boundary.promise, to_goal - middle)
        return to_goal - middle <= boundary.mark - GAIN

    def _break_out(self, routine: Decision, observation: Observation, middle: float) -> Decision:
        """Take the smaller turn, left or right, that is free (4.2, Fig. 6)."""
        bearing = float(routine.lines[1])
        # A stalled robot may have its line free for a while: it is what stands there that counts.
        enough = max(ENOUGH, middle + 0.25 * STEP_UNIT) if middle < observation.range else ENOUGH
        sides = [
            (side, first_free(observation.sense, bearing, side, enough, math.pi))
            for side in (1, -1)
        ]
        open_sides = [(side, found) for side, found in sides if found is not None]
        if not open_sides:
            side = 1 if routine.difference >= 0.0 else -1
            hinge = _along(observation.position, bearing, middle + STEP_UNIT)
            boundary = self._bounded(side, hinge, observation)
            self._boundary = boundary
            return self._follow(routine, observation, boundary)
        tie = 1 if routine.difference >= 0.0 else -1
        side, found = min(open_sides, key=lambda one: (round(one[1].turned, 3), -tie * one[0]))
        if self._follows:
            hinge = _contact(observation.position, found.blocked or (bearing, middle), side)
            self._boundary = self._bounded(side, hinge, observation)
        found = eased(observation.sense, found, side, enough)
        away = wrap_angle(found.heading - bearing)
        reach = math.dist(observation.position, observation.goal) * math.cos(away)
        target = _along(observation.position, found.heading, max(0.0, reach))
        return self._step(routine, observation, found, "breakout", target)

    def _bounded(
        self, side: int, hinge: tuple[float, float], observation: Observation
    ) -> _Boundary:
        here = math.dist(observation.position, observation.goal)
        mark = here if self._straight else self._nearest
        return _Boundary(side, hinge, observation.position, mark)

    def _follow(self, routine: Decision, observation: Observation, boundary: _Boundary) -> Decision:
        """Go on along the boundary (4.3, Figs. 7 and 8)."""
        here = observation.position
        boundary.way += math.dist(here, boundary.last)
        boundary.last = here
        if boundary.way > boundary.stretch:
            boundary.side = -boundary.side
            boundary.stretch *= 2.0
            boundary.begin_stretch()
        found = self._next(observation, boundary)
        if found is None:
            return replace(routine, step=0.0, reach=0.0, mode="following", hopeless=True)
        if found.blocked is not None:
            boundary.hinge = _contact(here, found.blocked, boundary.side)
        if boundary.first is None:
            boundary.first = here
        else:
            boundary.turned += wrap_angle(found.heading - boundary.heading)
            boundary.farthest = max(boundary.farthest, math.dist(here, boundary.first))
        boundary.heading = found.heading
        if self._is_closed(boundary, here):
            if boundary.again or math.isinf(boundary.promise):
                return replace(routine, step=0.0, reach=0.0, mode="following", hopeless=True)
            boundary.again = True
            boundary.mark = boundary.promise + GAIN + SLACK
            boundary.stretch = math.inf
            boundary.begin_stretch()
        return self._step(routine, observation, found, "following", boundary.hinge)

    def _next(self, observation: Observation, boundary: _Boundary) -> Found | None:
        here = observation.position
        start = math.atan2(boundary.hinge[1] - here[1], boundary.hinge[0] - here[0])
        enough = ENOUGH
        for _ in range(HALVINGS + 1):
            found = first_free(observation.sense, start, boundary.side, enough)
            if found is not None:
                return eased(observation.sense, found, boundary.side, enough)
            enough /= 2.0
        return None

    def _is_closed(self, boundary: _Boundary, here: tuple[float, float]) -> bool:
        return (
            boundary.first is not None
            and boundary.farthest > AWAY
            and abs(boundary.turned) > WHOLE_TURN
            and math.dist(here, boundary.first) < CLOSED
        )

    def _step(
        self,
        routine: Decision,
        observation: Observation,
        found: Found,
        mode: Mode,
        target: tuple[float, float],
    ) -> Decision:
        if observation.motion is None:
            step = min(ENOUGH, found.free)
        else:
            step = routine.weights[0] * LONGEST_STRIDE * STEP_UNIT
        return replace(
            routine,
            heading=found.heading,
            step=step,
            mode=mode,
            target=target,
        )


def _along(origin: tuple[float, float], heading: float, way: float) -> tuple[float, float]:
    return origin[0] + way * math.cos(heading), origin[1] + way * math.sin(heading)


def _contact(
    origin: tuple[float, float], blocked: tuple[float, float], side: int
) -> tuple[float, float]:
    """Return about where the robot's disc would meet what blocks a ray (m).

    Next to a free ray a blocked one only grazes: what it meets lies beside the end of its way, on
    the side that the sweep came from.

    Args:
        origin: Centre of the robot (m).
        blocked: World heading (rad) and free distance (m) of the ray.
        side: The way the sweep turned.
    """
    heading, free = blocked
    return _along(_along(origin, heading, free), heading - side * GRAZE, STEP_UNIT)
