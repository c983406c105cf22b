"""Worlds of Gazebo: SDF files, read as what a robot on the ground could run into.

Positions are those of the world; z = 0 is the ground. What the scenario cannot hold is named.
"""

from fuzzyq_bullet.scenario.importers.gazebo.world import gazebo_world

__all__ = ["gazebo_world"]
