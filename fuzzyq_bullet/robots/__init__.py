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

# isort: off
from fuzzyq_bullet.robots import (  # noqa: F401 - in the order in which they are listed, the default first
    fuzzyq,
    turtlebot3_burger,
    turtlebot3_waffle,
    create3,
    jackal,
    husky,
)
# isort: on

FUZZYQ = fuzzyq.FUZZYQ

__all__ = ["FUZZYQ", "RobotModel", "no_robot", "register_robot", "robot_model", "robot_names"]
