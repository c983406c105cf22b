"""The escape from dead ends: breakout (4.2, Algorithm 1) and sustained avoidance (4.3).

The routine part decides as long as the robot comes nearer to the goal. Where the line to the goal
is blocked, or the robot has come no nearer for a while, it breaks out: it scans all around, and
drives to the frontier over which the path to the goal may be the shortest. There it scans again,
and goes on so, with everything it has seen in its exploration graph. The routine part takes over
when the line to the goal leads nearer to it than the robot has ever been.

``docs/escape.md`` says why it ends, and what it guarantees.
"""

from __future__ import annotations

import math

from fuzzyq_bullet.planning.base import LONGEST_STRIDE, Observation
from fuzzyq_bullet.planning.decision import Decision, Mode
from fuzzyq_bullet.planning.exploration import ExplorationGraph
from fuzzyq_bullet.planning.frontiers import Frontier
from fuzzyq_bullet.planning.path_follower import NEARER, PathFollower
from fuzzyq_bullet.planning.ray_search import eased, ray_search

ENOUGH = 1.0
"""How much must be free after the turn of the plain breakout, in S_p (Fig. 6)."""
GAIN = 1.0
"""The line to the goal is taken again if it leads so much nearer than ever before, in S_p."""
PATIENCE = 2.5
"""Time without coming nearer to the goal after which the routine part has failed (s); longer for a
slow robot."""
ARRIVED = 0.1
"""A frontier as near as this is reached (m). It is less than ``exploration.NEAR``, so that a scan
from there explores the frontier."""


class Escape:
    """Breakout and sustained avoidance for one episode.

    Args:
        following: Whether the avoidance is sustained. If not, it is the plain breakout of Fig. 6,
            which remembers nothing.
    """

    def __init__(self, *, following: bool = True) -> None:
        self._follows = following
        self._graph = ExplorationGraph()
        self._frontier: Frontier | None = None
        self._follower = PathFollower([])
        self._failed: set[Frontier] = set()
        self._nearest = math.inf
        self._since = 0.0
        self._straight = False
        self._mark = math.nan

    def decide(self, routine: Decision, observation: Observation) -> Decision:
        """Return the routine part's decision, or another one where it fails.

        Args:
            routine: What the routine part decides, with the c_f in force.
            observation: What it decides about.
        """
        here, goal = observation.position, observation.goal
        to_goal = math.dist(here, goal)
        middle = routine.lengths[1]
        enough = min(routine.breakout_at * observation.unit, to_goal)
        if to_goal < self._nearest - NEARER:
            self._nearest, self._since, self._straight = to_goal, observation.time, False
        self._graph.pass_by(here)

        if self._frontier is not None:
            nearer = middle >= to_goal or to_goal - middle <= self._mark - GAIN * observation.unit
            if not nearer or middle < enough:
                return self._follow(routine, observation)
            self._frontier, self._straight = None, True
        blocked = middle < enough
        stalled = (
            not self._straight
            and observation.time - self._since > PATIENCE * observation.slowness
            and middle < min(observation.range, to_goal)
        )
        if (blocked or stalled) and not self._follows:
            return _break_out(routine, observation, middle)
        if blocked or stalled:
            # The line to the goal must lead nearer than it does now: this did not help.
            self._mark = min(self._nearest, to_goal - middle)
            self._scan(observation)
            return self._follow(routine, observation, "breakout")
        if self._straight:
            # This line ended the avoidance, so it is driven as it is. The controller takes over
            # when the robot is nearer than ever before.
            return routine._replace(heading=routine.lines[1])
        return routine

    def _scan(self, observation: Observation) -> None:
        """Scan all around, and choose the frontier to go to."""
        self._graph.scan(observation)
        self._frontier, path = self._graph.best_frontier(observation.goal) or (None, [])
        self._follower = PathFollower(path)

    def _follow(
        self, routine: Decision, observation: Observation, mode: Mode = "following"
    ) -> Decision:
        """Drive to the chosen frontier; if it is reached or cannot be reached, to the next one."""
        segment = None
        while self._frontier is not None:
            tried = self._frontier
            if math.dist(observation.position, tried.point) > ARRIVED:
                segment = self._follower.next(observation)
                if segment is not None:
                    break
                self._fail(tried)
            self._scan(observation)
        if self._frontier is None or segment is None:
            return routine._replace(step=0.0, reach=0.0, mode=mode, hopeless=True)
        step = routine.weights[0] * LONGEST_STRIDE * observation.unit
        return routine._replace(
            heading=segment.heading,
            step=step if observation.motion is not None else min(step, segment.length),
            reach=segment.reach,
            mode=mode,
            target=self._frontier.point,
        )

    def _fail(self, tried: Frontier) -> None:
        """Try a frontier that was not reached a second time, then put it on the blacklist.

        The robot may have come a little off the path that it saw; it goes back and aims again.
        """
        if tried in self._failed:
            self._graph.blacklist(tried)
        self._failed.add(tried)


def _break_out(routine: Decision, observation: Observation, middle: float) -> Decision:
    """Take the smaller turn, left or right, that is free (4.2, Algorithm 1, Fig. 6)."""
    bearing = routine.lines[1]
    # A stalled robot may have its line free for a while: the obstacle at its end counts.
    enough = least = ENOUGH * observation.unit
    if middle < observation.range:
        enough = max(least, middle + 0.25 * observation.unit)
    tie = 1 if routine.difference >= 0.0 else -1
    sides = [
        (side, found)
        for side in (tie, -tie)
        if (found := ray_search(observation.sense, bearing, side, enough, math.pi)) is not None
    ]
    if not sides:
        return routine._replace(step=0.0, reach=0.0, mode="breakout")
    side, found = min(sides, key=lambda one: round(one[1].turned, 3))
    found = eased(observation.sense, found, side, enough)
    to_goal = math.dist(observation.position, observation.goal)
    # T of Eqs. 24 to 26, but no farther than is known to be free.
    length = min(found.free, max(0.0, to_goal * math.cos(found.heading - bearing)))
    x, y = observation.position
    step = routine.weights[0] * LONGEST_STRIDE * observation.unit
    return routine._replace(
        heading=found.heading,
        step=step if observation.motion is not None else min(least, found.free),
        mode="breakout",
        target=(x + length * math.cos(found.heading), y + length * math.sin(found.heading)),
    )
