"""The escape from dead ends: breakout (4.2, Algorithm 1) and sustained avoidance (4.3).

The routine part decides as long as the robot comes nearer to the goal. Where the line to the goal
is blocked, or the robot has come no nearer for a while, it breaks out: it scans all around, and
drives to the frontier over which the path to the goal may be the shortest. There it scans again,
and goes on so, with everything it has seen in its exploration graph. The routine part takes over
when the line to the goal leads nearer to it than the robot has ever been.

``docs/explanation/escape.md`` says why it ends, and what it guarantees.
"""

from __future__ import annotations

import math

from fuzzyq_bullet.planning.aim import Aim, along_heading, towards_goal
from fuzzyq_bullet.planning.base import USUAL_RANGE, Observation
from fuzzyq_bullet.planning.decision import Mode
from fuzzyq_bullet.planning.escape.cost_to_go import NO_HITS
from fuzzyq_bullet.planning.escape.exploration import NEAR, ExplorationGraph, Judge
from fuzzyq_bullet.planning.escape.frontiers import Frontier
from fuzzyq_bullet.planning.escape.path_follower import NEARER, PathFollower, Segment
from fuzzyq_bullet.planning.ray_search import eased, ray_search
from fuzzyq_bullet.planning.scan import Point

ENOUGH = 1.0
"""How much must be free after the turn of the plain breakout, in S_p (Fig. 6)."""
GAIN = 1.0
"""The line to the goal is taken again if it leads so much nearer than ever before, in S_p."""
PATIENCE = 2.5
"""Time without coming nearer to the goal after which the routine part has failed (s); longer for a
slow robot."""
BESIDE = math.radians(45.0)
"""Where the plain breakout looks which side has more room, if both need the same turn (rad)."""
RESCAN = 0.3
"""On its way to a frontier the robot scans again after this part of its range, or of 1 m if it sees
less far: where it sees farther, less of what it finds is new."""
OPEN_PATH_RESCAN = 0.1
"""On an open path the robot scans again after this part of its range: the path is the shortest only
among the obstacles that it has seen."""
MOST_SCANS = 10
"""After more scans than this from one place it drives to frontiers: the map is wrong there."""
OPEN_PATH_SHORTCUTS = 12
"""How many points of an open path are tried for a short cut."""
BETTER = 0.2
"""It goes for another frontier only if the way over it is shorter by so much (m)."""
ARRIVED = 0.1
"""A frontier as near as this is reached (m). It is less than ``exploration.NEAR``, so that a scan
from there explores the frontier."""


