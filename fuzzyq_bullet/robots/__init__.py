"""Robots by name: footprint, wheels, masses, limits and URDF, each in one place.

A robot of your own is one call of ``register_robot`` in a file that ``--plugin`` names;
``examples/extend/robot.py`` is one.
"""

from fuzzyq_bullet.robots.base import (
    RobotModel,
    no_robot,
    register_robot,
    robot_model,
    robot_names,
)
from fuzzyq_bullet.robots.fuzzyq import FUZZYQ

__all__ = ["FUZZYQ", "RobotModel", "no_robot", "register_robot", "robot_model", "robot_names"]
