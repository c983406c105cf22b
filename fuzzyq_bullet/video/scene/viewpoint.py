"""From where a run is best seen: the whole way in the picture, as large as can be."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fuzzyq_bullet.physics.camera import Lens
from fuzzyq_bullet.physics.obstacle_urdf import OBSTACLE_HEIGHT, WALL_THICKNESS

if TYPE_CHECKING:
    from fuzzyq_bullet.recording.trajectory import Trajectory
    from fuzzyq_bullet.video.map.footprints import Floats

FIELD_OF_VIEW = math.radians(26.0)
"""Narrow: far things stay nearly as large as near ones."""
PITCHES = tuple(math.radians(angle) for angle in (46.0, 52.0, 58.0))
"""How steeply the camera may look down. Flatter hides the robot, steeper is a second map."""
YAWS = tuple(math.radians(angle) for angle in (0, -20, 20, -40, 40, -65, 65, 90))
"""How far it may look past north (rad), to the left positive."""
MARGIN = 1.3
"""Least distance (m) from the robot's way to the edge of the picture: a detection line's length."""
CROSSED = 1.6
"""The whole arena is shown if its longer side is at most so many times as long as the way spans."""
HARDLY_FURTHER = 1.25
"""It is shown too if the camera is at most so many times as far away then."""
_AROUND = 0.02
"""What is left free around a whole arena, as a part of its sides."""
_EDGE = 10
"""Pixels left free along the edges of the picture."""
_MOST_POINTS = 4000


def way(trajectory: Trajectory) -> Floats:
    """Return start, goal and at most a few thousand points of the path (m), shape (N, 2)."""
    path = trajectory.ticks.position
    stride = max(1, len(path) // _MOST_POINTS)
    scenario = trajectory.scenario
    ends = [scenario.start.position, scenario.goal.position, path[-1]]
    return np.concatenate([path[::stride], np.array(ends)])


def extent_of(trajectory: Trajectory, margin: float = MARGIN) -> tuple[float, float, float, float]:
    """Return the rectangle x0, y0, x1, y1 (m) about the way, within the walls if there are any.

    It is the whole arena when that is not much larger.
    """
    points = way(trajectory)
    low, high = points.min(axis=0), points.max(axis=0)
    margin = max(margin, 0.08 * float((high - low).max()))
    low, high = low - margin, high + margin
    arena = trajectory.scenario.arena
    ends = np.array(arena.bounds).reshape(2, 2)
    if (np.array(arena.size) <= 2.2 * max(high - low)).all():
        low, high = np.minimum(low, ends[0]), np.maximum(high, ends[1])
    if arena.walls:
        low, high = np.maximum(low, ends[0]), np.minimum(high, ends[1])
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def lens_for(
    trajectory: Trajectory, points: Floats, size: tuple[int, int], *, crossed: float = CROSSED
) -> Lens:
    """Return the camera that shows points (m) of the arena largest, looking north if it can.

    It shows the whole arena, so that no wall is cut off, if the robot crosses most of it, or if
    that is hardly further away.

    Args:
        trajectory: The run.
        points: What has to be in the picture (m), shape (N, 2).
        size: Width and height of the picture (pixels).
        crossed: How many times as long as the points span the arena's longer side may be.
    """
    span = float((points.max(axis=0) - points.min(axis=0)).max())
    margin = max(MARGIN, 0.06 * span)
    angle = np.arange(8) * (math.tau / 8)
    around = np.stack([np.cos(angle), np.sin(angle)], axis=1) * margin
    flat = (points[:, None] + around).reshape(-1, 2)
    if not trajectory.scenario.arena.walls:
        return _best(flat, size)
    low, high = np.array(trajectory.scenario.arena.bounds).reshape(2, 2)
    free = WALL_THICKNESS + _AROUND * (high - low)
    # Nothing happens behind a wall.
    near = _best(np.clip(flat, low - WALL_THICKNESS, high + WALL_THICKNESS), size)
    low, high = low - free, high + free
    whole = _best(np.array([low, (high[0], low[1]), high, (low[0], high[1])]), size)
    if max(trajectory.scenario.arena.size) <= crossed * span:
        return whole
    return whole if _distance(whole) <= HARDLY_FURTHER * _distance(near) else near


def _best(flat: Floats, size: tuple[int, int]) -> Lens:
    """Return the camera that shows all that stands on points (m) of the ground largest."""
    low = np.column_stack([flat, np.zeros(len(flat))])
    corners = np.concatenate([low, np.add(low, (0.0, 0.0, OBSTACLE_HEIGHT))])
    best, best_score = None, -math.inf
    for yaw in YAWS:
        for pitch in PITCHES:
            lens = _fitted(corners, yaw, pitch, size)
            # Turning away from the map's direction costs orientation; it must be worth it.
            score = (1.0 - 0.3 * abs(yaw) / (math.pi / 2)) / _distance(lens)
            if score > best_score * (1.0 + 1e-9):
                best, best_score = lens, score
    assert best is not None
    return best


def _distance(lens: Lens) -> float:
    return math.dist(lens.eye, lens.target)


def _fitted(points: Floats, yaw: float, pitch: float, size: tuple[int, int]) -> Lens:
    """Return the nearest camera of a direction that has all points in its picture.

    A point is within the picture if its offset from the eye, to each side, is at most its distance
    times the tangent of half the picture's angle. That is linear in the eye's place in camera axes.
    """
    forward = np.array(
        [-math.sin(yaw) * math.cos(pitch), math.cos(yaw) * math.cos(pitch), -math.sin(pitch)]
    )
    right = np.array([math.cos(yaw), math.sin(yaw), 0.0])
    up = np.cross(right, forward)
    width, height = size
    tall = math.tan(FIELD_OF_VIEW / 2)
    across = [(right, tall * width / height * (1 - 2 * _EDGE / width))]
    across.append((up, tall * (1 - 2 * _EDGE / height)))

    depth = points @ -forward
    back, eye = 0.0, np.zeros(3)
    for axis, tangent in across:
        aside = points @ axis
        most, least = (aside + tangent * depth).max(), (aside - tangent * depth).min()
        eye += axis * (most + least) / 2
        back = max(back, (most - least) / 2 / tangent)
    eye -= forward * back
    middle = back - float(depth.mean())
    target = eye + forward * middle
    near = max(0.05 * back, 0.8 * (back - float(depth.max())))
    far = back - float(depth.min())
    return Lens(
        eye=(float(eye[0]), float(eye[1]), float(eye[2])),
        target=(float(target[0]), float(target[1]), float(target[2])),
        field_of_view=FIELD_OF_VIEW,
        size=size,
        near=float(near) * 0.5,
        far=float(far) * 4.0,
    )
