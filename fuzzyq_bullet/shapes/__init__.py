"""Shapes of obstacles: each is one file that knows outline, distance, solid, ray faces, drawing.

A shape of your own is a subclass of ``ConvexShape`` (or ``Shape``) with ``register_shape``, in a
file that ``--plugin`` names; ``examples/extend/shape.py`` is one.
"""

from fuzzyq_bullet.shapes.base import (
    GRAZE,
    SHAPES,
    Collision,
    Obstacle,
    Shape,
    ShapeGroup,
    register_shape,
    thinnest,
)

from fuzzyq_bullet.shapes.cylinder import ROUNDNESS, Cylinder, Cylinders  # isort: skip
from fuzzyq_bullet.shapes.box import Box, Boxes
from fuzzyq_bullet.shapes.convex import ConvexPolygons, ConvexShape
from fuzzyq_bullet.shapes.motion import (
    MOTIONS,
    Course,
    Motion,
    Moving,
    Pose,
    Standing,
    Still,
    Surroundings,
    register_motion,
)
from fuzzyq_bullet.shapes.motions import Circle, Patrol, Wander
from fuzzyq_bullet.shapes.polygon import Polygon
from fuzzyq_bullet.shapes.polygons import Polygons
from fuzzyq_bullet.shapes.trace import Trace

__all__ = [
    "GRAZE",
    "MOTIONS",
    "ROUNDNESS",
    "SHAPES",
    "Box",
    "Boxes",
    "Circle",
    "Collision",
    "ConvexPolygons",
    "ConvexShape",
    "Course",
    "Cylinder",
    "Cylinders",
    "Motion",
    "Moving",
    "Obstacle",
    "Patrol",
    "Polygon",
    "Polygons",
    "Pose",
    "Shape",
    "ShapeGroup",
    "Standing",
    "Still",
    "Surroundings",
    "Trace",
    "Wander",
    "register_motion",
    "register_shape",
    "thinnest",
]
