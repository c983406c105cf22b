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
from fuzzyq_bullet.robots.create3 import CREATE3
from fuzzyq_bullet.robots.fuzzyq import FUZZYQ  # the first: it is the default
from fuzzyq_bullet.robots.husky import HUSKY
from fuzzyq_bullet.robots.jackal import JACKAL
from fuzzyq_bullet.robots.turtlebot3_burger import TURTLEBOT3_BURGER
from fuzzyq_bullet.robots.turtlebot3_waffle import TURTLEBOT3_WAFFLE

__all__ = [
    "CREATE3",
    "FUZZYQ",
    "HUSKY",
    "JACKAL",
    "TURTLEBOT3_BURGER",
    "TURTLEBOT3_WAFFLE",
    "RobotModel",
    "no_robot",
    "register_robot",
    "robot_model",
    "robot_names",
]
