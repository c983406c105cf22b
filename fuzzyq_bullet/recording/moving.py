"""Moving obstacles as a record holds them: where they were, how fast, how near to the robot."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.columns import FAR, Column, Columns, csv_of
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.scenario.courses import courses_of
from fuzzyq_bullet.shapes.motion import placed, seen_from

if TYPE_CHECKING:
    from fuzzyq_bullet.recording.trajectory import Trajectory
    from fuzzyq_bullet.scenario.models import Scenario

Floats: TypeAlias = NDArray[np.float64]

_LEAST_WAY = 1e-6
"""What moves less between two ticks (m) stands."""


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


MOVER_COLUMNS: Columns = {
    "time": Column("s", "Simulated time."),
    "obstacle": Column("", "Index of the obstacle in the scenario.", whole=True),
    "position": Column("m", "Its centre, world frame.", (("x", "y"),)),
    "turn": Column("rad", "How far it has turned about its centre, compared with the scenario."),
    "heading": Column("rad", "In which direction it goes; blank if it goes nowhere.", blank=True),
}
"""A row for each moving obstacle at each tick."""


def movers_csv(trajectory: Trajectory, *, units: bool = False) -> str:
    """Return where the moving obstacles were as CSV; see docs/reference/record.md, ``csv_of``."""
    poses, moving = trajectory.movers, trajectory.scenario.movers
    count = poses.shape[1]
    rows = {
        "time": np.repeat(trajectory.ticks.time, count),
        "obstacle": np.tile(np.array(moving[:count], dtype=np.int64), len(poses)),
        "position": poses[:, :, :2].reshape(-1, 2),
        "turn": poses[:, :, 2].ravel(),
        "heading": headings_of(trajectory).ravel(),
    }
    return csv_of(MOVER_COLUMNS, rows, units=units)


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


def headings_of(trajectory: Trajectory) -> Floats:
    """Return in which direction (rad) each moving obstacle goes from each tick, shape (T, M).

    What stands keeps the direction it had, or is to have; what never goes anywhere has NaN.
    """
    poses = trajectory.movers
    steps = np.diff(poses[:, :, :2], axis=0, append=poses[-1:, :, :2])
    goes = np.hypot(steps[..., 0], steps[..., 1]) > _LEAST_WAY
    headings = np.arctan2(steps[..., 1], steps[..., 0])
    # The latest tick at which it went anywhere; before the first such tick, that one.
    latest = np.maximum.accumulate(np.where(goes, np.arange(len(poses))[:, None], -1), axis=0)
    at = np.where(latest < 0, goes.argmax(axis=0)[None], latest) if len(poses) else latest
    told = np.take_along_axis(headings, at, axis=0)
    return np.where(goes.any(axis=0)[None], told, np.nan)


def poses_at(trajectory: Trajectory, time: float) -> Floats:
    """Return where the moving obstacles are at any time (s) of a run, shape (M, 3)."""
    ticks, poses = trajectory.ticks.time, trajectory.movers
    after = min(max(int(np.searchsorted(ticks, time, side="right")), 1), len(ticks) - 1)
    if after < 1:
        return np.asarray(poses[0])
    one, two = poses[after - 1], poses[after]
    part = (time - float(ticks[after - 1])) / float(ticks[after] - ticks[after - 1])
    return poses_between(one, two, min(max(part, 0.0), 1.0))


def poses_between(one: Floats, two: Floats, part: float) -> Floats:
    """Return poses between two, shape (M, 3) each, at a part of the way from the first, 0 to 1."""
    between = one + (two - one) * part
    turn = np.remainder(two[:, 2] - one[:, 2] + np.pi, 2 * np.pi) - np.pi
    between[:, 2] = one[:, 2] + turn * part
    return np.asarray(between)
