"""What a robot remembers of its way: the places it was at, and the exits it has not tried."""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterable
from dataclasses import dataclass, field

from fuzzyq_bullet.planning.base import Observation
from fuzzyq_bullet.planning.exits import Exit, along, doubtful_exits_of, exits_of
from fuzzyq_bullet.planning.promise import Walls
from fuzzyq_bullet.planning.view import Point, View, look_around

SPACING = 0.05
"""Way between two places that are remembered on the go (m)."""
NEAR = 0.15
"""Two points no farther apart than this are one place (m)."""
DOUBT = 0.5
"""What a gap counts more than a way that is seen to lead on (m)."""
ENCLOSED = 1000.0
"""What an exit counts more from which the known walls let no way to the goal (m)."""
_BACK = (0.0, -0.1, -0.2)
_INTO = (0.0, 0.1, 0.2, -0.1, -0.2)
"""Where the way on from an exit is taken to begin, from its point on (m): the first of these that
lies in no wall. A gap is entered; elsewhere what lies before the point is known to be free, and
where nothing ended the sight, what lies between the point and the end of the sight."""


@dataclass(slots=True)
class Place:
    """Where the robot was.

    Attributes:
        point: Position (m).
        ways: Straight ways (m) that were driven or seen to be free, by the other place's index.
        view: What was seen from here, if the robot looked.
    """

    point: Point
    ways: dict[int, float] = field(default_factory=dict)
    view: View | None = None

    def sees(self, point: Point) -> bool:
        """Return whether the straight way to a point was seen to be free."""
        if self.view is None:
            return False
        way = math.dist(self.point, point)
        if way > self.view.range:
            return False
        bearing = math.atan2(point[1] - self.point[1], point[0] - self.point[0])
        return self.view.free(bearing) >= way


class Places:
    """The memory of one episode."""

    def __init__(self) -> None:
        self._places: list[Place] = []
        self._looked: list[Place] = []  # those of them that have a view
        self._exits: list[Exit] = []
        self._walls = Walls()
        self._given_up: list[Point] = []
        self._thorough = False

    def pass_by(self, here: Point) -> None:
        """Remember the way driven so far."""
        if not self._places or math.dist(self._places[-1].point, here) >= SPACING:
            self._add(here)

    def look_around(self, observation: Observation) -> None:
        """Look in all directions, and remember the exits."""
        here = observation.position
        index = self._add(here)
        place = self._places[index]
        place.view = view = look_around(observation)
        self._looked.append(place)
        self._walls.add(view.walls)
        for other, known in enumerate(self._places[:index]):
            if place.sees(known.point):
                place.ways[other] = known.ways[index] = math.dist(known.point, here)
        self._exits = [one for one in self._exits if not _is_known(one, place)]
        self._remember(exits_of(index, here, view))
        if self._thorough:
            self._remember(doubtful_exits_of(index, here, view))

    def best_exit(self, goal: Point) -> tuple[Exit, list[Point]] | None:
        """Return the exit that promises the least way to the goal, and the way to it.

        Returns:
            The exit, and the points of the way from the latest place up to it; None when every
            exit was tried.
        """
        if not self._exits and not self._thorough:
            self._thorough = True
            for index, place in enumerate(self._places):
                if place.view is not None:
                    self._remember(doubtful_exits_of(index, place.point, place.view))
        if not self._exits:
            return None
        ways, before = self._ways({one.place for one in self._exits})
        chosen = self._cheapest([ways[one.place] + one.way for one in self._exits], goal)
        route, at = [chosen.point], chosen.place
        while at >= 0:
            route.append(self._places[at].point)
            at = before[at]
        return chosen, route[::-1]

    def give_up(self, tried: Exit) -> None:
        """Forget an exit for good, and all others to the same place."""
        self._given_up.append(tried.point)
        self._exits = [one for one in self._exits if math.dist(one.point, tried.point) > NEAR]

    def _add(self, here: Point) -> int:
        index = len(self._places)
        place = Place(here)
        self._places.append(place)
        if index:  # every place is joined to the one before: that is how the robot got here
            last = self._places[index - 1]
            place.ways[index - 1] = last.ways[index] = math.dist(last.point, here)
        return index

    def _remember(self, exits: Iterable[Exit]) -> None:
        for found in exits:
            if any(math.dist(point, found.point) <= NEAR for point in self._given_up):
                continue
            if not any(_is_known(found, place) for place in self._looked):
                self._exits.append(found)

    def _cheapest(self, reach: list[float], goal: Point) -> Exit:
        """Return the exit with the least way to it (m, one for each) and from it to the goal."""
        costs = [
            way + (DOUBT if one.beyond is None else 0.0) + math.dist(one.point, goal)
            for way, one in zip(reach, self._exits, strict=True)
        ]
        best = min(range(len(costs)), key=costs.__getitem__)
        # A straight line is the least there is: only where a wall stands on it the walls matter.
        if not self._walls.in_sight(self._exits[best].point, goal):
            for k, around in enumerate(self._ways_on(goal)):
                costs[k] += min(around - math.dist(self._exits[k].point, goal), ENCLOSED)
            best = min(range(len(costs)), key=costs.__getitem__)
        return self._exits[best]

    def _ways_on(self, goal: Point) -> list[float]:
        """Return the least way (m) from each exit to the goal; infinite where there is none."""
        offsets = [[max(by, -one.way) for by in _ways_from(one)] for one in self._exits]
        starts = [
            along(one.point, one.heading, by)
            for one, some in zip(self._exits, offsets, strict=True)
            for by in some
        ]
        found = iter(self._walls.ways_to_goal(goal, starts))
        ways = [[max(by, 0.0) + next(found) for by in some] for some in offsets]
        return [next(filter(math.isfinite, some), math.inf) for some in ways]

    def _ways(self, wanted: set[int]) -> tuple[list[float], list[int]]:
        """Return the way (m) from the latest place to others, and what comes before it (Dijkstra).

        Both are true for the wanted places and for those on the ways to them.
        """
        last = len(self._places) - 1
        ways, before = [math.inf] * (last + 1), [-1] * (last + 1)
        ways[last] = 0.0
        heap = [(0.0, last)]
        while heap and wanted:
            way, at = heapq.heappop(heap)
            if way > ways[at]:
                continue
            wanted.discard(at)
            for other, further in self._places[at].ways.items():
                if way + further < ways[other]:
                    ways[other], before[other] = way + further, at
                    heapq.heappush(heap, (way + further, other))
        return ways, before


def _ways_from(one: Exit) -> tuple[float, ...]:
    if one.beyond is None:
        return _INTO
    if one.ahead:
        return (math.dist(one.point, one.beyond), *_BACK)
    return _BACK


def _is_known(one: Exit, place: Place) -> bool:
    """Return whether a place has shown what there was to see through an exit."""
    if place.view is None:
        return False
    if math.dist(one.point, place.point) <= NEAR:
        return True
    return one.beyond is not None and place.sees(one.beyond)
