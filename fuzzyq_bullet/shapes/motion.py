"""How an obstacle moves: its pose as a function of time."""

from __future__ import annotations

import math
from abc import ABC
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple, Protocol, TypeAlias, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Field

from fuzzyq_bullet.quantities import Flag, Model, ModelRegistry

if TYPE_CHECKING:
    from typing_extensions import Self

    from fuzzyq_bullet.quantities import Point

Floats: TypeAlias = NDArray[np.float64]

MAX_MOTION_SPEED = 3.0
"""Greatest speed of an obstacle (m/s): the least that is drawn of what is faster is a jump."""


class Pose(NamedTuple):
    """Where something is, compared with where its scenario file puts it.

    Attributes:
        x: How far it has moved along x (m).
        y: How far it has moved along y (m).
        yaw: How far it has turned about its centre (rad).
    """

    x: float
    y: float
    yaw: float


class Standing(Protocol):
    """What is asked of all that stands still; ``geometry.Field`` answers."""

    def clearance(self, points: ArrayLike) -> Floats:
        """Return the signed distance (m) from each point, shape (K, 2), to the nearest surface."""

    def free_distance(
        self, origin: ArrayLike, headings: ArrayLike, radius: float, limit: float
    ) -> Floats:
        """Return how far a disc can move straight on, for each heading (m)."""


class Surroundings(NamedTuple):
    """What a motion may know of the world it happens in.

    Attributes:
        standing: All obstacles that stand still, and the edges of the arena.
        rng: Random numbers of this obstacle's own.
    """

    standing: Standing
    rng: np.random.Generator


class Course(Protocol):
    """The way of one obstacle through one run."""

    def pose(self, time: float, /) -> Pose:
        """Return the pose at a time (s) of the obstacle's own clock."""


class Moving(Protocol):
    """What is asked of the obstacle that moves."""

    position: Point

    def extent(self) -> float:
        """Return the radius (m) of a circle about the centre that holds all of it."""


class Motion(Model, ABC):
    """The motion of one obstacle. Members narrow ``kind`` to their own name.

    A member has ``pose``, or else ``course`` if its way depends on the world or on chance.
    """

    kind: str
    stops_for_robot: Flag = Field(
        default=False, description="Whether it stands while the robot is close ahead of it."
    )

    def pose(self, time: float) -> Pose:
        """Return the pose at a time (s) after the start of the run."""
        raise NotImplementedError(f"the motion {self.kind} has neither pose nor course")

    def course(self, obstacle: Moving, surroundings: Surroundings) -> Course:
        """Return the way of an obstacle through one run.

        Args:
            obstacle: The obstacle that has this motion.
            surroundings: The world it moves in.
        """
        return self

    def top_speed(self, obstacle: Moving) -> float | None:
        """Return the greatest speed (m/s) of any part of the obstacle; None if it has to be seen.

        The robot is told how fast what moves may come. Where a motion does not tell, the first
        minute of its course is looked at before each run.
        """
        return None

    def moved(self, x: float, y: float, turn: float) -> Self:
        """Return the motion of the obstacle turned about the origin (rad) and then moved (m).

        It differs only for a motion that speaks of places in the world.
        """
        return self

    def conflicts(self, obstacle: Moving, standing: Standing) -> list[tuple[str, str]]:
        """Return what is wrong with it in its world: keys within ``motion``, and messages."""
        return []


MOTIONS: ModelRegistry[Motion] = ModelRegistry("kind")
"""All motions, by the name that an obstacle gives in ``motion.kind``."""
AnyMotion: TypeAlias = Annotated[Motion, MOTIONS]
_M = TypeVar("_M", bound=type[Motion])


def register_motion(motion: _M) -> _M:
    """Make a motion known to scenario files: a decorator for subclasses of ``Motion``.

    In a file that ``--plugin`` names::

        from typing import Literal

        from fuzzyq_bullet.quantities import Length
        from fuzzyq_bullet.shapes import Motion, Pose, register_motion

        @register_motion
        class Slide(Motion):
            kind: Literal["slide"]
            speed: Length  # m/s

            def pose(self, time):
                return Pose(self.speed * time, 0.0, 0.0)

    An obstacle then has ``motion: {kind: slide, speed: 0.1}``. A motion that depends on what stands
    there, or on chance, has ``course`` instead of ``pose``. One that knows how fast it is at most
    also has ``top_speed``.

    Raises:
        ValueError: If the name is taken.
    """
    MOTIONS.add(motion)
    return motion


@register_motion
class Still(Motion):
    """It stands still."""

    kind: Literal["still"] = "still"

    def pose(self, time: float) -> Pose:
        """Return the pose that the scenario gives, at any time."""
        return Pose(0.0, 0.0, 0.0)


STILL = Still()


def placed(points: ArrayLike, centre: Sequence[float], pose: Sequence[float]) -> Floats:
    """Return where points of an obstacle (m), shape (K, 2), are when it is at a pose.

    Args:
        points: Where they are in the scenario file.
        centre: The centre there (m).
        pose: Its centre at the time, x and y (m), and how far it has turned (rad).
    """
    x, y, yaw = pose
    cos, sin = math.cos(yaw), math.sin(yaw)
    local = np.asarray(points, dtype=np.float64).reshape(-1, 2) - np.asarray(centre)
    return np.asarray(local @ np.array([[cos, sin], [-sin, cos]]) + (x, y))


def seen_from(points: ArrayLike, centre: Sequence[float], poses: ArrayLike) -> Floats:
    """Return points of the world, shape (K, 2), as if the obstacle were where its file puts it.

    So a distance to the obstacle of the file is the distance to the one that has moved.

    Args:
        points: Points (m).
        centre: Centre of the obstacle in the scenario file (m).
        poses: Its pose for each point, shape (K, 3) or (3,); see ``placed``.
    """
    p = np.asarray(points, dtype=np.float64).reshape(-1, 2)
    at = np.broadcast_to(np.asarray(poses, dtype=np.float64), (len(p), 3))
    dx, dy = (p - at[:, :2]).T
    cos, sin = np.cos(at[:, 2]), np.sin(at[:, 2])
    local = np.column_stack([dx * cos + dy * sin, dy * cos - dx * sin])
    return np.asarray(local + np.asarray(centre))


def turned_about_origin(point: Point, x: float, y: float, turn: float, digits: int) -> Any:
    """Return a point turned about the origin (rad), then moved (m), rounded."""
    cos, sin = math.cos(turn), math.sin(turn)
    px, py = point
    return round(x + cos * px - sin * py, digits), round(y + sin * px + cos * py, digits)
