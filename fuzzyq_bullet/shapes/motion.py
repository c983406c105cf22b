"""How an obstacle moves: its pose as a function of time."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Annotated, Literal, NamedTuple, TypeAlias, TypeVar

from fuzzyq_bullet.quantities import Model, ModelRegistry


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


class Motion(Model, ABC):
    """The motion of one obstacle. Members narrow ``kind`` to their own name."""

    kind: str

    @abstractmethod
    def pose(self, time: float) -> Pose:
        """Return the pose at a time (s) after the start of the run."""


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

    An obstacle then has ``motion: {kind: slide, speed: 0.1}``.

    The physics cannot move obstacles yet: ``scenario.checks`` accepts only motions whose pose is
    the same at all times.

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
