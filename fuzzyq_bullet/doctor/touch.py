"""Whether the robot can touch what its sensor sees, and sees what it touches, at many poses."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from fuzzyq_bullet.doctor.finding import Finding
from fuzzyq_bullet.geometry import WALL, Field, Floats
from fuzzyq_bullet.physics.inspection import Inspection
from fuzzyq_bullet.problems import Loc
from fuzzyq_bullet.scenario import Scenario
from fuzzyq_bullet.sensors import WIDEST, CorridorSensor
from fuzzyq_bullet.sensors.base import ExactSensor
from fuzzyq_bullet.shapes import thinnest

MOST_POSES = 800
"""Poses on the grid, and again as many beside obstacles and walls."""
_GRID = 2.0
"""Neighbours are at least so far apart, in radii: the lines from each cross those from many."""
UNSEEN = WIDEST / 2 + 0.01
"""A body may be so deep in what the sensor did not see (m): a right angle that points between two
rays is half their distance deep in the body before they meet it. Solids are 1 mm off."""
_FELT = 0.005
"""Where a ray ends there is a solid no farther away than this (m)."""
_LINES = 6
"""Directions in which the robot is moved from each pose."""
_RAYS = 12
_BESIDE = 0.1
"""Room that the poses beside an obstacle leave (m)."""
_GOLDEN = math.pi * (3.0 - math.sqrt(5.0))
"""Turn from one pose to the next (rad): no two look in the same directions."""


class _Mismatch(NamedTuple):
    """A place (m) where sensor and physics differ, by how much (m), and in words."""

    place: tuple[float, float]
    by: float
    words: str


def examine_touch(scenario: Scenario, listed: int) -> Iterator[Finding]:
    """Yield each obstacle, or the walls, that the sensor and the robot's body do not agree on.

    All that stands still stands there at once. From poses on a grid over the arena, and beside
    every obstacle, the robot is put wherever the sensor says that its way is free: there it must
    touch nothing. Where a ray ends, a thin rod as high as the body must touch something.

    Args:
        scenario: A realised scenario.
        listed: How many of its obstacles, the first ones, are in the scenario file.
    """
    moving = set(scenario.movers)
    standing = [i for i in range(len(scenario.obstacles)) if i not in moving]
    worst: dict[int, _Mismatch] = {}
    with Inspection(scenario.standing, scenario.arena, model=scenario.robot.spec) as world:
        for one in _mismatches(world, scenario):
            nearest, _ = world.field.nearest(one.place)
            if nearest not in worst or one.by > worst[nearest].by:
                worst[nearest] = one
    for nearest in sorted(worst):
        told = f"{worst[nearest].words} at ({worst[nearest].place[0]:.2f}, "
        told += f"{worst[nearest].place[1]:.2f})"
        if nearest == WALL:
            yield Finding("sight", ("arena",), told)
            continue
        i = standing[nearest]
        loc: Loc = ("obstacles", i) if i < listed else ("random",)
        drawn = "" if i < listed else f" (drawn as number {i})"
        yield Finding("sight", loc, f"{scenario.obstacles[i].shape}{drawn}: {told}")


def poses_of(scenario: Scenario) -> Floats:
    """Return the places (m) to look from, shape (K, 2), K at most twice ``MOST_POSES``.

    Some are on a grid over the arena, others beside what stands there, evenly along all outlines.
    """
    (left, bottom, right, top), radius = scenario.arena.bounds, scenario.robot.radius
    spacing = max(math.sqrt((right - left) * (top - bottom) / MOST_POSES), _GRID * radius)
    xs = np.arange(left + spacing / 2, right, spacing)
    ys = np.arange(bottom + spacing / 2, top, spacing)
    grid = np.stack(np.meshgrid(xs, ys), axis=2).reshape(-1, 2)
    outlines = [one.outline() for one in scenario.standing]
    if scenario.arena.walls:
        outlines.append(np.array(scenario.arena.bounds.corners)[::-1])  # their faces look inwards
    if not outlines:
        return grid
    begin = np.concatenate(outlines)
    way = np.concatenate([np.roll(one, -1, axis=0) - one for one in outlines])
    lengths = np.maximum(np.hypot(*way.T), 1e-12)
    upto = np.cumsum(lengths)
    count = int(min(MOST_POSES, max(2 * len(begin), upto[-1] / (_GRID * radius))))
    at = (np.arange(count) + 0.5) / count * upto[-1]
    side = np.minimum(np.searchsorted(upto, at), len(begin) - 1)
    along = way[side] / lengths[side, None]
    foot = begin[side] + (at - upto[side] + lengths[side])[:, None] * along
    outwards = np.column_stack([along[:, 1], -along[:, 0]])
    return np.concatenate([grid, foot + (radius + _BESIDE) * outwards])


def _mismatches(world: Inspection, scenario: Scenario) -> Iterator[_Mismatch]:
    """Yield where what the sensor tells and what the body touches are not the same."""
    robot = scenario.robot.spec
    sensor = CorridorSensor(
        ExactSensor(range=scenario.sensor.range),
        world.cast,
        robot,
        np.random.default_rng(0),
        thinnest(scenario.standing),
    )
    for k, (x, y) in enumerate(_free(poses_of(scenario), world.field, robot.radius).tolist()):
        first = k * _GOLDEN
        headings = [first + i * math.tau / _LINES for i in range(_LINES)]
        if world.gap(x, y, first) <= 0.0:  # what stands here is found from where it does not
            continue
        for heading, free in zip(headings, sensor.sense((x, y), headings), strict=True):
            cos, sin = math.cos(heading), math.sin(heading)
            stops = max(1, math.ceil(free / (1.5 * robot.radius)))
            for way in (free * i / stops for i in range(1, stops + 1)):
                here = x + way * cos, y + way * sin
                deep = -world.gap(*here, heading)
                if deep > UNSEEN:
                    yield _Mismatch(
                        here,
                        deep,
                        f"the body is {deep * 1000:.0f} mm inside something that the sensor, "
                        f"{way:.2f} m before, did not see",
                    )
                    break
        rays = [first + i * math.tau / _RAYS for i in range(_RAYS)]
        for ray, length in zip(rays, sensor.look((x, y), rays).tolist(), strict=True):
            if length >= sensor.range + sensor.radius:
                continue
            end = x + length * math.cos(ray), y + length * math.sin(ray)
            away = world.rod_gap(*end)
            if away > _FELT:
                far = f"{away * 1000:.0f} mm" if away < world.FAR else "far"
                yield _Mismatch(
                    end, away, f"the sensor sees something, the nearest solid is {far} away"
                )


def _free(places: Floats, field: Field, radius: float) -> Floats:
    """Return those of the places (m) where there is room for the robot's disc."""
    kept: Floats = places[field.clearance(places) > radius]
    return kept
