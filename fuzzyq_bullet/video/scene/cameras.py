"""Who films the scene: a camera that stands still, shot by shot, or one that follows the robot."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Protocol

import numpy as np

from fuzzyq_bullet.physics.camera import Lens
from fuzzyq_bullet.physics.obstacle_urdf import OBSTACLE_HEIGHT
from fuzzyq_bullet.video import paint
from fuzzyq_bullet.video.scene.shots import Shots
from fuzzyq_bullet.video.scene.viewpoint import CROSSED, lens_for

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fuzzyq_bullet.recording.trajectory import Trajectory
    from fuzzyq_bullet.video.map.footprints import Floats
    from fuzzyq_bullet.video.timeline import Moment

_METRE = 180.0
"""Size of a metre for a camera that follows (points)."""
_PITCH = math.radians(50.0)
_FIELD_OF_VIEW = math.radians(0.5)
"""From so far away that a robot looks alike anywhere, and nothing jumps where shots meet."""
_SPAN = 5.0
"""What the robot drives in one picture of a camera that follows spans so much at most (m)."""
_CALM = np.linspace(-0.7, 0.7, 15)
"""The camera is where the robot is on average within these times of now (s)."""


class Camera(Protocol):
    """Films a run in shots; each has one still picture of the world, seen through one lens."""

    @property
    def shots(self) -> Shots:
        """The shots of the run."""

    def lens(self, number: int) -> Lens:
        """Return the lens of a shot."""

    def window(self, lens: Lens, moment: Moment) -> paint.Box:
        """Return the part of a lens's picture that fills the frame at a moment (pixels)."""


class FixedCamera:
    """Stands still for as long as robot and lines are legible from there.

    Args:
        trajectory: The run.
        size: Width and height of the picture (pixels).
        together: This and other runs of the same field, which are to be seen from the same place
            if all of each is filmed in one shot.
    """

    def __init__(
        self, trajectory: Trajectory, size: tuple[int, int], together: Sequence[Trajectory] = ()
    ) -> None:
        self._trajectory, self._size = trajectory, size
        self.shots = Shots(trajectory)
        shots = [Shots(run)[0] for run in together]
        self._small = len(shots) > 1
        alike = all(shot.whole for shot in shots)
        self._points = np.concatenate([shot.points for shot in shots]) if shots and alike else None

    def lens(self, number: int) -> Lens:
        """Return the lens that shows all of a shot."""
        points = self.shots[number].points if self._points is None else self._points
        # Several runs share a frame: their scenes are small, and the map beside them shows all.
        crossed = 0.0 if self._small else CROSSED
        return lens_for(self._trajectory, points, self._size, crossed=crossed)

    def window(self, lens: Lens, moment: Moment) -> paint.Box:
        """Return all of the picture."""
        return (0, 0, *lens.size)


class FollowCamera:
    """Moves with the robot: each frame is the part about it of one picture that is larger.

    Args:
        trajectory: The run.
        size: Width and height of the frame (pixels).
        unit: Pixels a point.
    """

    def __init__(self, trajectory: Trajectory, size: tuple[int, int], unit: float) -> None:
        self._trajectory, self._size = trajectory, size
        self._scale = _METRE * unit
        self.shots = Shots(trajectory, whole=_SPAN, span=_SPAN)

    def lens(self, number: int) -> Lens:
        """Return the lens that shows all that the camera passes in a shot."""
        ticks, last = self._trajectory.ticks, number + 1 == len(self.shots)
        end = len(ticks.time) if last else self.shots[number + 1].tick + 1
        times = ticks.time[self.shots[number].tick : end]
        passed = np.array([self._centre(time) for time in (*times[::5].tolist(), float(times[-1]))])
        low, high = passed.min(axis=0), passed.max(axis=0)
        wide, deep = high - low
        # The picture is as large as the frame and what the camera moves in it.
        width = math.ceil(wide * self._scale / 2) * 2 + self._size[0] + 4
        tall = math.ceil(deep * math.sin(_PITCH) * self._scale / 2) * 2 + self._size[1] + 4
        away = tall / 2 / math.tan(_FIELD_OF_VIEW / 2) / self._scale
        x, y = ((low + high) / 2).tolist()
        reach = tall / self._scale / math.tan(_PITCH) + 2 * OBSTACLE_HEIGHT + 1.0
        return Lens(
            eye=(x, y - away * math.cos(_PITCH), away * math.sin(_PITCH)),
            target=(x, y, 0.0),
            field_of_view=_FIELD_OF_VIEW,
            size=(width, tall),
            near=away - reach,
            far=away + reach,
        )

    def window(self, lens: Lens, moment: Moment) -> paint.Box:
        """Return the part of the picture about the robot."""
        ((x, y),) = lens.project([(*self._centre(moment.time), 0.0)])
        left, top = (
            min(max(round(middle - side / 2), 0), most - side)
            for middle, side, most in zip((x, y), self._size, lens.size, strict=True)
        )
        return left, top, left + self._size[0], top + self._size[1]

    def _centre(self, time: float) -> Floats:
        """Return where the robot is on average about a time (m)."""
        ticks = self._trajectory.ticks
        x, y = (np.interp(time + _CALM, ticks.time, ticks.position[:, axis]) for axis in (0, 1))
        return np.array((x.mean(), y.mean()))
