"""A motion that was written down: times and poses, from a CSV file or the scenario itself."""

from __future__ import annotations

import csv
import io
import math
from bisect import bisect_right
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias

from pydantic import Field, TypeAdapter, ValidationError, field_validator
from pydantic_core import PydanticCustomError

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import read_text
from fuzzyq_bullet.quantities import DECIMALS, Angle, Coordinate, Flag, Number
from fuzzyq_bullet.reading.problems import problem_of
from fuzzyq_bullet.shapes.motion import (
    MAX_MOTION_SPEED,
    Course,
    Motion,
    Moving,
    Pose,
    Standing,
    Surroundings,
    register_motion,
    turned_about_origin,
)

if TYPE_CHECKING:
    from typing_extensions import Self

MAX_ROWS = 20_000
"""Most rows of a trace: at 10 a second those of half an hour."""
_MAX_BYTES = 2_000_000
_COLUMNS = ("t", "x", "y", "yaw")
_ROUNDING = 1e-6
_TICK = 0.05
"""Time (s) in which a trace that is repeated goes from its last row to its first."""
_JUMP = MAX_MOTION_SPEED * _TICK
"""So it may end no farther (m) from where it begins."""
Row: TypeAlias = tuple[Annotated[Number, Field(ge=0.0, le=7200.0)], Coordinate, Coordinate, Angle]
_ROW: TypeAdapter[Row] = TypeAdapter(Row)


@register_motion
class Trace(Motion):
    """It goes from pose to pose in straight lines, at the times of its rows."""

    kind: Literal["trace"]
    file: str | None = Field(
        default=None,
        max_length=1000,
        description="CSV beside the scenario with the header t,x,y or t,x,y,yaw; its rows become "
        "the poses.",
    )
    poses: tuple[Row, ...] = Field(
        min_length=1,
        max_length=MAX_ROWS,
        description="Time (s), x, y (m) of its centre and how far it has turned (rad), a row each.",
    )
    repeat: Flag = Field(
        default=False,
        description="Whether it begins again after the last row; else it stays there.",
    )

    @field_validator("poses")
    @classmethod
    def _are_in_order(cls, poses: tuple[Row, ...]) -> tuple[Row, ...]:
        for i, (one, two) in enumerate(pairwise(poses), 2):
            if why := _misstep(one, two):
                raise PydanticCustomError("trace", "row {row} {why}", {"row": i, "why": why})
        return poses

    def course(self, obstacle: Moving, surroundings: Surroundings) -> Course:
        """Return the way along the rows."""
        return _Traced(self, obstacle.position)

    def top_speed(self, obstacle: Moving) -> float:
        """Return the speed of its edge on the way to that row which it reaches fastest."""
        extent = obstacle.extent()
        jump = math.dist(self.poses[-1][1:3], self.poses[0][1:3]) / _TICK if self.repeat else 0.0
        ways = (
            (math.dist(one[1:3], two[1:3]) + extent * abs(two[3] - one[3])) / (two[0] - one[0])
            for one, two in pairwise(self.poses)
        )
        return max(jump, *ways, 0.0)

    def conflicts(self, obstacle: Moving, standing: Standing) -> list[tuple[str, str]]:
        """Return whether it turns too fast, or jumps where it begins again."""
        extent, key = obstacle.extent(), "file" if self.file else "poses"
        for one, two in pairwise(self.poses):
            speed = extent * abs(two[3] - one[3]) / (two[0] - one[0])
            if speed > MAX_MOTION_SPEED + _ROUNDING:
                turns = f"turns so fast before t = {two[0]:g} s that its edge moves at"
                return [(key, f"{turns} {speed:.2f} m/s; at most {MAX_MOTION_SPEED:g} m/s")]
        jump = math.dist(self.poses[-1][1:3], self.poses[0][1:3])
        if self.repeat and jump > _JUMP:
            return [("repeat", f"jumps {jump:.2f} m, from its last row to its first")]
        return []

    def moved(self, x: float, y: float, turn: float) -> Self:
        """Return it with its rows turned about the origin and moved."""
        rows = tuple(
            (t, *turned_about_origin((px, py), x, y, turn, DECIMALS), yaw)
            for t, px, py, yaw in self.poses
        )
        return self.model_copy(update={"poses": rows})


