"""Moving obstacles as a record holds them: where they were, how fast, how near to the robot."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.columns import FAR
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.scenario.movers import courses_of
from fuzzyq_bullet.shapes.motion import placed, seen_from

if TYPE_CHECKING:
    from fuzzyq_bullet.scenario.models import Scenario

Floats: TypeAlias = NDArray[np.float64]


def poses_of(movers: Sequence[Floats], ticks: int) -> Floats:
    """Return poses of each of the ticks as one array, shape (T, M, 3).

    Each is x and y of the centre (m) and how far the obstacle has turned (rad); obstacles come in
    the order of ``scenario.movers``. Without any, M is 0.
    """
    return np.array(movers, dtype=np.float64) if len(movers) else np.zeros((ticks, 0, 3))


def clearance_of(scenario: Scenario, field: Field, points: Floats, poses: Floats) -> Floats:
    """Return the distance (m) from the robot's disc to the nearest thing at each tick.

    The point robot's moves may be long: there it is the least on the way from the tick before.

    Args:
        scenario: The scenario as it ran.
        field: Its standing obstacles and walls.
        points: The robot's centre at each tick (m), shape (T, 2).
        poses: The moving obstacles, shape (T, M, 3).
    """
    kinematic = scenario.drive == "kinematic"
    result = field.clearance_on_the_way(points) if kinematic else field.clearance(points)
    for k, index in enumerate(scenario.movers if poses.size else ()):
        shape = scenario.obstacles[index]
        alone, local = Field.of([shape]), seen_from(points, shape.position, poses[:, k])
        told = alone.clearance_on_the_way(local) if kinematic else alone.clearance(local)
        np.minimum(result, told, out=result)
    return np.asarray(result - scenario.robot.radius)


def nearest_to(scenario: Scenario, point: Sequence[float], poses: Floats) -> tuple[int, float]:
    """Return the obstacle nearest to a point (m), −1 for a wall, and its distance (m).

    Args:
        scenario: A realised scenario.
        point: The point.
        poses: Where its moving obstacles are, shape (M, 3).
    """
    moving = scenario.movers
    still = [i for i in range(len(scenario.obstacles)) if i not in set(moving)]
    field = Field.of([scenario.obstacles[i] for i in still], scenario.arena)
    found, least = field.nearest(point)
    found = found if found < 0 else still[found]
    for pose, index in zip(poses, moving, strict=True):
        shape = scenario.obstacles[index]
        gap = float(Field.of([shape]).clearance(seen_from(point, shape.position, pose))[0])
        if gap < least:
            found, least = index, gap
    return found, least


def first_poses(scenario: Scenario) -> Floats:
    """Return where the moving obstacles of a scenario are at the start, shape (M, 3)."""
    courses = courses_of(scenario.obstacles, scenario.arena, scenario.seed)
    poses = []
    for index, course in courses.items():
        (x, y), pose = scenario.obstacles[index].position, course.pose(0.0)
        poses.append((x + pose[0], y + pose[1], pose[2]))
    return np.array(poses, dtype=np.float64).reshape(-1, 3)


def checked_poses(poses: NDArray[Any] | None, scenario: Scenario, ticks: int) -> Floats:
    """Return the poses that a record holds, shape (T, M, 3).

    Args:
        poses: What it holds; nothing if it is of a version that moved nothing.
        scenario: Its scenario.
        ticks: How many ticks it has, T.

    Raises:
        ValueError: If a run cannot have left these numbers.
    """
    shape = (ticks, len(scenario.movers), 3)
    if poses is None:
        return np.broadcast_to(first_poses(scenario), shape).copy()
    if poses.dtype != np.float64 or poses.shape != shape:
        raise ValueError(f"movers.poses must be floats of shape {shape}")
    if not (np.abs(poses) < FAR).all():
        raise ValueError("movers.poses holds a number that is not finite, or is absurd")
    return poses


def speed_at(
    centre: Sequence[float], before: Sequence[float], after: Sequence[float],
    point: Sequence[float], time: float,
) -> float:  # fmt: skip
    """Return how fast (m/s) that part of an obstacle moved that is at a point in the end.

    Args:
        centre: Its centre in the scenario file (m).
        before: Its pose at the beginning; see ``placed``.
        after: Its pose in the end.
        point: The point (m).
        time: How long it took (s).
    """
    local = seen_from(point, centre, after)
    was = placed(local, centre, before)[0]
    return float(np.hypot(*(np.asarray(point) - was))) / time
