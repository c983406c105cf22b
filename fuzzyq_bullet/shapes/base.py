"""What an obstacle's shape knows of itself, and what all obstacles of one shape know together."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, NamedTuple, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from fuzzyq_bullet.blame import blamed
from fuzzyq_bullet.errors import MotionError, UserError
from fuzzyq_bullet.quantities import DECIMALS, Model, ModelRegistry, Point
from fuzzyq_bullet.shapes.answers import check_answers
from fuzzyq_bullet.shapes.motion import STILL, AnyMotion, Motion

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from typing_extensions import Self

Floats: TypeAlias = NDArray[np.float64]
Mask: TypeAlias = NDArray[np.bool_]

GRAZE = 1e-9
"""A path that would cut less deep than this (m) into something round only grazes it."""
_TOGETHER = 48
"""Points whose clearance is told at once; beside each other they share what is near them."""
_CHUNK = 1_000_000
"""Most distances held in memory at once by ``ShapeGroup.clearance``."""
PARALLEL = 1e-12
"""A direction closing in on a flat face slower than this (m per m) runs along it: cos(π/2) ≠ 0."""


class Collision(NamedTuple):
    """A solid for the physics.

    Attributes:
        geometry: What a URDF has within ``<geometry>``.
        yaw: Turn about its upright axis (rad).
        prism: Vertices about the shape's centre (m), shape (2·K, 3), of a convex prism: first those
            below, then those above them; ``geometry`` is empty then.
    """

    geometry: str
    yaw: float = 0.0
    prism: Floats | None = None


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

    @model_validator(mode="after")
    def _answers(self) -> Self:
        """Refuse a shape of the user's own that raises or answers nonsense; ours do not."""
        if type(self).__module__.partition(".")[0] != __package__.partition(".")[0]:
            try:
                check_answers(self)
            except UserError as error:
                raise PydanticCustomError("shape", "{why}", {"why": str(error)}) from error
        return self

    @abstractmethod
    def corners(self) -> tuple[Floats, float]:
        """Return points, shape (K, 2), anticlockwise, and a radius (m).

        The shape is the polygon of the points, grown by the radius. A circle is one point.
        """

    @abstractmethod
    def outline(self, corners: int = 24) -> Floats:
        """Return what it looks like from above, a simple polygon, shape (K, 2), anticlockwise.

        Args:
            corners: How many corners something round gets.
        """

    def pieces(self, corners: int = 24) -> list[Floats]:
        """Return convex polygons, each anticlockwise, that together are the outline.

        One, unless the outline is concave. Neighbours share whole sides.

        Args:
            corners: How many corners something round gets.
        """
        return [self.outline(corners)]

    def thickness(self) -> float:
        """Return the width (m) of its thinnest part, which rays nearer to each other surely see.

        Of what points outwards, a right angle is not thin; a sharper angle is.
        """
        return least_width(self.outline())

    @abstractmethod
    def faces(self) -> Floats:
        """Return the polygon, shape (K, 2), anticlockwise, whose sides the sensor's rays meet.

        It lies nowhere inside the shape, and at most 1 mm outside (``ROUNDNESS``).
        """

    @abstractmethod
    def collisions(self, height: float) -> list[Collision]:
        """Return the convex solids of that height (m) that the robot's body meets."""

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
        return self.model_copy(update={"position": at, "motion": self.moved_motion(x, y, turn)})

    def moved_motion(self, x: float, y: float, turn: float) -> Motion:
        """Return its motion turned about the origin (rad) and then moved (m).

        Raises:
            MotionError: If that raises, or is no motion.
        """
        who = f"motion {self.motion.kind}"
        with blamed(who, "in moved", MotionError):
            moved: Any = self.motion.moved(x, y, turn)
        if not isinstance(moved, Motion):
            raise MotionError(f"{who}: moved must return a motion, not a {type(moved).__name__}")
        return moved


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

    def clearance(self, points: Floats) -> Floats:
        """Return the signed distance (m) from each point to the nearest obstacle, shape (K,).

        Args:
            points: Shape (K, 2), in metres.
        """
        result = np.empty(len(points))
        rows = max(1, min(_TOGETHER, _CHUNK // len(self)))
        for k in range(0, len(points), rows):
            here = points[k : k + rows]
            told = self.distances(here[:, :1], here[:, 1:], self._near(here))
            result[k : k + rows] = told.min(axis=1)
        return result

    def _near(self, p: Floats) -> Mask | None:
        """Return which obstacles, shape (N,), may be nearest to any of the points p."""
        if len(p) == 1 or not np.isfinite(p).all():
            return None
        middle = (p.min(axis=0) + p.max(axis=0)) / 2.0
        around = float(np.abs(p - middle).sum(axis=1).max())
        # No point is farther from the middle than this, so no distance differs by more from there.
        to = self.distances(middle[None, :1], middle[None, 1:])[0]
        near: Mask = to <= to.min() + 2.0 * around + GRAZE
        return near

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


def thinnest(shapes: Iterable[Shape]) -> float:
    """Return the width (m) of the thinnest part of all shapes; infinite if there are none."""
    return min((shape.thickness() for shape in shapes), default=math.inf)


def least_width(polygon: Floats) -> float:
    """Return the least width (m) of a convex polygon, shape (K, 2), anticlockwise."""
    side = np.roll(polygon, -1, axis=0) - polygon
    normals = np.column_stack([-side[:, 1], side[:, 0]]) / np.hypot(*side.T)[:, None]
    depth = polygon @ normals.T
    return float((depth - np.diagonal(depth)).max(axis=0).min())


def part_within(normals: Floats, levels: Floats, radius: float) -> Floats:
    """Return the parts of a circle about the origin where n·p ≤ level for all lines.

    Args:
        normals: Shape (L, 2), unit vectors.
        levels: Shape (L,) (m).
        radius: Of the circle (m).

    Returns:
        Shape (C, 2): where each begins, in [0, 2π), and how far it goes (rad).
    """
    bearing = np.arctan2(normals[:, 1], normals[:, 0])
    half = np.arccos(np.clip(levels / radius, -1.0, 1.0))
    cuts = np.concatenate([[0.0], bearing - half, bearing + half])
    cuts = np.append(np.sort(np.remainder(cuts, math.tau)), math.tau)
    begin, extent = cuts[:-1], np.diff(cuts)
    middle = begin + extent / 2
    point = radius * np.column_stack([np.cos(middle), np.sin(middle)])
    inside = (extent > 0.0) & np.all(point @ normals.T < levels, axis=1)
    return np.column_stack([begin[inside], extent[inside]])


def reach_of_circles(mx: Floats, my: Floats, ux: Floats, uy: Floats, r: Floats) -> Floats:
    """Distance (m) along unit vectors u until within ``r`` of the points m; infinite if never."""
    along = ux * mx + uy * my
    aside = ux * my - uy * mx
    half_chord_squared = r * r - aside * aside
    hit = (along > PARALLEL) & (half_chord_squared > (2.0 * GRAZE) * r)
    half_chord = np.sqrt(np.maximum(half_chord_squared, 0.0))
    return np.where(hit, along - half_chord, np.inf)
