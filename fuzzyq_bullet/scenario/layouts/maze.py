"""Mazes of boxes, in which every place can be reached from every other."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.quantities import DECIMALS, MAX_OBSTACLES, MIN_RADIUS, Number
from fuzzyq_bullet.robots import FUZZYQ
from fuzzyq_bullet.scenario.layouts.base import Conflict, Layout, register_layout
from fuzzyq_bullet.scenario.layouts.placing import is_clear, leaves_a_way
from fuzzyq_bullet.shapes import Box

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fuzzyq_bullet.scenario.models import Scenario

_ATTEMPTS = 30
"""Mazes drawn before listed obstacles are taken to block every one."""
_ROOM = 0.1
"""What a corridor is wider than the robot, at least (m)."""

_ROUNDING = 2e-4
"""Farthest that a wall moves (m) when it becomes one with others and is rounded again."""


@register_layout
class Maze(Layout):
    """A maze that fills the arena.

    Carved by a walk that turns at random and goes back where it is stuck, which reaches every cell
    by exactly one way; then some more walls are taken away, and those that come too near to start
    or goal. Walls in line are one box.
    """

    layout: Literal["maze"]
    corridor: Annotated[Number, Field(ge=2 * FUZZYQ.radius + _ROOM, le=1000.0)] = Field(
        default=0.9, description="Least free width between walls (m)."
    )
    thickness: Annotated[Number, Field(ge=2 * MIN_RADIUS, le=10.0)] = Field(
        default=0.15, description="Of the walls (m)."
    )
    loops: Annotated[Number, Field(ge=0.0, le=1.0)] = Field(
        default=0.1, description="Share of the walls that is taken away again, for other ways."
    )
    margin: Annotated[Number, Field(ge=0.0, le=100.0)] = Field(
        default=0.1, description="Least gap to the robot at the start and to the goal disc (m)."
    )

    def conflicts(self, scenario: Scenario) -> list[Conflict]:
        """Return corridors too narrow for the robot, or for so large an arena: too many walls."""
        least = 2 * scenario.robot.radius + _ROOM
        if self.corridor < least:
            message = f"must be at least {least:g} for this robot, got {self.corridor:g}"
            return [(("corridor",), message)]
        columns, rows = self._cells(scenario.arena.size)
        if columns * rows <= MAX_OBSTACLES - len(scenario.obstacles):
            return []
        message = f"makes {columns} × {rows} cells, more than {MAX_OBSTACLES}; use wider corridors"
        return [(("corridor",), message)]

    def draw(self, scenario: Scenario, rng: np.random.Generator) -> tuple[Box, ...]:
        """Draw the maze; with listed obstacles in it, again until they leave a way."""
        for _ in range(_ATTEMPTS):
            walls = self._walls(scenario, rng)
            if not scenario.obstacles or leaves_a_way(scenario, walls):
                return walls
        raise UserError(
            f"{scenario.name}: random.layout: the listed obstacles leave no way through a maze; "
            "use fewer, or wider corridors"
        )

    def _cells(self, size: tuple[float, float]) -> tuple[int, int]:
        pitch = self.corridor + self.thickness
        return max(1, math.floor(size[0] / pitch)), max(1, math.floor(size[1] / pitch))

    def _walls(self, scenario: Scenario, rng: np.random.Generator) -> tuple[Box, ...]:
        size = scenario.arena.size
        cells = self._cells(size)
        upright, level = carve(cells, rng)
        for walls in (upright, level):
            walls &= rng.random(walls.shape) >= self.loops
        px, py = size[0] / cells[0], size[1] / cells[1]
        boxes: list[Box] = []
        for k, i in np.argwhere(upright).tolist():  # to be merged once all are known to stay
            upright[k, i] = self._may_stay(scenario, self._upright(px * (k + 1), i, i + 1, py))
        for i, k in np.argwhere(level).tolist():
            level[i, k] = self._may_stay(scenario, self._level(py * (k + 1), i, i + 1, px))
        for k, line in enumerate(upright):
            boxes += [self._upright(px * (k + 1), a, b, py) for a, b in runs(line)]
        for k, line in enumerate(level.T):
            boxes += [self._level(py * (k + 1), a, b, px) for a, b in runs(line)]
        return tuple(boxes)

    def _may_stay(self, scenario: Scenario, box: Box) -> bool:
        return is_clear(scenario, (box,), self.margin + _ROUNDING)

    def _upright(self, x: float, begin: int, end: int, pitch: float) -> Box:
        """A wall along y. Its ends reach half its thickness farther, to close the corners."""
        length = (end - begin) * pitch + self.thickness
        at = round(x, DECIMALS), round((begin + end) / 2 * pitch, DECIMALS)
        return Box(shape="box", position=at, size=(self.thickness, round(length, DECIMALS)))

    def _level(self, y: float, begin: int, end: int, pitch: float) -> Box:
        """A wall along x."""
        length = (end - begin) * pitch + self.thickness
        at = round((begin + end) / 2 * pitch, DECIMALS), round(y, DECIMALS)
        return Box(shape="box", position=at, size=(round(length, DECIMALS), self.thickness))


def carve(
    cells: tuple[int, int], rng: np.random.Generator
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return the walls that remain when every cell is reached by exactly one way.

    Args:
        cells: Columns C and rows R.
        rng: Chooses the ways.

    Returns:
        Upright walls, shape (C − 1, R), between columns k and k + 1; and level ones, shape
        (C, R − 1), between rows k and k + 1.
    """
    columns, rows = cells
    upright = np.ones((columns - 1, rows), dtype=bool)
    level = np.ones((columns, rows - 1), dtype=bool)
    seen = np.zeros(cells, dtype=bool)
    path = [(int(rng.integers(columns)), int(rng.integers(rows)))]
    seen[path[0]] = True
    while path:
        x, y = path[-1]
        choices = [
            (x + dx, y + dy)
            for dx, dy in ((1, 0), (0, 1), (-1, 0), (0, -1))
            if 0 <= x + dx < columns and 0 <= y + dy < rows and not seen[x + dx, y + dy]
        ]
        if not choices:
            path.pop()
            continue
        nx, ny = choices[int(rng.integers(len(choices)))]
        if ny == y:
            upright[min(x, nx), y] = False
        else:
            level[x, min(y, ny)] = False
        seen[nx, ny] = True
        path.append((nx, ny))
    return upright, level


def runs(line: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return beginnings and ends (exclusive) of what is true in a row, shape (K,)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], line, [False]]).astype(np.int8)))
    return [(int(a), int(b)) for a, b in edges.reshape(-1, 2)]
