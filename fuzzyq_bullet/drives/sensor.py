"""The range sensor of one instant: no line is cast twice."""

from __future__ import annotations

from collections.abc import Sequence

from fuzzyq_bullet.physics.sight import Sight


class CastOnce:
    """A range sensor at one place: the parts of a planner ask it in turn, often for the same.

    Args:
        world: What there is to be seen.
        origin: Centre of the robot (m).
        apart: By how much the robot is surely apart from everything (m).
    """

    def __init__(self, world: Sight, origin: tuple[float, float], apart: float = 0.0) -> None:
        self._world = world
        self._origin = origin
        self._apart = apart
        self._known: dict[float, float] = {}

    def __call__(self, headings: Sequence[float]) -> list[float]:
        """Return the free distance (m) along each of the world headings (rad)."""
        known = self._known
        missing = [heading for heading in dict.fromkeys(headings) if heading not in known]
        if missing:
            told = self._world.sense(self._origin, missing, apart=self._apart)
            known.update(zip(missing, told, strict=True))
        return [known[heading] for heading in headings]
