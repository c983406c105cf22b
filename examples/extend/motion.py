"""A new motion of an obstacle: its pose as a function of time.

    fuzzyq validate gate.yaml --plugin examples/extend/motion.py

In the scenario file, on an obstacle: ``motion: {kind: swing, angle: 0.5}``. Faster than 3 m/s no
obstacle may be.
"""

from __future__ import annotations

import math
from typing import Literal

from pydantic import Field

from fuzzyq_bullet.quantities import Angle, Length
from fuzzyq_bullet.shapes import Motion, Moving, Pose, register_motion


@register_motion
class Swing(Motion):
    """It turns to and fro about its centre, like a door."""

    kind: Literal["swing"]
    angle: Angle = Field(description="How far it turns to either side (rad).")
    period: Length = Field(default=4.0, description="Time of one swing to and fro (s).")

    def pose(self, time: float) -> Pose:
        """Return the pose at a time (s)."""
        return Pose(0.0, 0.0, self.angle * math.sin(math.tau * time / self.period))

    def top_speed(self, obstacle: Moving) -> float:
        """Return the speed (m/s) of its corners as it swings through the middle.

        It may be left out: then the motion is looked at for a minute, 20 times a second.
        """
        return obstacle.extent() * abs(self.angle) * math.tau / self.period
