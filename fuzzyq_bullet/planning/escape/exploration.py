"""The exploration graph: where the robot was, and the frontiers that it has not tried yet.

The lengths and prices are those for the usual robot, so many times as long for a larger one; only
``SPACING`` is the same for all.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import NamedTuple, TypeAlias

from fuzzyq_bullet.planning.base import USUAL_SPEED, Floats, Observation
from fuzzyq_bullet.planning.escape.cost_to_go import NO_HITS, TIGHT, ObstacleMap
from fuzzyq_bullet.planning.escape.frontiers import (
    Frontier,
    along,
    find_concave_corners,
    find_frontiers,
)
from fuzzyq_bullet.planning.escape.open_path import open_path
from fuzzyq_bullet.planning.scan import Point, Scan, scan_360

ToGo: TypeAlias = Callable[[float, float], float]
"""The true length (m) of the shortest path from a point (x, y; m) to the goal."""

SPACING = 0.05
"""Distance between two nodes that are added while the robot drives (m)."""
NEAR = 0.15
"""Two points no farther apart than this are one place (m)."""
DOUBT = 1.0
"""What a gap costs more than a frontier beyond which more is free for certain (m)."""
ENCLOSED = 1000.0
"""What a frontier costs more from which the known obstacles leave no path to the goal (m)."""
_BACK = (0.0, -0.1, -0.2)
_INTO = (0.0, 0.1, 0.2, -0.1, -0.2)
"""Where the path on from a frontier is taken to begin, from its point on (m): the first of these
that lies in no obstacle. A gap is entered. Elsewhere what lies before the point is known to be
free, and so is, where the sight ended and nothing stood, what lies between the two."""


class WaysOut(NamedTuple):
    """The frontiers that there are to choose from.

    Attributes:
        observation: What is observed.
        points: Where they are (m).
        ways: Length of the known path to each (m). The frontier that the robot is on its way to is
            told a little nearer, so that it does not change its mind for nothing.
        guess: Tells how long the path on from each may be at least (m), by what was seen.
    """

    observation: Observation
    points: Sequence[Point]
    ways: Sequence[float]
    guess: Callable[[], Sequence[float]]


Judge: TypeAlias = Callable[[WaysOut], Sequence[float]]
"""Says what the way to the goal over each frontier costs, in any unit; the least is chosen."""


def as_it_looks(out: WaysOut) -> list[float]:
    """Judge frontiers by what was seen in this episode: the planner's own way."""
    return [way + on for way, on in zip(out.ways, out.guess(), strict=True)]


def knowing(to_go: ToGo) -> Judge:
    """Return who judges frontiers by the true way on: for bounds and training only."""
    return lambda out: [way + to_go(*at) for way, at in zip(out.ways, out.points, strict=True)]


@dataclass(slots=True)
class Node:
    """Where the robot was.

    Attributes:
        point: Position (m).
        edges: Lengths (m) of the straight lines to other nodes, by their index, that were driven
            or seen to be free.
        scan: What was seen from here, if the robot scanned.
    """

    point: Point
    edges: dict[int, float] = field(default_factory=dict)
    scan: Scan | None = None

    def sees(self, point: Point) -> bool:
        """Return whether the straight line to a point (m) was seen to be free."""
        if self.scan is None:
            return False
        distance = math.dist(self.point, point)
        if distance > self.scan.range:
            return False
        bearing = math.atan2(point[1] - self.point[1], point[0] - self.point[0])
        return self.scan.free(bearing) >= distance


