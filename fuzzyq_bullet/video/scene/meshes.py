"""The still world as meshes: obstacles, walls, ground and the goal's flag, as far as seen."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fuzzyq_bullet.physics.camera import Lens, Mesh
from fuzzyq_bullet.physics.obstacle_urdf import OBSTACLE_HEIGHT, WALL_HEIGHT, WALL_THICKNESS
from fuzzyq_bullet.video import style
from fuzzyq_bullet.video.map.footprints import Floats, clipped, corners_for, pointer

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from fuzzyq_bullet.scenario.models import Scenario
    from fuzzyq_bullet.shapes import Shape

_CHUNK = 400
"""Obstacles of one mesh: PyBullet holds at most 131072 corners a shape."""
EVERYWHERE: Floats = 2e3 * np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
"""A piece of ground (m) that holds every arena, for who can look at all of it."""
_CIRCLE = np.stack([f(np.linspace(0.0, math.tau, 32, endpoint=False)) for f in (np.cos, np.sin)], 1)
_DOWN = 0.05
"""Solids reach a little below the ground, so that no gap shows between the two (m)."""


def ground_seen(lens: Lens, margin: float = 1.0) -> Floats:
    """Return the piece of ground in the picture and a margin (m) around it, shape (4, 2)."""
    width, height = lens.size
    # Anticlockwise from the lower left; the camera looks down, so every corner sees the ground.
    quad = lens.ground([(0, height), (width, height), (width, 0), (0, 0)])
    centre = quad.mean(axis=0)
    away = quad - centre
    reach = np.linalg.norm(away, axis=1, keepdims=True)
    return np.asarray(centre + away * (1.0 + margin / reach) * 1.02)


def ground_of(scenario: Scenario, seen: Floats) -> Floats:
    """Return the outline (m) of the ground: the arena, or all there is to see without walls."""
    if not scenario.arena.walls:
        return seen
    return clipped(np.array(scenario.arena.bounds.corners), seen)


def obstacles_seen(scenario: Scenario, lens: Lens, seen: Floats) -> list[Floats]:
    """Return outlines (m) of the standing obstacles in sight, cut off well outside the picture.

    They are convex; a concave obstacle has several.
    """
    outlines = []
    low, high = seen.min(axis=0), seen.max(axis=0)
    for obstacle in scenario.standing:
        reach = obstacle.extent()
        x, y = obstacle.position
        if x + reach < low[0] or x - reach > high[0] or y + reach < low[1] or y - reach > high[1]:
            continue
        for piece in obstacle.pieces(_corners(obstacle, lens)):
            outline = clipped(piece, seen)
            if len(outline) >= 3:
                outlines.append(outline)
    return outlines


def walls_of(scenario: Scenario, seen: Floats) -> list[Floats]:
    """Return the outlines (m) of the walls in sight."""
    if not scenario.arena.walls:
        return []
    outlines = []
    for x, y, along_x, along_y in scenario.arena.bars(WALL_THICKNESS):
        half = np.array([along_x, along_y]) / 2
        square = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]) * half + (x, y)
        outline = clipped(square, seen)
        if len(outline) >= 3:
            outlines.append(outline)
    return outlines


def solids(
    ground: Floats, obstacles: Sequence[Floats], walls: Sequence[Floats], goal: Mesh
) -> list[Mesh]:
    """Return all meshes, the ground first."""
    meshes = [prisms([ground], -_DOWN, 0.0, style.GROUND)] if len(ground) >= 3 else []
    if walls:
        meshes.append(prisms(walls, -_DOWN, WALL_HEIGHT, style.WALL))
    for k in range(0, len(obstacles), _CHUNK):
        part = obstacles[k : k + _CHUNK]
        meshes.append(prisms(part, -_DOWN, OBSTACLE_HEIGHT, style.OBSTACLE))
    return [*meshes, goal]


def flag(position: tuple[float, float], lens: Lens, scale: float) -> Mesh:
    """Return a flag that stands at ``position`` and faces the camera, ``scale`` m tall."""
    right = lens.axes()[0]
    x, y = right[:2] / np.linalg.norm(right[:2])
    pole = 0.03 * scale
    shape = [
        ((-pole, 0.0), (pole, 0.0), (pole, 1.0 * scale), (-pole, 1.0 * scale)),
        ((pole, 0.6 * scale), (0.6 * scale, 0.8 * scale), (pole, 1.0 * scale)),
    ]
    vertices: list[tuple[float, float, float]] = []
    triangles: list[tuple[int, int, int]] = []
    for polygon in shape:
        base = len(vertices)
        vertices += [(position[0] + x * a, position[1] + y * a, z) for a, z in polygon]
        triangles += [(base, base + i, base + i + 1) for i in range(1, len(polygon) - 1)]
    # Lit as if it lay flat, so that its colour is that of the goal on the map.
    normals = np.tile((0.0, 0.0, 1.0), (len(vertices), 1))
    return Mesh(np.array(vertices), normals, np.array(triangles), style.GOAL)


def goal_disc(scenario: Scenario) -> Mesh:
    """Return the goal as a thin disc on the ground."""
    return disc(scenario.goal.position, scenario.goal.radius)


def disc(position: tuple[float, float], radius: float) -> Mesh:
    """Return a thin disc of the goal's colour on the ground; ``radius`` is in metres."""
    return prisms([np.add(position, radius * _CIRCLE)], 0.0, 0.01, style.GOAL)


