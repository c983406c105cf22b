"""What an obstacle's shape knows of itself, and what all obstacles of one shape know together."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, NamedTuple, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from fuzzyq_bullet.quantities import DECIMALS, Model, ModelRegistry, Point
from fuzzyq_bullet.shapes.motion import STILL, AnyMotion

if TYPE_CHECKING:
    from collections.abc import Sequence

    from typing_extensions import Self

Floats: TypeAlias = NDArray[np.float64]
Mask: TypeAlias = NDArray[np.bool_]

GRAZE = 1e-9
"""A path that would cut less deep than this (m) into something round only grazes it."""
PARALLEL = 1e-12
"""A direction closing in on a flat face slower than this (m per m) runs along it: cos(π/2) ≠ 0."""


class Collision(NamedTuple):
    """A solid for the physics.

    Attributes:
        geometry: What a URDF has within ``<geometry>``.
        yaw: Turn about its upright axis (rad).
        mesh: Text of an OBJ file about the shape's centre, convex; ``geometry`` is empty then.
    """

    geometry: str
    yaw: float = 0.0
    mesh: str = ""


class Shape(Model, ABC):
    """An upright obstacle of one shape: what a scenario gives, and all that follows from it.

    A new shape is one subclass with the decorator ``register_shape``. Flat faces alone are easiest:
    subclass ``ConvexShape`` and say where the corners are. Otherwise implement the methods below,
    all of them in metres and in the plane, and a ``ShapeGroup``. Nobody else asks which shape an
    obstacle has.

    Attributes:
        group: The class that answers for all obstacles of this shape at once.
    """

    group: ClassVar[type[ShapeGroup]]

    shape: str
    position: Point = Field(description="Centre (m).")
    motion: AnyMotion = Field(default=STILL, description="How it moves; it stands still.")

    @abstractmethod
    def corners(self) -> tuple[Floats, float]:
        """Return points, shape (K, 2), anticlockwise, and a radius (m).

        The shape is the convex hull of the points, grown by the radius. A circle is one point.
        """

    @abstractmethod
    def outline(self, corners: int = 24) -> Floats:
        """Return what it looks like from above, a convex polygon, shape (K, 2), anticlockwise.

        Args:
            corners: How many corners something round gets.
        """

    @abstractmethod
    def faces(self) -> Floats:
        """Return the polygon, shape (K, 2), anticlockwise, whose sides the sensor's rays meet.

        It lies nowhere inside the shape, and at most 1 mm outside (``ROUNDNESS``).
        """

    @abstractmethod
    def collision(self, height: float) -> Collision:
        """Return the solid of that height (m) that the robot's body meets."""

    def extent(self) -> float:
        """Return the radius (m) of a circle about the centre that holds all of it."""
        points, radius = self.corners()
        return float(np.hypot(*(points - self.position).T).max()) + radius

    def moved(self, x: float, y: float, turn: float) -> Self:
        """Return it turned about the origin (rad) and then moved (m), rounded to 0.1 mm.

        A shape that is not round turns its own axes as well.
        """
        cos, sin = math.cos(turn), math.sin(turn)
        px, py = self.position
        at = round(x + cos * px - sin * py, DECIMALS), round(y + sin * px + cos * py, DECIMALS)
        return self.model_copy(update={"position": at})


class ShapeGroup(ABC):
    """All N obstacles of one shape, answering in numpy at once."""

    discs: Floats
    """Shape (P, 3): x, y and radius (m) of what is round, corners included, with radius 0."""

    @classmethod
    @abstractmethod
    def of(cls, shapes: Sequence[Any]) -> Self:
        """Build it of obstacles of its shape."""

    @abstractmethod
    def __len__(self) -> int:
        """Return N."""

    @abstractmethod
    def distances(self, x: Floats, y: Floats, which: Mask | None = None) -> Floats:
        """Return signed distances (m), shape (K, N), negative inside an obstacle.

        Args:
            x: Of the points (m), shape (K, 1).
            y: Of the points (m), shape (K, 1).
            which: Shape (N,): answer for these only.
        """

    @abstractmethod
    def free_distances(self, x: float, y: float, ux: Floats, uy: Floats, radius: float) -> Floats:
        """Return how far a disc moves until it touches each obstacle (m), shape (H, N).

        Infinite where it passes. What it touches already stops it, at 0 or less, only if the motion
        would bring the two closer.

        Args:
            x: Centre of the disc (m).
            y: Centre of the disc (m).
            ux: Directions, shape (H, 1), unit vectors.
            uy: Directions, shape (H, 1), unit vectors.
            radius: Radius of the disc (m).
        """

    def are_crossed(self, begin: Floats, end: Floats) -> Mask:
        """Tell for each line, shape (S, 2) to (S, 2), whether it crosses the inside, shape (S,).

        What is round is left out (``discs`` tells of it).
        """
        return np.zeros(len(begin), dtype=bool)

    def covers(self, centre: Floats, radius: float, grown: float) -> Floats:
        """Return the parts of a circle within the obstacles grown by ``grown`` (m).

        Shape (C, 2): where each begins, in [0, 2π), and how far it goes (rad). What is within a
        grown disc of ``discs`` may be left out.
        """
        return np.zeros((0, 2))


SHAPES: ModelRegistry[Shape] = ModelRegistry("shape")
"""All shapes, by the name that a scenario gives in ``shape``."""
Obstacle: TypeAlias = Annotated[Shape, SHAPES]
_S = TypeVar("_S", bound=type[Shape])


def register_shape(shape: _S) -> _S:
    """Make a shape known to scenario files: a decorator for subclasses of ``Shape``.

    The subclass narrows ``shape`` to its own name. From then on obstacles of that shape are
    validated, simulated, sensed, drawn and measured like all others. In a file that ``--plugin``
    names::

        from typing import Literal

        from fuzzyq_bullet.quantities import Length
        from fuzzyq_bullet.shapes import ConvexShape, register_shape

        @register_shape
        class Prism(ConvexShape):
            shape: Literal["prism"]
            radius: Length

            def polygon(self):
                return [(self.position[0] + ..., ...), ...]  # corners, anticlockwise

    A shape of the package itself is a module here that ``shapes/__init__.py`` imports.

    Raises:
        ValueError: If the name is taken.
    """
    SHAPES.add(shape)
    return shape


def reach_of_circles(mx: Floats, my: Floats, ux: Floats, uy: Floats, r: Floats) -> Floats:
    """Distance (m) along unit vectors u until within ``r`` of the points m; infinite if never."""
    along = ux * mx + uy * my
    aside = ux * my - uy * mx
    half_chord_squared = r * r - aside * aside
    hit = (along > PARALLEL) & (half_chord_squared > (2.0 * GRAZE) * r)
    half_chord = np.sqrt(np.maximum(half_chord_squared, 0.0))
    return np.where(hit, along - half_chord, np.inf)
