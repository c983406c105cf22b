"""Outlines on the ground: what obstacles and corridors look like from straight above."""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]

_HALF_DISC = np.linspace(-math.pi / 2, math.pi / 2, 13)


def corners_for(radius: float) -> int:
    """Return how many corners a circle of a radius in pixels needs to look round."""
    return min(max(math.ceil(math.pi * math.sqrt(max(radius, 0.0))), 12), 900)


def corridor(origin: tuple[float, float], heading: float, length: float, radius: float) -> Floats:
    """Return what the front half of a disc covers that moves ``length`` (m) along ``heading``."""
    angle = heading + _HALF_DISC
    tip = np.stack([np.cos(angle), np.sin(angle)], axis=1) * radius
    tip += (origin[0] + length * math.cos(heading), origin[1] + length * math.sin(heading))
    side = np.array([(math.sin(heading), -math.cos(heading))]) * radius
    return np.concatenate([origin + side, tip, origin - side])


def circle(centre: tuple[float, float], radius: float) -> Floats:
    """Return 49 points (m) of a circle, closed: the last is the first."""
    angle = np.linspace(0.0, math.tau, 49)
    return np.asarray(np.stack([np.cos(angle), np.sin(angle)], axis=1) * radius + centre)


def arrow(origin: tuple[float, float], heading: float, size: float) -> Floats:
    """Return an arrow head (m) that points along ``heading``, its middle at ``origin``."""
    cos, sin = math.cos(heading), math.sin(heading)
    shape = np.array([(0.62, 0.0), (-0.48, 0.5), (-0.24, 0.0), (-0.48, -0.5)]) * size
    return np.asarray(shape @ np.array([(cos, sin), (-sin, cos)]) + origin)


def pointer(origin: tuple[float, float], heading: float, length: float) -> list[Floats]:
    """Return an arrow of a length (m) that begins at ``origin``: its shaft and its head.

    Both are convex and anticlockwise, shapes (4, 2) and (3, 2).
    """
    cos, sin = math.cos(heading), math.sin(heading)
    turn = np.array([(cos, sin), (-sin, cos)])
    shaft = np.array([(0.0, -0.05), (0.65, -0.05), (0.65, 0.05), (0.0, 0.05)])
    head = np.array([(0.6, -0.22), (1.0, 0.0), (0.6, 0.22)])
    return [np.asarray(part * length @ turn + origin) for part in (shaft, head)]


def clipped(polygon: Floats, window: Floats) -> Floats:
    """Return the part of a convex polygon within a convex anticlockwise window; maybe empty."""
    for a, b in zip(window, np.roll(window, -1, axis=0), strict=True):
        if not len(polygon):
            break
        edge = b - a
        inside = edge[0] * (polygon[:, 1] - a[1]) - edge[1] * (polygon[:, 0] - a[0])
        if (inside >= 0.0).all():
            continue
        kept: list[Floats] = []
        for i in range(len(polygon)):
            p, q, here, there = polygon[i - 1], polygon[i], inside[i - 1], inside[i]
            if (here < 0.0) != (there < 0.0):
                kept.append(p + (q - p) * (here / (here - there)))
            if there >= 0.0:
                kept.append(q)
        polygon = np.array(kept).reshape(-1, 2)
    return polygon
