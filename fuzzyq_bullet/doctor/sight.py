"""Whether what the rays see, what can be touched and what the geometry tells are the same."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from fuzzyq_bullet.doctor.finding import Finding
from fuzzyq_bullet.geometry import Field, Floats
from fuzzyq_bullet.physics.engine import Engine
from fuzzyq_bullet.physics.inspection import Inspection
from fuzzyq_bullet.reading.problems import Loc
from fuzzyq_bullet.scenario import Scenario
from fuzzyq_bullet.scenario.places import Arena
from fuzzyq_bullet.shapes import Shape
from fuzzyq_bullet.shapes.motion import STILL

TOLERANCE = 0.005
"""Surfaces that lie no farther apart than this are one (m); faces may lie 1 mm outside."""
MOST = 300
"""Obstacles that are looked at; each takes about 10 ms."""
_BEFORE, _BEHIND = 0.3, 0.1
_NEAR = 0.004
_DIRECTIONS = 24
_GRAZES = 0.1
"""A ray grazes what a disc of ``TOLERANCE`` touches so much earlier (m)."""


def examine_sight(scenario: Scenario, listed: int) -> Iterator[Finding]:
    """Yield an obstacle, or the walls, that rays see elsewhere than the body touches it.

    Each stands alone in a world of its own, so that what is found is its own.

    Args:
        scenario: A realised scenario.
        listed: How many of its obstacles, the first ones, are in the scenario file.
    """
    with Engine() as engine:
        bare = scenario.arena.model_copy(update={"walls": False})
        for i, obstacle in enumerate(scenario.obstacles[:MOST]):
            loc: Loc = ("obstacles", i) if i < listed else ("random",)
            alone = obstacle.model_copy(update={"motion": STILL})
            with Inspection([alone], bare, engine=engine, model=scenario.robot.spec) as world:
                starts, ends = _rays_at(obstacle)
                if told := _differs(world, starts, ends) or _touches(world, obstacle):
                    drawn = "" if i < listed else f" (drawn as number {i})"
                    yield Finding("sight", loc, f"{obstacle.shape}{drawn}: {told}")
        if scenario.arena.walls:
            with Inspection([], scenario.arena, engine=engine, model=scenario.robot.spec) as world:
                if told := _differs(world, *_rays_in(scenario.arena)):
                    yield Finding("sight", ("arena",), f"walls: {told}")
    if len(scenario.obstacles) > MOST:
        left = len(scenario.obstacles) - MOST
        yield Finding(
            "limit", ("obstacles",), f"sight: {left} more were not looked at", wrong=False
        )


def _rays_at(obstacle: Shape) -> tuple[Floats, Floats]:
    """Return starts and ends (m) of rays at an obstacle from all around, and at every side."""
    angle = np.linspace(0.0, math.tau, _DIRECTIONS, endpoint=False)
    out = np.column_stack([np.cos(angle), np.sin(angle)])
    centre = np.array(obstacle.position)
    corners = obstacle.outline()
    sides = np.roll(corners, -1, axis=0) - corners
    lengths = np.maximum(np.hypot(*sides.T), 1e-12)
    normal = np.column_stack([sides[:, 1], -sides[:, 0]]) / lengths[:, None]
    starts, ends = [centre + (obstacle.extent() + 1.0) * out], [np.tile(centre, (len(out), 1))]
    for part in (0.1, 0.5, 0.9):
        at = corners + part * sides
        starts.append(at + _BEFORE * normal)
        ends.append(at - _BEHIND * normal)
    return np.concatenate(starts), np.concatenate(ends)


def _rays_in(arena: Arena) -> tuple[Floats, Floats]:
    """Return starts and ends (m) of rays from the middle of an arena at its walls."""
    angle = np.linspace(0.0, math.tau, _DIRECTIONS, endpoint=False)
    half = np.array(arena.size) / 2.0
    middle = np.array(arena.origin) + half
    ends = middle + np.hypot(*half) * 1.1 * np.column_stack([np.cos(angle), np.sin(angle)])
    return np.tile(middle, (len(ends), 1)), ends


def _differs(world: Inspection, starts: Floats, ends: Floats) -> str:
    """Say where rays, solid and geometry differ most; nothing if they do not."""
    field = world.field
    exact = _reach(field, starts, ends)
    # What begins in a part of a concave obstacle, or grazes a side or a corner, proves nothing.
    tells = (field.clearance(starts) > TOLERANCE) & (
        exact - _reach(field, starts, ends, TOLERANCE) < _GRAZES
    )
    starts, ends, exact = starts[tells], ends[tells], exact[tells]
    seen, solid = world.seen(starts, ends), world.solid(starts, ends)
    for mine, other, words in (
        (seen, solid, "rays meet it {by} nearer than the body does"),
        (solid, seen, "the body meets it {by} before the rays do"),
        (exact, solid, "its geometry begins {by} before its solid"),
        (solid, exact, "its solid begins {by} before its geometry"),
    ):
        apart = other - mine
        k = int(apart.argmax())
        if apart[k] > TOLERANCE:
            way = (ends[k] - starts[k]) / np.hypot(*(ends[k] - starts[k]))
            x, y = starts[k] + mine[k] * way
            told = f"{apart[k] * 1000:.0f} mm" if apart[k] < 1.0 else f"{apart[k]:.2f} m"
            return f"{words.format(by=told)} at ({x:.2f}, {y:.2f})"
    return ""


def _reach(field: Field, starts: Floats, ends: Floats, radius: float = 0.0) -> Floats:
    """Return how far (m) a disc gets along rays by the exact geometry, shape (K,)."""
    reach = []
    for start, end in zip(starts, ends, strict=True):
        x, y = (end - start).tolist()
        length, heading = math.hypot(x, y), math.atan2(y, x)
        reach.append(float(field.free_distance(start, [heading], radius, length)[0]))
    return np.array(reach)


def _touches(world: Inspection, obstacle: Shape) -> str:
    """Say where the body touches although the geometry leaves it room; nothing if nowhere."""
    radius = world.model.radius
    limit = obstacle.extent() + radius + 1.0
    for k in range(_DIRECTIONS):
        angle = k * math.tau / _DIRECTIONS
        cos, sin = math.cos(angle), math.sin(angle)
        start = np.array(obstacle.position) + limit * np.array([cos, sin])
        grown = radius + _NEAR
        free = float(world.field.free_distance(start, [angle + math.pi], grown, limit)[0])
        x, y = (start - free * np.array([cos, sin])).tolist()
        gap = world.gap(x, y, angle)
        if gap < 0.0:
            return (
                f"the body at ({x:.2f}, {y:.2f}) is {-gap * 1000:.0f} mm inside it, "
                f"the geometry leaves it {_NEAR * 1000:.0f} mm"
            )
    return ""
