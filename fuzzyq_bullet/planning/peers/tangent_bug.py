"""The planner ``tangent-bug``: TangentBug of Kamon, Rivlin and Rimon (1998).

I. Kamon, E. Rimon, E. Rivlin: TangentBug: a range-sensor-based navigation algorithm. International
Journal of Robotics Research 17(9), 1998. It has two modes:

- *Motion to goal*: along the local tangent graph, which is what a scan of limited range tells: the
  robot, the goal where it can be reached straight, and both ends of every obstacle that is seen.
  The robot takes the node V with the least d(x, V) + d(V, goal), among those that are nearer to the
  goal than the robot is. If there is none, the robot has come to a local minimum of the distance to
  the goal on the boundary of an obstacle.
- *Boundary following*: round that obstacle, to one side. d_followed is the least distance to the
  goal of any point of the boundary that was seen since; d_reach the least of any other point that
  can be reached straight. The robot leaves the boundary as soon as d_reach < d_followed. If it
  comes back to where it began without that, the goal cannot be reached, and it says so.

The paper's robot is a point. Here the free distance of the disc along a heading takes the place of
a ray, so that the robot is a point among grown obstacles. What is different: d_reach must be less
by 5 cm, or the robot would leave at once by noise of a few millimetres. The node that was chosen
before stays unless another is shorter by 10 cm. Along a boundary a ray turns until enough is free
(``wall_following``), in place of the paper's path along local tangents.

Tuning (docs/results/peers.md): ``enough`` is the only parameter, the best of 5 values on 24
training fields.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from fuzzyq_bullet.planning.base import Floats, Observation
from fuzzyq_bullet.planning.decision import Decision, Mode
from fuzzyq_bullet.planning.peers.surroundings import PeerSettings, full_step, to_goal
from fuzzyq_bullet.planning.peers.wall_following import (
    ahead,
    follow_wall,
    free_heading,
    towards,
)
from fuzzyq_bullet.planning.safety_filter import RESERVE
from fuzzyq_bullet.planning.scan import JUMP, Point, scan_360
from fuzzyq_bullet.quantities import Number

SWITCH = 0.1
"""Another node must be nearer by this (m), so that the robot does not waver between two."""
UNDERCUT = 0.05
"""d_reach must be less than d_followed by this (m)."""
ARRIVED = 0.1
"""So near (m) it is at a point, and round an obstacle where it began; so many times as much for a
larger robot."""
ROUND = 1.5
"""It can be back where it began after so much way (m) only."""
WIDEST = math.radians(60.0)
"""A node's edge is not passed further aside than this (rad)."""
_Positive = Annotated[Number, Field(gt=0.0, le=10.0)]


class TangentBugSettings(PeerSettings):
    """TangentBug of Kamon, Rimon and Rivlin (1998)."""

    name: Literal["tangent-bug"] = "tangent-bug"
    enough: _Positive = Field(
        default=0.3,
        description="Along a boundary it takes the first heading with so much free (m, for the "
        "usual robot).",
    )


class Node(NamedTuple):
    """An end of an obstacle in the local tangent graph.

    Attributes:
        heading: World heading that just passes it (rad).
        point: Where it is (m).
        side: +1 if the obstacle lies to the right of the heading, so that it is passed on its left.
        far: Its distance to the goal (m).
        length: Length of the way to the goal by it (m).
    """

    heading: float
    point: Point
    side: int
    far: float
    length: float


class Following(NamedTuple):
    """What it remembers of the boundary that it follows.

    Attributes:
        side: +1 if it turns left until it is free: the obstacle is on its right.
        contact: The last point that stopped it (m).
        followed: d_followed (m).
        driven: How far it has come along the boundary (m).
        start: Where it has been when it was on the boundary for the first time (m).
    """

    side: int
    contact: Point
    followed: float
    driven: float = 0.0
    start: Point | None = None


class View(NamedTuple):
    """What a scan tells of the free space around the robot, a point among grown obstacles.

    Attributes:
        headings: World headings (rad) in [0, 2π), increasing, shape (N,).
        lengths: Free distance along each (m), shape (N,).
        ends: Where these end (m), shape (N, 2).
        stopped: Whether something stops the robot there, shape (N,).
        range: How far the robot sees (m).
        jump: Where the free distance changes by more (m), an obstacle ends.
    """

    headings: Floats
    lengths: Floats
    ends: Floats
    stopped: NDArray[np.bool_]
    range: float
    jump: float


