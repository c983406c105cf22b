"""Gaps that are as wide as the robot: whether it passes there is a matter of luck."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from fuzzyq_bullet.doctor.finding import Finding
from fuzzyq_bullet.geometry import WALL, Field, Floats
from fuzzyq_bullet.ground_truth import shortest_path
from fuzzyq_bullet.reading.problems import Loc
from fuzzyq_bullet.recording.metrics import MOST_ROUND
from fuzzyq_bullet.scenario import Scenario

LUCK = 0.005
"""A gap is as wide as the robot if the two differ by no more than this (m)."""
MOST_NOTES = 10


class Gap(NamedTuple):
    """A passage between two obstacles, or an obstacle and a wall.

    Attributes:
        one: Index of an obstacle.
        other: Index of the other obstacle; −1 for a wall; the same between arms of a concave one.
        width: Clear width (m).
        place: Its middle (m).
    """

    one: int
    other: int
    width: float
    place: tuple[float, float]


def examine_luck(scenario: Scenario, listed: int) -> Iterator[Finding]:
    """Yield the gaps as wide as the robot: on its shortest path they are wrong, elsewhere notes.

    The path looked at is that of a robot that is narrower by ``LUCK``: it also takes a gap that is
    just too narrow.

    Args:
        scenario: A realised scenario.
        listed: How many of its obstacles, the first ones, are in the scenario file.
    """
    width = 2.0 * scenario.robot.radius
    if len(Field.of(scenario.standing).discs) > MOST_ROUND:
        yield Finding("limit", ("obstacles",), "gaps: too many obstacles to look at", wrong=False)
        return
    gaps = [gap for gap in gaps_of(scenario) if abs(gap.width - width) <= LUCK]
    if not gaps:
        return
    route = shortest_path(scenario, scenario.robot.radius - LUCK / 2 - 1e-6)
    told = []
    for gap in gaps:
        on_path = route is not None and _apart(route.points, gap.place) <= 2.0 * LUCK
        other = "a wall" if gap.other == WALL else f"obstacles[{gap.other}]"
        if gap.other == gap.one:
            other = "itself"
        x, y = gap.place
        message = (
            f"obstacles[{gap.one}] and {other} leave a gap of {gap.width:.3f} m at "
            f"({x:.2f}, {y:.2f}), and the robot is {width:.3f} m wide"
        )
        if on_path:
            message += "; the shortest path leads through it: only luck decides"
        loc: Loc = ("obstacles", gap.one) if gap.one < listed else ("random",)
        told.append(Finding("luck", loc, message, wrong=on_path))
    yield from (one for one in told if one.wrong)
    notes = [one for one in told if not one.wrong]
    yield from notes[:MOST_NOTES]
    if len(notes) > MOST_NOTES:
        more = len(notes) - MOST_NOTES
        yield Finding("luck", ("obstacles",), f"and {more} more such gaps", wrong=False)


def gaps_of(scenario: Scenario) -> Iterator[Gap]:
    """Yield the gaps no wider than the robot and ``LUCK``, that nothing else stands in."""
    moving = set(scenario.movers)
    every = Field.of(scenario.standing, scenario.arena)
    most = 2.0 * scenario.robot.radius + LUCK
    fields = [Field.of([item]) for item in scenario.obstacles]
    points = [item.corners() for item in scenario.obstacles]
    best: dict[tuple[int, int], tuple[float, Floats, float, int]] = {}
    apart = Field.of(scenario.obstacles)
    for i, (corners, radius) in enumerate(points):
        if i in moving:
            continue
        for corner in corners:
            widths = apart.distances(corner) - radius
            for j in np.flatnonzero((widths > 0.0) & (widths <= most)).tolist():
                key = (min(i, j), max(i, j))
                if j != i and j not in moving and widths[j] < best.get(key, (np.inf,))[0]:
                    best[key] = (float(widths[j]), corner, radius, j)
            wall = _to_wall(corner, scenario) - radius
            if 0.0 < wall <= most and wall < best.get((i, WALL), (np.inf,))[0]:
                best[i, WALL] = (wall, corner, radius, WALL)
    walls = Field.of((), scenario.arena)
    for (i, j), (width, corner, radius, towards) in best.items():
        other = walls if towards == WALL else fields[towards]
        place = corner + _direction(other, corner) * (radius + width / 2.0)
        if float(every.clearance(place[None])[0]) >= width / 2.0 - 1e-4:
            x, y = place.tolist()
            # A pair is told at the one that comes later in the file, as its cause.
            yield Gap(i if j == WALL else j, j if j == WALL else i, width, (x, y))
    for i, (corners, _) in enumerate(points):
        yield from _between_arms(i, corners, every, most)


def _between_arms(index: int, corners: Floats, every: Field, most: float) -> Iterator[Gap]:
    """Yield the gaps between a corner of a concave obstacle and a side of its own."""
    side = np.roll(corners, -1, axis=0) - corners
    after = np.roll(side, -1, axis=0)
    if len(corners) < 4 or (side[:, 0] * after[:, 1] - side[:, 1] * after[:, 0] >= 0.0).all():
        return  # it is convex
    found: list[Gap] = []
    for corner in corners:
        part = ((corner - corners) * side).sum(1) / np.maximum((side**2).sum(1), 1e-300)
        way = corners + np.clip(part, 0.0, 1.0)[:, None] * side - corner
        widths = np.hypot(*way.T)
        near = np.flatnonzero((widths > 1e-6) & (widths <= most))
        places = corner + way[near] / 2.0
        clear = every.clearance(places) >= widths[near] / 2.0 - 1e-4
        found += [
            Gap(index, index, float(widths[k]), (float(x), float(y)))
            for k, (x, y) in zip(near[clear], places[clear], strict=True)
        ]
    kept: list[Gap] = []
    for gap in sorted(found, key=lambda one: one.width):
        if all(math.dist(gap.place, one.place) > 2.0 * most for one in kept):
            kept.append(gap)
    yield from kept


def _to_wall(point: Floats, scenario: Scenario) -> float:
    return float(Field.of((), scenario.arena).clearance(point[None])[0])


def _direction(field: Field, point: Floats) -> Floats:
    """Return the direction, of length 1, in which what is nearest lies."""
    step = 1e-6 * np.array([(1, 0), (-1, 0), (0, 1), (0, -1)])
    east, west, north, south = field.clearance(point + step)
    way = np.array([west - east, south - north])
    direction: Floats = way / max(float(np.hypot(*way)), 1e-300)
    return direction


def _apart(track: Floats, place: tuple[float, float]) -> float:
    """Return the least distance (m) of a point from a polyline."""
    if len(track) < 2:
        return float(np.hypot(*(track[0] - place)))
    begin, way = track[:-1], np.diff(track, axis=0)
    along = ((place - begin) * way).sum(1) / np.maximum((way**2).sum(1), 1e-300)
    foot = begin + np.clip(along, 0.0, 1.0)[:, None] * way
    return float(np.hypot(*(foot - place).T).min())