class Escape:
    """Breakout and sustained avoidance for one episode.

    Its lengths are so many times as long for a larger robot.

    Args:
        following: Whether the avoidance is sustained. If not, it is the plain breakout of Fig. 6,
            which remembers nothing.
        graph: What is known from episodes before, if anything is.

    Attributes:
        moving: Points (m) of what moves now, shape (M, 2): the map leaves them out.
    """

    def __init__(self, *, following: bool = True, graph: ExplorationGraph | None = None) -> None:
        self._follows = following
        self._graph = graph or ExplorationGraph()
        self._knows_the_way = self._graph.leads_to_goal
        self._frontier: Frontier | None = None
        self._on_open_path = False
        self._distrusts_map = False  # an open path could not be followed
        self._follower = PathFollower([])
        self._mode: Mode = "breakout"
        self._failed: list[Point] = []  # frontiers that were not reached at first
        self._left: list[Point] = []  # frontiers that were given up for better ones
        self._scanned_at: Point = (math.inf, math.inf)
        self._nearest = math.inf
        self._since = 0.0
        self._straight = False
        self._mark = math.nan
        self._goal: Point | None = None
        self.moving = NO_HITS

    def choose_by(self, judge: Judge) -> None:
        """Let somebody else judge ways out from now on."""
        self._graph.judge = judge

    def aim(self, observation: Observation, breakout_at: float) -> Aim:
        """Return the goal, or a temporary goal where the way to it is blocked.

        Args:
            observation: What is observed.
            breakout_at: c_f, in units of S_p.
        """
        if observation.goal != self._goal:
            self._begin(observation)
        goal = towards_goal(observation)
        here, to_goal = observation.position, goal.distance
        [middle] = observation.sense([goal.bearing])
        enough = min(_breakout_distance(observation, breakout_at), observation.range, to_goal)
        if to_goal < self._nearest - NEARER * observation.size:
            self._nearest, self._since, self._straight = to_goal, observation.time, False
        self._graph.pass_by(here)

        if self._knows_the_way:
            self._knows_the_way = False
            self._scan(observation)
            self._mode = "following"
        if self._frontier is not None:
            nearer = middle >= to_goal or to_goal - middle <= self._mark - GAIN * observation.unit
            if not nearer or middle < enough:
                return self._follow(observation)
            self._frontier, self._straight = None, True
        blocked = middle < enough
        stalled = self._out_of_patience(observation) and middle < min(observation.range, to_goal)
        if (blocked or stalled) and not self._follows:
            return _break_out(observation, goal.bearing, middle)
        if blocked or stalled:
            # The line to the goal must lead nearer than it does now: this did not help.
            self._mark = min(self._nearest, to_goal - middle)
            self._scan(observation)
            self._mode = "breakout"
            return self._follow(observation)
        # The line that ended the avoidance is driven as it is. The controller takes over when the
        # robot is nearer than ever before.
        return goal._replace(exact=self._straight)

    def _out_of_patience(self, observation: Observation) -> bool:
        """Return whether the routine part has brought the robot no nearer to the goal for long."""
        waited = observation.time - self._since
        return not self._straight and waited > PATIENCE * observation.slowness

    def _begin(self, observation: Observation) -> None:
        """Take up another goal: keep what was seen, forget what was tried for the last goal."""
        if self._goal is not None:
            self._frontier, self._follower = None, PathFollower([])
            self._failed, self._left, self._distrusts_map = [], [], False
            self._nearest, self._since = math.inf, observation.time
            self._straight, self._mark = False, math.nan
            self._graph.pass_by(observation.position)
            self._graph.seek(observation.goal)
        self._goal = observation.goal

    def _scan(self, observation: Observation) -> None:
        """Scan all around, and choose the open path or the frontier to go to."""
        self._graph.scan(observation, self.moving)
        self._scanned_at = observation.position
        self._on_open_path = False
        if self._graph.scans_from(observation.position) > MOST_SCANS:
            self._distrusts_map = True
        if observation.sees_far and not self._distrusts_map:
            path = self._graph.open_path(observation)
            if path is not None:
                # The goal is the frontier: all between is taken for free.
                self._frontier = Frontier(0, observation.goal, 0.0, 0.0, None)
                self._follower = PathFollower(path, OPEN_PATH_SHORTCUTS)
                self._on_open_path = True
                return
        self._frontier, path = self._graph.best_frontier(observation) or (None, [])
        self._follower = PathFollower(path)

    def _scan_again(self, observation: Observation, tried: Frontier) -> None:
        """Scan on the way to a frontier, and go for another if that has become better."""
        self._graph.scan(observation, self.moving)
        self._scanned_at = observation.position
        best = self._graph.best_frontier(observation, tried, BETTER * observation.size)
        if best is None:
            self._frontier = None
        elif best[0] != tried:
            self._left.append(tried.point)
            self._mode = "following"
            self._frontier, path = best
            self._follower = PathFollower(path)
        elif self._graph.leads_to_goal:  # a long way may have become shorter
            self._follower = PathFollower(best[1])

    def _follow(self, observation: Observation) -> Aim:
        """Drive to the chosen frontier; if it is reached or cannot be reached, to the next one.

        To the first it is the breakout, from there on the sustained avoidance.
        """
        tried = self._frontier
        moved = math.dist(observation.position, self._scanned_at)
        if self._on_open_path:
            if moved > OPEN_PATH_RESCAN * observation.range:
                self._scan(observation)
                self._mode = "following"
        # A frontier that was given up once is not given up again: so this ends.
        elif (
            tried is not None
            and moved > RESCAN * max(1.0, observation.range)
            and not self._is_at(tried.point, self._left)
        ):
            self._scan_again(observation, tried)
        while self._frontier is not None:
            tried = self._frontier
            if math.dist(observation.position, tried.point) > ARRIVED * observation.size:
                segment = self._follower.next(observation)
                if segment is not None:
                    return self._along(segment, observation, tried)
                self._fail(tried)
            self._scan(observation)
            self._mode = "following"
        wait = towards_goal(observation)._replace(mode=self._mode, reach=0.0)
        # Among what moves it waits: what is in the way may move off.
        return wait._replace(hopeless=observation.closing_speed == 0.0)

    def _along(self, segment: Segment, observation: Observation, tried: Frontier) -> Aim:
        """Aim along the next segment of the way to a frontier, or of an open path."""
        way = along_heading(
            observation, segment.heading, segment.length, self._mode, tried.point
        )._replace(reach=segment.reach)
        if self._on_open_path:  # no more of it is known to be free
            return way._replace(exact=segment.exact, target=way.point)
        return way._replace(exact=segment.exact or self._is_at(tried.point, self._failed))

    def _fail(self, tried: Frontier) -> None:
        """Try a frontier that was not reached a second time, then put it on the blacklist.

        The robot may have come a little off the path that it saw; it goes back and aims again. From
        an open path that it cannot follow it goes over to frontiers, for good.
        """
        if self._on_open_path:
            self._distrusts_map = True
            return
        if self._is_at(tried.point, self._failed):
            self._graph.blacklist(tried)
        self._failed.append(tried.point)

    def _is_at(self, point: Point, places: list[Point]) -> bool:
        near = NEAR * self._graph.size
        return any(math.dist(point, place) <= near for place in places)


def _breakout_distance(observation: Observation, breakout_at: float) -> float:
    """Return the free distance (m) below which the robot breaks out: c_f · S_p.

    For a range of more than 5·S_p it grows in proportion to the range.
    """
    scale = observation.range / USUAL_RANGE if observation.sees_far else observation.unit
    return breakout_at * scale


def _break_out(observation: Observation, bearing: float, middle: float) -> Aim:
    """Aim at the smaller turn, left or right, that is free (4.2, Algorithm 1, Fig. 6)."""
    # A stalled robot may have its line free for a while: the obstacle at its end counts.
    enough = least = ENOUGH * observation.unit
    if middle < observation.range:
        enough = max(least, middle + 0.25 * observation.unit)
    left, right = observation.sense([bearing + BESIDE, bearing - BESIDE])
    tie = 1 if left >= right else -1
    sides = [
        (side, found)
        for side in (tie, -tie)
        if (found := ray_search(observation.sense, bearing, side, enough, math.pi)) is not None
    ]
    if not sides:
        return towards_goal(observation)._replace(mode="breakout", reach=0.0)
    side, found = min(sides, key=lambda one: round(one[1].turned, 3))
    found = eased(observation.sense, found, side, enough)
    to_goal = math.dist(observation.position, observation.goal)
    # T of Eqs. 24 to 26, but no farther than is known to be free.
    length = min(found.free, max(least, to_goal * math.cos(found.heading - bearing)))
    x, y = observation.position
    target = (x + length * math.cos(found.heading), y + length * math.sin(found.heading))
    return along_heading(observation, found.heading, length, "breakout", target)
