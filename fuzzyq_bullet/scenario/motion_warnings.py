"""What is doubtful about how obstacles move: ways through what stands, out, or into the robot."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.geometry import Field, Floats
from fuzzyq_bullet.quantities import TOUCH
from fuzzyq_bullet.reading.problems import Loc
from fuzzyq_bullet.scenario.courses import courses_of
from fuzzyq_bullet.scenario.layouts.placing import separated
from fuzzyq_bullet.scenario.models import Scenario
from fuzzyq_bullet.shapes import Shape
from fuzzyq_bullet.shapes.motion import Course, placed, seen_from

_SAMPLE = 0.02
"""Time between two looks at a motion (s)."""
_LONGEST = 600.0
"""How much of a motion is looked at (s)."""
_AT_THE_START = 1.0
"""How long after the start (s) nobody expects the robot to get out of the way."""
_ROUNDING = 1e-3
"""What reaches less far into a wall (m) only touches it."""


def doubtful_motions(scenario: Scenario, listed: int) -> Iterator[tuple[Loc, str]]:
    """Yield places and messages of the motions that lead where they are hardly meant to.

    Nothing stops a moving obstacle but its own motion. Told is the first time that it goes into one
    that stands, the first time that it goes into a wall or, without walls, leaves the arena, and
    whether it meets the robot at the start before that can get away. That the robot may stop it
    (``stops_for_robot``) counts for the last alone.

    Args:
        scenario: A realised scenario.
        listed: How many of its obstacles, the first ones, are in the scenario file.
    """
    moving = scenario.movers
    if not moving:
        return
    still = [i for i in range(len(scenario.obstacles)) if i not in set(moving)]
    times = np.arange(0.0, min(scenario.limits.time, _LONGEST) + _SAMPLE, _SAMPLE)
    for i, course in courses_of(scenario.obstacles, scenario.arena, scenario.seed).items():
        if i >= listed:
            continue  # the layout has seen to it
        shape, poses = scenario.obstacles[i], _poses(scenario.obstacles[i], course, times)
        for k, what in (
            _met(shape, poses, scenario.obstacles, still, listed),
            _left(shape, poses, scenario),
            _at_start(shape, poses[times <= _AT_THE_START], scenario),
        ):
            if k is not None:
                x, y, _ = poses[k].tolist()
                when = f"after {times[k]:.1f} s, its centre at ({x:.2f}, {y:.2f})"
                yield ("obstacles", i, "motion"), f"{what} {when}"


def _poses(shape: Shape, course: Course, times: Floats) -> Floats:
    """Return x, y (m) of the centre and the turn (rad) at each time (s), shape (T, 3)."""
    moved = np.array([course.pose(time) for time in times.tolist()])
    return np.asarray(moved + np.array((*shape.position, 0.0)))


def _met(
    shape: Shape, poses: Floats, obstacles: Sequence[Shape], still: Sequence[int], listed: int
) -> tuple[int | None, str]:
    """Return at which of the poses it is in one that stands first, and in which."""
    first, found = len(poses), -1
    pieces, extent = shape.pieces(), shape.extent()
    for j in still:
        theirs = obstacles[j].pieces()
        near = Field.of([obstacles[j]]).clearance(poses[:first, :2]) < extent
        for k in np.flatnonzero(near).tolist():
            own = [placed(piece, shape.position, poses[k]) for piece in pieces]
            if any(not separated(a, b) for a in own for b in theirs):
                first, found = k, j
                break
    drawn = "" if found < listed else " (drawn)"
    what = f"goes into obstacles[{found}]{drawn}, which stands still,"
    return (None if found < 0 else first), what


def _left(shape: Shape, poses: Floats, scenario: Scenario) -> tuple[int | None, str]:
    """Return at which of the poses it is in a wall first, or outside where there are none."""
    low, high = np.reshape(scenario.arena.bounds, (2, 2))
    if not scenario.arena.walls:
        outside = ((poses[:, :2] < low) | (poses[:, :2] > high)).any(axis=1)
        return _first(outside), "leaves the arena"
    points, radius = shape.corners()
    cos, sin = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    turned = np.moveaxis(np.array([[cos, -sin], [sin, cos]]), 2, 0)  # shape (T, 2, 2)
    corners = (points - np.asarray(shape.position)) @ turned.transpose(0, 2, 1)
    corners += poses[:, None, :2]
    reach = radius - _ROUNDING
    beyond = (corners - reach < low) | (corners + reach > high)
    return _first(beyond.any(axis=(1, 2))), "goes into a wall"


def _at_start(shape: Shape, poses: Floats, scenario: Scenario) -> tuple[int | None, str]:
    """Return at which of the poses it touches the robot at the start first."""
    if shape.motion.stops_for_robot:
        return None, ""
    local = seen_from(
        np.broadcast_to(scenario.start.position, (len(poses), 2)), shape.position, poses
    )
    touches = Field.of([shape]).clearance(local) <= scenario.robot.radius + TOUCH
    return _first(touches), "meets the robot at the start"


def _first(seen: NDArray[np.bool_]) -> int | None:
    return int(seen.argmax()) if seen.any() else None