class ExplorationGraph:
    """What a robot has explored: in one episode, or in several of the same field.

    Attributes:
        judge: Says which frontier is the best.
        leads_to_goal: Whether the goal was reached in an episode before.
        size: How many times as large as usual the robot is that scanned.
    """

    def __init__(self) -> None:
        self.judge: Judge = as_it_looks
        self._nodes: list[Node] = []
        self._scanned: list[Node] = []  # those of them that have a scan
        self._frontiers: list[Frontier] = []
        self._obstacles = ObstacleMap()
        self._blacklist: list[Point] = []
        self._corners_too = False
        self._joined = False
        self._sought: Frontier | None = None
        self.leads_to_goal = False
        self.size = 1.0

    def begin_again(self) -> None:
        """Begin another episode in the same field: the robot is elsewhere, the map stays."""
        self._joined = False

    def arrive(self, goal: Point) -> None:
        """Remember that the goal (m) was reached: it is a frontier with no way on."""
        self.leads_to_goal = True
        index = len(self._nodes) - 1
        distance = math.dist(self._nodes[index].point, goal)
        self._frontiers.append(Frontier(index, goal, 0.0, distance, goal))

    def seek(self, goal: Point) -> None:
        """Take up another goal (m). If a way to it is known, it is a frontier with no way on."""
        if self._sought is not None:
            self._frontiers = [one for one in self._frontiers if one is not self._sought]
            self._sought = None
        lengths = shortest_paths(self._nodes)[0]
        known = [
            (lengths[index] + apart, index, apart)
            for index, node in enumerate(self._nodes)
            if (apart := math.dist(node.point, goal)) <= NEAR * self.size or node.sees(goal)
        ]
        if known:
            _, index, apart = min(known)
            self._sought = Frontier(index, goal, 0.0, apart, goal)
            self._frontiers.append(self._sought)

    def pass_by(self, here: Point) -> None:
        """Add the path driven so far, up to a position (m)."""
        if not self._nodes or math.dist(self._nodes[-1].point, here) >= SPACING:
            self._add(here)

    def scan(self, observation: Observation, moving: Floats = NO_HITS) -> None:
        """Scan all around, and add what was seen: edges, obstacles and frontiers.

        Among moving obstacles, the map forgets what the scan sees through.

        Args:
            observation: What is observed.
            moving: Points (m) of what moves, shape (M, 2): the map leaves them out.
        """
        here, self.size = observation.position, observation.size
        index = self._add(here)
        node = self._nodes[index]
        node.scan = scan = scan_360(observation)
        self._scanned.append(node)
        if observation.closing_speed > 0.0:
            self._obstacles.forget(partial(scan.sees_through, here))
            stands = scan.without(moving)
            self._obstacles.add(stands.boundary, stands.hits, scan.radius)
        else:
            self._obstacles.add(scan.boundary, scan.hits, scan.radius)
        for other, known in enumerate(self._nodes[:index]):
            if node.sees(known.point):
                node.edges[other] = known.edges[index] = math.dist(known.point, here)
        self._frontiers = [one for one in self._frontiers if not _is_explored(one, node)]
        self._remember(find_frontiers(index, here, scan))
        if self._corners_too:
            self._remember(find_concave_corners(index, here, scan))

    def best_frontier(
        self, observation: Observation, kept: Frontier | None = None, switch: float = 0.0
    ) -> tuple[Frontier, list[Point]] | None:
        """Return the frontier over which the path to the goal (m) may be the shortest.

        Args:
            observation: What is observed.
            kept: The frontier that the robot is on its way to.
            switch: How much shorter the path over another one must be (m).

        Returns:
            The frontier, and the points of the path from the latest node to it; None when every
            frontier was tried.
        """
        if not self._frontiers and not self._corners_too:
            self._corners_too = True
            for index, node in enumerate(self._nodes):
                if node.scan is not None:
                    self._remember(find_concave_corners(index, node.point, node.scan))
        if not self._frontiers:
            return None
        lengths, before = shortest_paths(self._nodes)
        ways = [lengths[one.node] + one.distance for one in self._frontiers]
        if kept in self._frontiers:
            ways[self._frontiers.index(kept)] -= switch
        points = [one.point for one in self._frontiers]
        guess = partial(self._ways_on, ways, observation.goal)
        costs = self.judge(WaysOut(observation, points, ways, guess))
        chosen = self._frontiers[min(range(len(costs)), key=costs.__getitem__)]
        if kept in self._frontiers and math.dist(chosen.point, kept.point) <= NEAR * self.size:
            chosen = kept  # the same place, seen from elsewhere
        path, at = [chosen.point], chosen.node
        while at >= 0:
            path.append(self._nodes[at].point)
            at = before[at]
        return chosen, path[::-1]

    def open_path(self, observation: Observation) -> list[Point] | None:
        """Return the shortest path (m) to the goal past the known obstacles.

        Returns:
            None if there is none, or if a judge other than ``as_it_looks`` chooses frontiers.
        """
        if self.judge is not as_it_looks:
            return None
        motion = observation.motion
        speed = USUAL_SPEED if motion is None else motion.max_speed
        return open_path(self._obstacles, observation.position, observation.goal, speed)

    def scans_from(self, here: Point) -> int:
        """Return how many scans were made within ``NEAR`` of a position (m)."""
        near = NEAR * self.size
        return sum(math.dist(node.point, here) <= near for node in self._scanned)

    def blacklist(self, tried: Frontier) -> None:
        """Forget a frontier for good, and all others at the same place."""
        self._blacklist.append(tried.point)
        self._frontiers = [
            one for one in self._frontiers if math.dist(one.point, tried.point) > NEAR * self.size
        ]

    def _add(self, here: Point) -> int:
        index = len(self._nodes)
        node = Node(here)
        self._nodes.append(node)
        if self._joined:  # joined to the node before: that is how the robot got here
            last = self._nodes[index - 1]
            node.edges[index - 1] = last.edges[index] = math.dist(last.point, here)
        self._joined = True
        return index

    def _remember(self, frontiers: Iterable[Frontier]) -> None:
        for found in frontiers:
            if any(math.dist(point, found.point) <= NEAR * self.size for point in self._blacklist):
                continue
            if not any(_is_explored(found, node) for node in self._scanned):
                self._frontiers.append(found)

    def _ways_on(self, ways: Sequence[float], goal: Point) -> list[float]:
        """Return how long the path (m) from each frontier to the goal may be at least.

        Args:
            ways: Length of the known path to each (m).
            goal: The goal (m).
        """
        points = [one.point for one in self._frontiers]
        straight = [math.dist(point, goal) for point in points]
        doubts = [DOUBT * self.size if one.beyond is None else 0.0 for one in self._frontiers]
        costs = [way + doubt + on for way, doubt, on in zip(ways, doubts, straight, strict=True)]
        best = min(range(len(costs)), key=costs.__getitem__)
        found = [doubt + on for doubt, on in zip(doubts, straight, strict=True)]
        # No path is shorter than the straight line: the obstacles count only if they cross it.
        if not self._obstacles.in_sight(points[best], goal):
            around = costs_to_go(self._frontiers, self._obstacles, goal, self.size)
            for k, length in enumerate(around):
                found[k] += min(length - straight[k], ENCLOSED)
        return found