class _Traced:
    def __init__(self, trace: Trace, position: tuple[float, float]) -> None:
        self._rows, self._repeat = trace.poses, trace.repeat
        self._times = [row[0] for row in trace.poses]
        self._x, self._y = position

    def pose(self, time: float, /) -> Pose:
        """Return the pose between the two rows around a time."""
        rows, last = self._rows, self._times[-1]
        if self._repeat and last > 0.0:
            time = math.fmod(time, last)
        after = bisect_right(self._times, time)
        one, two = rows[max(0, after - 1)], rows[min(after, len(rows) - 1)]
        span = two[0] - one[0]
        part = (time - one[0]) / span if span > 0.0 else 0.0
        x, y, yaw = (a + (b - a) * part for a, b in zip(one[1:], two[1:], strict=True))
        return Pose(x - self._x, y - self._y, yaw)


def _misstep(one: Row, two: Row) -> str:
    """Say what is wrong with a row that follows another; nothing if it is well."""
    if two[0] <= one[0]:
        return f"is out of order: t = {two[0]:g} s does not come after {one[0]:g} s"
    speed = math.dist(one[1:3], two[1:3]) / (two[0] - one[0])
    if speed > MAX_MOTION_SPEED + _ROUNDING:
        return f"is reached at {speed:.2f} m/s; at most {MAX_MOTION_SPEED:g} m/s"
    return ""


def read_trace(path: Path) -> list[Row]:
    """Read the rows of a trace: time, x, y and yaw, which is 0 where there is no such column.

    Raises:
        UserError: If the file is missing, or is no table of such numbers.
    """
    text = read_text(path, what="a trace", most=_MAX_BYTES)
    reader = csv.reader(io.StringIO(text))
    try:
        lines = [(reader.line_num, cells) for cells in reader if cells]
    except csv.Error as error:
        raise UserError(f"{path}:{reader.line_num}: is no CSV: {error}") from error
    header = tuple(name.strip() for name in lines[0][1]) if lines else ()
    if header not in (_COLUMNS, _COLUMNS[:3]):
        raise UserError(f"{path}:1: expected the header t,x,y or t,x,y,yaw")
    if not 2 <= len(lines) <= MAX_ROWS + 1:
        raise UserError(f"{path}: must have 1 to {MAX_ROWS} rows, got {len(lines) - 1}")
    rows: list[Row] = []
    for number, cells in lines[1:]:
        row = _numbers(cells, len(header))
        if row is None:
            raise UserError(f"{path}:{number}: expected {len(header)} numbers, {','.join(header)}")
        try:
            fits = _ROW.validate_python(row)
        except ValidationError as error:
            [at], first = error.errors()[0]["loc"], dict(error.errors()[0])
            why = problem_of(first, (at,), ()).message
            raise UserError(f"{path}:{number}: {_COLUMNS[int(at)]} {why}") from error
        if rows and (why := _misstep(rows[-1], fits)):
            raise UserError(f"{path}:{number}: {why}")
        rows.append(fits)
    return rows


def _numbers(cells: list[str], count: int) -> list[float] | None:
    try:
        row = [float(cell) for cell in cells]
    except ValueError:
        return None
    fine = len(row) == count and all(map(math.isfinite, row))
    return [*row, 0.0][:4] if fine else None


def with_trace_in(motion: Any, folder: Path) -> Any:
    """Return the data of a motion with the rows of the file that it names.

    Raises:
        UserError: If that file cannot be read, or is wrong.
    """
    named = isinstance(motion, dict) and motion.get("kind") == "trace" and "poses" not in motion
    if not named or not isinstance(motion.get("file"), str):
        return motion
    return {**motion, "poses": read_trace(folder / motion["file"])}
