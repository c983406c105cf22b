"""Which obstacles of a scenario move, and which stand."""

from __future__ import annotations

from collections.abc import Sequence

from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.scenario.places import Arena
from fuzzyq_bullet.shapes import Shape, Still


def moves(obstacle: Shape) -> bool:
    """Return whether an obstacle has a motion."""
    return not isinstance(obstacle.motion, Still)


def standing(obstacles: Sequence[Shape]) -> tuple[Shape, ...]:
    """Return the obstacles that stand still, in their order."""
    return tuple(one for one in obstacles if not moves(one))


def movers(obstacles: Sequence[Shape]) -> tuple[int, ...]:
    """Return the indices of those that move."""
    return tuple(i for i, one in enumerate(obstacles) if moves(one))


def standing_field(obstacles: Sequence[Shape], arena: Arena) -> Field:
    """Return the geometry of what stands still; edges of the arena without walls count as walls."""
    return Field.of(standing(obstacles), arena.model_copy(update={"walls": True}))