def costs_to_go(
    frontiers: Sequence[Frontier], obstacles: ObstacleMap, goal: Point, size: float = 1.0
) -> list[float]:
    """Return the cost to go (m) from each frontier; infinite where there is no path.

    Args:
        frontiers: The frontiers.
        obstacles: What has been seen.
        goal: The goal (m).
        size: How many times as large as usual the robot is.
    """
    offsets = [[max(by, -one.distance) for by in _begins(one, size)] for one in frontiers]
    starts = [
        along(one.point, one.heading, by)
        for one, some in zip(frontiers, offsets, strict=True)
        for by in some
    ]
    found = iter(obstacles.cost_to_go(goal, starts, TIGHT * size))
    costs = [[max(by, 0.0) + next(found) for by in some] for some in offsets]
    return [next(filter(math.isfinite, some), math.inf) for some in costs]


def shortest_paths(nodes: Sequence[Node]) -> tuple[list[float], list[int]]:
    """Return the length (m) of the shortest path from the last node to each (Dijkstra).

    Returns:
        The lengths, infinite where there is no path, and the index of the node before each on its
        path, −1 for the last node itself.
    """
    last = len(nodes) - 1
    lengths, before = [math.inf] * (last + 1), [-1] * (last + 1)
    lengths[last] = 0.0
    heap = [(0.0, last)]
    while heap:
        length, at = heapq.heappop(heap)
        if length > lengths[at]:
            continue
        for other, edge in nodes[at].edges.items():
            if length + edge < lengths[other]:
                lengths[other], before[other] = length + edge, at
                heapq.heappush(heap, (length + edge, other))
    return lengths, before


def _begins(one: Frontier, size: float) -> list[float]:
    if one.beyond is None:
        return [by * size for by in _INTO]
    back = [by * size for by in _BACK]
    return [math.dist(one.point, one.beyond), *back] if one.ahead else back


def _is_explored(one: Frontier, node: Node) -> bool:
    """Return whether a node's scan has shown what there was to see at a frontier."""
    if node.scan is None:
        return False
    if math.dist(one.point, node.point) <= NEAR * node.scan.size:
        return True
    return one.beyond is not None and node.sees(one.beyond)