def heading_mark(scenario: Scenario) -> list[Mesh]:
    """Return an arrow on the ground that shows where the robot shall face in the goal, if asked."""
    goal = scenario.goal
    if goal.heading is None:
        return []
    parts = pointer(goal.position, goal.heading, 2.5 * goal.radius)
    return [prisms(parts, 0.0, 0.015, style.GOAL)]


def pole(position: tuple[float, float], height: float) -> Mesh:
    """Return a pole of the goal's colour, to be seen from everywhere; ``height`` is in metres."""
    return prisms([np.add(position, 0.02 * _CIRCLE[::4])], 0.0, height, style.GOAL)


def _corners(obstacle: Shape, lens: Lens) -> int:
    """Return how many corners make a cylinder look round at its size in the picture."""
    distance = max(math.dist(lens.eye[:2], obstacle.position), lens.eye[2])
    return 2 * corners_for(obstacle.extent() * lens.pixels_per_radian() / distance)


def prisms(outlines: Iterable[Floats], bottom: float, top: float, colour: style.Colour) -> Mesh:
    """Return upright prisms over anticlockwise convex outlines as one mesh with flat faces."""
    vertices, normals, triangles = [], [], []
    base = 0
    for outline in outlines:
        n = len(outline)
        after = np.roll(outline, -1, axis=0)
        edge = after - outline
        length = np.maximum(np.linalg.norm(edge, axis=1, keepdims=True), 1e-12)
        outward = np.column_stack([edge[:, 1], -edge[:, 0]]) / length
        sides = np.empty((n, 4, 3))
        sides[:, 0, :2] = sides[:, 3, :2] = outline
        sides[:, 1, :2] = sides[:, 2, :2] = after
        sides[:, :2, 2], sides[:, 2:, 2] = bottom, top
        vertices += [sides.reshape(-1, 3), np.column_stack([outline, np.full(n, top)])]
        flat = np.repeat(np.column_stack([outward, np.zeros(n)]), 4, axis=0)
        normals += [flat, np.tile((0.0, 0.0, 1.0), (n, 1))]
        quad = base + 4 * np.arange(n)[:, None] + np.array([[0, 1, 2, 0, 2, 3]])
        lid = base + 4 * n
        fan = np.arange(1, n - 1)
        triangles += [
            quad.reshape(-1, 3),
            np.column_stack([np.full(n - 2, lid), lid + fan, lid + fan + 1]),
        ]
        base += 5 * n
    return Mesh(
        np.concatenate(vertices), np.concatenate(normals), np.concatenate(triangles), colour
    )
