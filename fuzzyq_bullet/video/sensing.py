"""What the robot sensed and wanted at one decision, ready to be drawn where it happened."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fuzzyq_bullet.video.outline import corridor
from fuzzyq_bullet.video.timeline import NO_DECISION

if TYPE_CHECKING:
    from fuzzyq_bullet.trajectory import Trajectory
    from fuzzyq_bullet.video.outline import Floats


@dataclass(frozen=True, slots=True)
class Sensed:
    """One decision in the plane.

    Attributes:
        origin: Where the robot was when it sensed (m).
        lines: Heading (rad) and free length (m) of the left, middle and right detection line;
            empty for a planner without lines.
        corridors: What the front half of the disc sweeps along each line (m), shape (N, 2) each.
        radius: Radius of the disc that the lengths are meant for (m).
        heading: The heading decided (rad).
        target: The planner's temporary target (m); None without one, or beyond the walls.
    """

    origin: tuple[float, float]
    lines: tuple[tuple[float, float], ...]
    corridors: tuple[Floats, ...]
    radius: float
    heading: float
    target: tuple[float, float] | None


def sensed_at(trajectory: Trajectory, decision: int) -> Sensed | None:
    """Return what decision number ``decision`` was made of, None before the first."""
    if decision == NO_DECISION:
        return None
    decisions = trajectory.decisions
    x, y = trajectory.ticks.position[int(decisions.tick[decision])].tolist()
    headings, lengths = decisions.lines[decision].tolist(), decisions.lengths[decision].tolist()
    known = all(map(math.isfinite, (*headings, *lengths)))
    target_x, target_y = decisions.target[decision].tolist()
    arena, radius = trajectory.scenario.arena, trajectory.scenario.robot.radius
    aimed = math.isfinite(target_x + target_y)
    inside = 0.0 <= target_x <= arena.size[0] and 0.0 <= target_y <= arena.size[1]
    aimed = aimed and (inside or not arena.walls)
    lines = tuple(zip(headings, lengths, strict=True)) if known else ()
    return Sensed(
        origin=(x, y),
        lines=lines,
        corridors=tuple(corridor((x, y), *line, radius) for line in lines),
        radius=radius,
        heading=float(decisions.heading[decision]),
        target=(target_x, target_y) if aimed else None,
    )


def sensor_range(trajectory: Trajectory) -> float:
    """Return the longest detection line (m) of a run: what they measure where nothing is near."""
    lengths = trajectory.decisions.lengths
    longest = trajectory.scenario.robot.spec.sensor_range
    known = lengths[np.isfinite(lengths)]
    return float(known.max()) if known.size and known.max() > 0.0 else longest
