"""Two ways for a decision to move the robot: by its wheels in physics, or as the paper's point."""

from fuzzyq_bullet.drives.base import Driver
from fuzzyq_bullet.drives.kinematic import KinematicDriver
from fuzzyq_bullet.drives.wheels import WheelsDriver

__all__ = ["Driver", "KinematicDriver", "WheelsDriver"]
