"""Rays, bodies and contacts: the only place that imports pybullet."""
