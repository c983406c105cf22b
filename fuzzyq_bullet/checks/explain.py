"""Why a run missed what it was expected to do: when, where, and at which obstacle."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from fuzzyq_bullet.checks.verdict import Touch
from fuzzyq_bullet.collision_text import name_of, plain, touch_in_words
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.metrics import Result
from fuzzyq_bullet.scenario.yaml_tree import Node, read_tree
from fuzzyq_bullet.trajectory import Trajectory


class Source:
    """The lines of a scenario file.

    Args:
        file: The file, which was read as a scenario before.
    """

    def __init__(self, file: str) -> None:
        self._tree: Node = read_tree(Path(file).read_text(encoding="utf-8-sig"), file)
        obstacles = self._tree.children.get("obstacles")
        self.listed = len(obstacles.lines) if obstacles is not None else 0

    def line_of(self, *keys: str) -> int:
        """Return the line of the first of these keys that the file has; else its first line."""
        return next((self._tree.lines[key] for key in keys if key in self._tree.lines), 1)

    def line_of_obstacle(self, index: int) -> int:
        """Return the line that put an obstacle, or a wall (−1), where it is."""
        if index < 0:
            return self.line_of("arena")
        if index < self.listed:
            return self._tree.children["obstacles"].lines[index]
        return self.line_of("random")


def touched(trajectory: Trajectory, source: Source) -> Touch | None:
    """Return what the robot touched; None if it touched nothing."""
    collision = trajectory.collision
    if collision is None:
        return None
    return Touch(
        what=name_of(trajectory.scenario, collision.obstacle, source.listed),
        obstacle=collision.obstacle,
        line=source.line_of_obstacle(collision.obstacle),
        point=(round(collision.point[0], 6), round(collision.point[1], 6)),
        time_s=round(collision.time, 6),
        distance_m=0.0,
    )


def nearest(trajectory: Trajectory, source: Source) -> Touch:
    """Return what the robot came nearest to."""
    scenario, ticks = trajectory.scenario, trajectory.ticks
    field = Field.of(scenario.obstacles, scenario.arena)
    i = int(np.argmin(ticks.clearance))
    x, y = ticks.position[i].tolist()
    if scenario.drive == "kinematic" and i:  # somewhere on the way to that tick
        _, places = field.clearance_on_ways(ticks.position[i - 1], ticks.position[i])
        x, y = places[0].tolist()
    closest, _ = field.nearest((x, y))
    return Touch(
        what=name_of(scenario, closest, source.listed),
        obstacle=closest,
        line=source.line_of_obstacle(closest),
        point=(round(x, 6), round(y, 6)),
        time_s=round(float(ticks.time[i]), 6),
        distance_m=round(float(ticks.clearance[i]), 6),
    )


def in_words(touch: Touch, file: str) -> str:
    """Say when and where it was, at which obstacle and line of the file."""
    place = f"{file}:{touch.line}"
    if touch.distance_m <= 0:
        return touch_in_words(touch.what, touch.point, touch.time_s, place)
    x, y = (plain(value, 2) for value in touch.point)
    near = f"{plain(touch.distance_m, 3)} m from {touch.what} ({place})"
    return f"nearest after {touch.time_s:.2f} s, {near}, the robot at ({x}, {y})"


def whereabouts(trajectory: Trajectory, result: Result) -> str:
    """Say where a run ended that neither arrived nor hit anything."""
    x, y = trajectory.ticks.position[-1]
    left = math.dist((x, y), trajectory.scenario.goal.position)
    return (
        f"ended at ({plain(x, 2)}, {plain(y, 2)}) after {result.time_s:.1f} s, "
        f"{plain(left, 2)} m from the goal"
    )
