"""For how long the robot surely touches nothing: so long there is no contact to look for."""

from __future__ import annotations

import math

from fuzzyq_bullet.drives.apart import Apart
from fuzzyq_bullet.drives.base import Tick
from fuzzyq_bullet.drives.nearby import Nearby
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.physics.engine import TIME_STEP
from fuzzyq_bullet.scenario.models import Robot

SLACK = 0.002
"""By how much bodies may be nearer to each other in the physics than they are drawn (m): they have
a margin, and the robot may lean."""
SPANS = 4
"""Into how many parts the time is divided that the robot is followed through."""


class Foresight:
    """Where the robot may be within the next steps, and whether anything is there.

    Twice the accelerations that the wheels are ever asked for are reckoned with.

    Args:
        field: All obstacles and walls.
        limits: The robot's limits.
    """

    def __init__(self, field: Field, limits: Robot) -> None:
        self._near = Nearby(field)
        self._apart = Apart(self._clearance)
        self._limits = limits

    def apart(self, tick: Tick, steps: int) -> float:
        """Return by how much the robot is surely apart from everything (m).

        It is the very clearance where that may be used up within as many physics steps.
        """
        return self._apart.by(tick.x, tick.y, self._way(tick, steps * TIME_STEP))

    def free_steps(self, tick: Tick, steps: int) -> int:
        """Return how many of the next physics steps surely bring no contact."""
        if self.apart(tick, steps) >= self._way(tick, steps * TIME_STEP):
            return steps
        span = steps * TIME_STEP / SPANS
        for k in range(SPANS):
            if not self._passes(tick, k * span, span):
                return k * steps // SPANS
        return steps

    def _way(self, tick: Tick, time: float) -> float:
        """Return more than the robot could drive within a time (m): v·t + (2a)·t²/2."""
        return abs(tick.speed) * time + self._limits.acceleration * time * time

    def _passes(self, tick: Tick, start: float, span: float) -> bool:
        """Return whether nothing is where the robot may be for a span of time (s) from a start (s).

        If nothing changed it would go on along its heading; half the way of the span before and
        half behind the middle of that way, and off it no farther than it may stray by the end.
        """
        middle, end = start + span / 2.0, start + span
        way, speed = tick.speed * middle, abs(tick.speed)
        x = tick.x + way * math.cos(tick.heading)
        y = tick.y + way * math.sin(tick.heading)
        # Off along its way by (2a)·t²/2; off aside by no more than ∫ v·δ, with a speed of at most
        # v + 2a·t and a turn δ of at most ω·t + (2α)·t²/2.
        faster = speed + 2.0 * self._limits.acceleration * end
        turned = abs(tick.turn_rate) / 2.0 + self._limits.turn_acceleration * end / 3.0
        strays = (self._limits.acceleration + faster * turned) * end * end
        return self._clearance(x, y) >= speed * span / 2.0 + strays

    def _clearance(self, x: float, y: float) -> float:
        return self._near.clearance(x, y) - self._limits.radius - SLACK
