"""The default robot, with the paper's own unit S_p = 0.2 m."""

from __future__ import annotations

from fuzzyq_bullet.platforms import asset
from fuzzyq_bullet.robots.base import RobotModel, register_robot

FUZZYQ = register_robot(RobotModel(name="fuzzyq", urdf_file=asset("robot.urdf")))
"""Its numbers are the defaults of ``RobotModel``."""