class TangentBugPlanner:
    """Goes to the goal along the local tangent graph, and round what holds it up."""

    def __init__(self, settings: TangentBugSettings) -> None:
        self._settings = settings
        self._goal: Point | None = None
        self._following: Following | None = None
        self._leaving: tuple[Point, float] | None = None
        self._node: Node | None = None
        self._at: Point | None = None

    def decide(self, observation: Observation, /) -> Decision:
        """Return the next step."""
        if observation.goal != self._goal:
            self._goal = observation.goal
            self._following = self._leaving = self._node = None
        view = view_of(observation)
        moved = 0.0 if self._at is None else math.dist(self._at, observation.position)
        self._at = observation.position
        goal, left = to_goal(observation)
        seen = left if self._following is not None else min(left, observation.range)
        if self._free(observation, goal) >= seen - 1e-6:
            self._following = self._leaving = self._node = None
            return self._go(observation, goal, "routine", observation.goal)
        if self._following is None:
            decision = self._to_goal(observation, view, goal, left)
            if decision is not None:
                return decision
        assert self._following is not None
        return self._along(observation, view, moved)

    def _to_goal(
        self, observation: Observation, view: View, goal: float, left: float
    ) -> Decision | None:
        """Return a step to the best node; None if the robot has to follow the boundary."""
        if self._leaving is not None:
            point, below = self._leaving
            bearing, far = towards(observation.position, point)
            near = far < ARRIVED * observation.size
            if left >= below and not near and self._free(observation, bearing) > RESERVE:
                return self._go(observation, bearing, "following", point)
            self._leaving = None
        nodes = nodes_of(view, observation)
        nearer = [node for node in nodes if node.far < left]
        if nearer:
            best = min(nearer, key=lambda node: node.length)
            old = self._node
            if old is not None:
                kept = [
                    n
                    for n in nearer
                    if math.dist(n.point, old.point) < SWITCH * 2.0 and n.side == old.side
                ]
                same = min(kept, key=lambda n: math.dist(n.point, old.point), default=best)
                best = same if same.length < best.length + SWITCH else best
            self._node = best
            found = free_heading(
                observation, best.heading, best.side, self._settings.enough, WIDEST
            )
            if found is not None:
                return self._go(observation, found.heading, "routine", best.point)
        side = min(nodes, key=lambda node: node.length).side if nodes else 1
        contact = ahead(
            observation.position, goal, self._free(observation, goal) + observation.radius
        )
        self._following, self._node = Following(side, contact, math.inf), None
        return None

    def _along(self, observation: Observation, view: View, moved: float) -> Decision:
        """Return a step along the boundary, or the first one away from it."""
        following, size = self._following, observation.size
        assert following is not None
        bearing, _ = towards(observation.position, following.contact)
        goal = np.array(observation.goal)
        boundary = _same_obstacle(view, bearing)
        distance = np.hypot(*(view.ends - goal).T)
        followed = min(following.followed, distance[boundary].min(initial=np.inf))
        followed = min(followed, math.dist(observation.position, observation.goal))
        others = ~boundary
        reach = distance[others].min(initial=np.inf)
        if reach < followed - UNDERCUT:
            x, y = view.ends[others][np.argmin(distance[others])].tolist()
            self._following, self._leaving = None, ((x, y), followed)
            bearing, _ = towards(observation.position, (x, y))
            return self._go(observation, bearing, "following", (x, y))
        driven, start = following.driven + moved, following.start
        if start is None and driven > ROUND / 3.0 * size:
            start = observation.position
        elif (
            start is not None
            and driven > ROUND * size + ROUND / 3.0 * size
            and (math.dist(start, observation.position) < ARRIVED * size)
        ):
            return Decision(observation.heading, 0.0, mode="following", hopeless=True)
        found = follow_wall(observation, following.contact, following.side, self._settings.enough)
        if found is None:
            return Decision(observation.heading, 0.0, mode="following")
        heading, contact = found
        self._following = following._replace(
            followed=followed, driven=driven, start=start, contact=contact
        )
        return self._go(observation, heading, "following", contact)

    def _free(self, observation: Observation, heading: float) -> float:
        """Return how far the robot can go along a heading for certain (m)."""
        [free] = observation.sense([heading])
        return free if free >= observation.range else max(0.0, free - observation.uncertainty)

    def _go(self, observation: Observation, heading: float, mode: Mode, to: Point) -> Decision:
        """Return a step along a heading, no longer than what is free."""
        usable = max(0.0, self._free(observation, heading) - RESERVE)
        left = math.dist(observation.position, observation.goal)
        return Decision(
            heading,
            min(full_step(observation), left, usable)
            if observation.motion is None
            else full_step(observation),
            reach=usable,
            mode=mode,
            aim=to,
        )


def view_of(observation: Observation) -> View:
    """Scan all around."""
    scan = scan_360(observation)
    headings, lengths = np.array(scan.headings), np.array(scan.lengths)
    lengths = np.where(
        lengths < scan.range, np.maximum(0.0, lengths - observation.uncertainty), lengths
    )
    ways = np.column_stack([np.cos(headings), np.sin(headings)])
    ends = np.array(observation.position) + lengths[:, None] * ways
    return View(headings, lengths, ends, lengths < scan.range - 1e-9, scan.range, JUMP * scan.size)


def nodes_of(view: View, observation: Observation) -> list[Node]:
    """Return both ends of every obstacle in view."""
    nodes: list[Node] = []
    lengths, count = view.lengths, len(view.lengths)
    goal = np.array(observation.goal)
    for k in range(count):
        for side in (1, -1):
            beyond = (k + side) % count
            if not view.stopped[k] or lengths[beyond] < lengths[k]:
                continue
            if view.stopped[beyond] and lengths[beyond] - lengths[k] <= view.jump:
                continue
            point = (float(view.ends[k, 0]), float(view.ends[k, 1]))
            far = math.dist(point, goal)
            nodes.append(
                Node(float(view.headings[beyond]), point, side, far, float(lengths[k]) + far)
            )
    return nodes


def _same_obstacle(view: View, bearing: float) -> NDArray[np.bool_]:
    """Return which headings end at the obstacle that lies at a bearing (rad), shape (N,)."""
    count = len(view.lengths)
    same = np.zeros(count, dtype=bool)
    off = np.abs(np.angle(np.exp(1j * (view.headings - bearing))))
    middle = int(np.argmin(np.where(view.stopped, off, np.inf)))
    for side in (1, -1):
        k = middle
        while view.stopped[k] and not (same[k] and k != middle):
            same[k] = True
            following = (k + side) % count
            if abs(view.lengths[following] - view.lengths[k]) > view.jump:
                break
            k = following
    return same
