"""Ways out where the controller finds none: breakout (4.2) and sustained avoidance (4.3).

The routine part goes on as long as it comes nearer to the goal. Where the way is blocked, or the
robot has come no nearer for a while, it breaks out: it looks about, and goes where the least way to
the goal may lead. From there it looks again, and goes on avoiding what stands in its way, with all
it has seen in mind, until the line to the goal leads to somewhere nearer than it has ever been.

Why it ends, and what it guarantees: see ``docs/escape.md``.
"""

from __future__ import annotations

import math

from fuzzyq_bullet.planning.base import LONGEST_STRIDE, Decision, Mode, Observation
from fuzzyq_bullet.planning.course import NEARER, Course
from fuzzyq_bullet.planning.exits import Exit
from fuzzyq_bullet.planning.places import Places
from fuzzyq_bullet.planning.sweep import eased, first_free

ENOUGH = 1.0
"""What a turn must find free, as Fig. 6 has it, in S_p."""
GAIN = 1.0
"""By how much nearer than ever before the line to the goal must lead to be taken again, in S_p."""
PATIENCE = 2.5
"""Time without coming nearer to the goal after which the routine part has failed (s); longer for a
slow robot."""
ARRIVED = 0.1
"""How near to an exit the robot has reached it (m); nearer than ``places.NEAR``, so that looking
about from there is the end of that exit."""


class Escape:
    """Breakout and sustained avoidance for one episode.

    Args:
        following: Whether the avoidance is sustained; without, it is the plain breakout of Fig. 6,
            which remembers nothing.
    """

    def __init__(self, *, following: bool = True) -> None:
        self._follows = following
        self._places = Places()
        self._exit: Exit | None = None
        self._course = Course([])
        self._failed: set[Exit] = set()
        self._nearest = math.inf
        self._since = 0.0
        self._straight = False
        self._mark = math.nan

    def decide(self, routine: Decision, observation: Observation) -> Decision:
        """Return the routine's decision while it serves, and another where it does not.

        Args:
            routine: What the routine part would do, with the c_f in force.
            observation: What it was asked about.
        """
        here, goal = observation.position, observation.goal
        to_goal = math.dist(here, goal)
        middle = routine.lengths[1]
        enough = min(routine.breakout_at * observation.unit, to_goal)
        if to_goal < self._nearest - NEARER:
            self._nearest, self._since, self._straight = to_goal, observation.time, False
        self._places.pass_by(here)

        if self._exit is not None:
            nearer = middle >= to_goal or to_goal - middle <= self._mark - GAIN * observation.unit
            if not nearer or middle < enough:
                return self._follow(routine, observation)
            self._exit, self._straight = None, True
        blocked = middle < enough
        stalled = (
            not self._straight
            and observation.time - self._since > PATIENCE * observation.slowness
            and middle < min(observation.range, to_goal)
        )
        if (blocked or stalled) and not self._follows:
            return _break_out(routine, observation, middle)
        if blocked or stalled:
            # Where the line to the goal leads now is not enough: it did not help.
            self._mark = min(self._nearest, to_goal - middle)
            self._look(observation)
            return self._follow(routine, observation, "breakout")
        if self._straight:
            # What ended the avoidance was this line: it is driven as promised, and the controller
            # has its turn again when the robot is nearer than ever before.
            return routine._replace(heading=routine.lines[1])
        return routine

    def _look(self, observation: Observation) -> None:
        """Look about, and choose the exit to go for."""
        self._places.look_around(observation)
        self._exit, points = self._places.best_exit(observation.goal) or (None, [])
        self._course = Course(points)

    def _follow(
        self, routine: Decision, observation: Observation, mode: Mode = "following"
    ) -> Decision:
        """Go for the chosen exit, and for the next one when it is reached or cannot be."""
        leg = None
        while self._exit is not None:
            tried = self._exit
            if math.dist(observation.position, tried.point) > ARRIVED:
                leg = self._course.next(observation)
                if leg is not None:
                    break
                self._fail(tried)
            self._look(observation)
        if self._exit is None or leg is None:
            return routine._replace(step=0.0, reach=0.0, mode=mode, hopeless=True)
        step = routine.weights[0] * LONGEST_STRIDE * observation.unit
        return routine._replace(
            heading=leg.heading,
            step=step if observation.motion is not None else min(step, leg.way),
            reach=leg.reach,
            mode=mode,
            target=self._exit.point,
        )

    def _fail(self, tried: Exit) -> None:
        """Give an exit up that was not reached, but for the first time try it again.

        The robot may have come a little off the way that it saw; it goes back, and aims anew.
        """
        if tried in self._failed:
            self._places.give_up(tried)
        self._failed.add(tried)


def _break_out(routine: Decision, observation: Observation, middle: float) -> Decision:
    """Take the smaller turn, left or right, that is free (4.2, Fig. 6)."""
    bearing = routine.lines[1]
    # A stalled robot may have its line free for a while: it is what stands there that counts.
    enough = least = ENOUGH * observation.unit
    if middle < observation.range:
        enough = max(least, middle + 0.25 * observation.unit)
    tie = 1 if routine.difference >= 0.0 else -1
    sides = [
        (side, found)
        for side in (tie, -tie)
        if (found := first_free(observation.sense, bearing, side, enough, math.pi)) is not None
    ]
    if not sides:
        return routine._replace(step=0.0, reach=0.0, mode="breakout")
    side, found = min(sides, key=lambda one: round(one[1].turned, 3))
    found = eased(observation.sense, found, side, enough)
    to_goal = math.dist(observation.position, observation.goal)
    # T of Eqs. 24 to 26, but no farther than what is known to be free.
    way = min(found.free, max(0.0, to_goal * math.cos(found.heading - bearing)))
    x, y = observation.position
    step = routine.weights[0] * LONGEST_STRIDE * observation.unit
    return routine._replace(
        heading=found.heading,
        step=step if observation.motion is not None else min(least, found.free),
        mode="breakout",
        target=(x + way * math.cos(found.heading), y + way * math.sin(found.heading)),
    )
