"""Whether the robot can touch what its sensor sees, and sees what it touches, at many poses."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from fuzzyq_bullet.doctor.finding import Finding
from fuzzyq_bullet.geometry import WALL, Field, Floats
from fuzzyq_bullet.physics.inspection import Inspection
from fuzzyq_bullet.reading.problems import Loc
from fuzzyq_bullet.scenario import Scenario
from fuzzyq_bullet.sensors import WIDEST, CorridorSensor
from fuzzyq_bullet.sensors.base import ExactSensor
from fuzzyq_bullet.shapes import thinnest

MOST_POSES = 800
"""At most so many poses are on the grid, and as many beside obstacles and walls."""
_GRID = 2.0
"""Neighbouring poses are at least so far apart, in radii of the robot."""
UNSEEN = WIDEST / 2 + 0.01
"""How deep (m) the body may be in an obstacle that the sensor did not see. A right angle between
two rays is inside the body by half their distance before a ray meets it. Solids are 1 mm off."""
_FELT = 0.005
"""A solid is no farther than this from the end of a ray (m)."""
_LINES = 6
"""Directions in which the robot is moved from each pose."""
_RAYS = 12
"""Rays that are checked from each pose."""
_BESIDE = 0.1
"""Gap between the robot and the obstacle that it is put beside (m)."""
_GOLDEN = math.pi * (3.0 - math.sqrt(5.0))
"""The golden angle (rad): the turn from one pose to the next, so that no two look alike."""


class _Mismatch(NamedTuple):
    """Where sensor and physics differ.

    Attributes:
        place: Where (m).
        by: By how much (m).
        words: The difference in words.
    """

    place: tuple[float, float]
    by: float
    words: str


def examine_touch(scenario: Scenario, listed: int) -> Iterator[Finding]:
    """Yield a finding for each obstacle, and the walls, that sensor and physics do not agree on.

    The robot looks from poses on a grid over the arena, and beside every standing obstacle. It is
    then put wherever the sensor says that its way is free: there it must touch nothing. Where a ray
    ends, a thin rod as high as the body must touch something.

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
        one = worst[nearest]
        text = f"{one.words} at ({one.place[0]:.2f}, {one.place[1]:.2f})"
        if nearest == WALL:
            yield Finding("sight", ("arena",), text)
            continue
        i = standing[nearest]
        loc: Loc = ("obstacles", i) if i < listed else ("random",)
        drawn = "" if i < listed else f" (drawn as number {i})"
        yield Finding("sight", loc, f"{scenario.obstacles[i].shape}{drawn}: {text}")


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
    """Yield where sensor and physics differ, as seen from all poses with room for the robot."""
    robot = scenario.robot.spec
    sensor = CorridorSensor(
        ExactSensor(range=scenario.sensor.range),
        world.cast,
        robot,
        np.random.default_rng(0),
        thinnest(scenario.standing),
    )
    for k, (x, y) in enumerate(_with_room(poses_of(scenario), world.field, robot.radius).tolist()):
        heading = k * _GOLDEN
        if world.gap(x, y, heading) <= 0.0:  # poses beside this obstacle show what it is
            continue
        yield from _unseen(world, sensor, (x, y), heading, robot.radius)
        yield from _untouched(world, sensor, (x, y), heading)


def _unseen(
    world: Inspection,
    sensor: CorridorSensor,
    place: tuple[float, float],
    heading: float,
    radius: float,
) -> Iterator[_Mismatch]:
    """Yield where the robot's body touches something though the sensor says that it is free.

    Args:
        world: What stands, in the physics.
        sensor: The sensor.
        place: Where the robot looks from (m).
        heading: The first of the directions in which it is moved (rad).
        radius: The robot's radius (m).
    """
    x, y = place
    headings = [heading + i * math.tau / _LINES for i in range(_LINES)]
    for line, free in zip(headings, sensor.sense(place, headings), strict=True):
        cos, sin = math.cos(line), math.sin(line)
        stops = max(1, math.ceil(free / (1.5 * radius)))
        for way in (free * i / stops for i in range(1, stops + 1)):
            here = x + way * cos, y + way * sin
            depth = -world.gap(*here, line)
            if depth > UNSEEN:
                words = f"the body is {depth * 1000:.0f} mm inside something that the sensor, "
                yield _Mismatch(here, depth, f"{words}{way:.2f} m before, did not see")
                break


def _untouched(
    world: Inspection, sensor: CorridorSensor, place: tuple[float, float], heading: float
) -> Iterator[_Mismatch]:
    """Yield where a ray of the sensor ends though there is no solid.

    Args:
        world: What stands, in the physics.
        sensor: The sensor.
        place: Where the robot looks from (m).
        heading: Heading of the first ray (rad).
    """
    x, y = place
    rays = [heading + i * math.tau / _RAYS for i in range(_RAYS)]
    for ray, length in zip(rays, sensor.look(place, rays).tolist(), strict=True):
        if length >= sensor.range + sensor.radius:
            continue
        end = x + length * math.cos(ray), y + length * math.sin(ray)
        gap = world.rod_gap(*end)
        if gap > _FELT:
            far = f"{gap * 1000:.0f} mm" if gap < world.FAR else "far"
            yield _Mismatch(end, gap, f"the sensor sees something, the nearest solid is {far} away")


def _with_room(places: Floats, field: Field, radius: float) -> Floats:
    """Return the places (m) where there is room for the robot's disc."""
    kept: Floats = places[field.clearance(places) > radius]
    return kept
