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
from fuzzyq_bullet.shapes import Motion, Pose, register_motion


@register_motion
class Swing(Motion):
    """It turns to and fro about its centre, like a door."""

    kind: Literal["swing"]
    angle: Angle = Field(description="How far it turns to either side (rad).")
    period: Length = Field(default=4.0, description="Time of one swing to and fro (s).")

    def pose(self, time: float) -> Pose:
        """Return the pose at a time (s)."""
        return Pose(0.0, 0.0, self.angle * math.sin(math.tau * time / self.period))
