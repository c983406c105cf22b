"""A fixed camera: where it sees what, and what it sees of the moving robot.

The still world is drawn once, with its depth (``video/scene/still.py``), and the robot alone in
every frame, in the small rectangle of the picture that it covers; the two depths tell which of
them is in front. The cost of a frame does not depend on the world.
"""

from __future__ import annotations

import math
from array import array
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzyq_bullet.physics.engine import Engine
from fuzzyq_bullet.physics.robot import VisibleRobot
from fuzzyq_bullet.robots import FUZZYQ, RobotModel

Floats: TypeAlias = NDArray[np.float64]
Window: TypeAlias = tuple[int, int, int, int]
"""Left, top, right and bottom of a part of the picture in pixels; right and bottom lie outside."""

NOTHING = -1
"""What a picture's mask holds where nothing is seen."""
MAX_SIZE = 8192
"""Most pixels along a side of a picture; absurd sizes would kill the process."""

_AROUND = np.arange(16) * (math.tau / 16)
_RIM, _LID = 0.004, 0.007
"""How far a robot may reach beyond its footprint, and above its lid (m)."""
_NOSE = np.array([(0.62, 0.0), (-0.48, 0.5), (-0.24, 0.0), (-0.48, -0.5)])
"""Outline of an arrow along x that fits into a circle of radius 1."""
_LIGHT: dict[str, Any] = {
    "lightDirection": (-4.0, -6.0, 11.0),
    "lightColor": (1.0, 1.0, 1.0),
    "lightAmbientCoeff": 0.58,
    "lightDiffuseCoeff": 0.5,
    "lightSpecularCoeff": 0.0,
    "shadow": 0,
}


@dataclass(frozen=True, slots=True)
class Mesh:
    """A surface of triangles of one colour.

    Attributes:
        vertices: Corners (m), shape (V, 3).
        normals: Direction of the surface at each corner, unit vectors, shape (V, 3).
        triangles: Indices of corners, shape (T, 3), anticlockwise seen from outside.
        colour: Red, green and blue, 0 to 255.
    """

    vertices: Floats
    normals: Floats
    triangles: NDArray[np.int64]
    colour: tuple[int, int, int]


class Picture(NamedTuple):
    """What the camera saw.

    Attributes:
        colour: Shape (h, w, 3), uint8.
        depth: Shape (h, w), float32, from 0 at the near plane to 1 at the far one, not linear.
        mask: Shape (h, w), int32: index of the thing seen at each pixel, or ``NOTHING``.
    """

    colour: NDArray[np.uint8]
    depth: NDArray[np.float32]
    mask: NDArray[np.int32]


@dataclass(frozen=True)
class Lens:
    """A perspective camera that stands still, its picture measured in pixels from the top left.

    Attributes:
        eye: Where it stands (m).
        target: The point it looks at (m), not straight above or below the eye.
        field_of_view: Height of the picture as an angle (rad).
        size: Width and height of the picture (pixels).
        near: Distance of the nearest thing that is seen (m).
        far: Distance of the farthest (m).
    """

    eye: tuple[float, float, float]
    target: tuple[float, float, float]
    field_of_view: float
    size: tuple[int, int]
    near: float
    far: float

    def axes(self) -> Floats:
        """Return the directions right, up and backwards of the camera, shape (3, 3)."""
        return self._axes

    @cached_property
    def _axes(self) -> Floats:
        back = np.subtract(self.eye, self.target)
        back /= np.linalg.norm(back)
        right = np.cross((0.0, 0.0, 1.0), back)
        right /= np.linalg.norm(right)
        return np.array([right, np.cross(back, right), back])

    def view(self) -> Floats:
        """Return the matrix from the world to the camera, shape (4, 4)."""
        axes = self._axes
        matrix = np.eye(4)
        matrix[:3, :3] = axes
        matrix[:3, 3] = -axes @ np.asarray(self.eye)
        return matrix

    @cached_property
    def view_list(self) -> list[float]:
        """The view as PyBullet wants it: 16 numbers, column by column."""
        numbers: list[float] = self.view().T.ravel().tolist()
        return numbers

    def projection(self, window: Window | None = None) -> Floats:
        """Return the matrix from the camera to clip space, shape (4, 4), for all or a part."""
        width, height = self.size
        focal = 1.0 / math.tan(self.field_of_view / 2)
        near, far = self.near, self.far
        matrix = np.zeros((4, 4))
        matrix[0, 0] = focal * height / width
        matrix[1, 1] = focal
        matrix[2, 2] = -(far + near) / (far - near)
        matrix[2, 3] = -2.0 * far * near / (far - near)
        matrix[3, 2] = -1.0
        if window is None:
            return matrix
        left, top, right, bottom = window
        low = (2.0 * left / width - 1.0, 1.0 - 2.0 * bottom / height)
        high = (2.0 * right / width - 1.0, 1.0 - 2.0 * top / height)
        crop = np.eye(4)
        for axis in (0, 1):
            span = high[axis] - low[axis]
            crop[axis, axis] = 2.0 / span
            crop[axis, 3] = -(high[axis] + low[axis]) / span
        return np.asarray(crop @ matrix)

    def project(self, points: ArrayLike) -> Floats:
        """Return where points (m), shape (N, 3), are seen (pixels), shape (N, 2).

        Points behind the camera come out as NaN.
        """
        p = np.asarray(points, dtype=np.float64).reshape(-1, 3)
        seen = (p - self.eye) @ self._axes.T
        ahead = np.where(seen[:, 2] < -1e-9, -seen[:, 2], np.nan)
        scale = self.pixels_per_radian()
        x = self.size[0] / 2 + scale * seen[:, 0] / ahead
        y = self.size[1] / 2 - scale * seen[:, 1] / ahead
        return np.stack([x, y], axis=1)

    def ground(self, points: ArrayLike) -> Floats:
        """Return the points of the ground (m), shape (N, 2), seen at pixels of shape (N, 2).

        Pixels above the horizon come out as NaN.
        """
        pixel = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        scale = self.pixels_per_radian()
        ray = (
            np.column_stack(
                [
                    (pixel[:, 0] - self.size[0] / 2) / scale,
                    (self.size[1] / 2 - pixel[:, 1]) / scale,
                    np.full(len(pixel), -1.0),
                ]
            )
            @ self._axes
        )
        down = np.where(ray[:, 2] < -1e-9, -ray[:, 2], np.nan)
        return np.asarray(self.eye[:2] + ray[:, :2] * (self.eye[2] / down)[:, None])

    def pixels_per_radian(self) -> float:
        """Return the size (pixels) of one metre, seen across from one metre away."""
        return self.size[1] / 2 / math.tan(self.field_of_view / 2)


def lit(mesh: Mesh) -> NDArray[np.uint8]:
    """Return the colour of a surface at each corner as the robot's light shows it, shape (V, 3)."""
    towards = np.asarray(_LIGHT["lightDirection"]) / np.linalg.norm(_LIGHT["lightDirection"])
    shine = np.maximum(mesh.normals @ towards, 0.0) * _LIGHT["lightDiffuseCoeff"]
    light = _LIGHT["lightAmbientCoeff"] + shine
    return np.minimum(np.outer(light, mesh.colour), 255.0).astype(np.uint8)


class RobotCamera:
    """Sees the robot alone, and of the picture only the rectangle that it covers."""

    def __init__(self, lens: Lens, model: RobotModel = FUZZYQ, oversampling: int = 1) -> None:
        self._lens = lens
        self._oversampling = oversampling
        self._engine = Engine()
        self._robot = VisibleRobot(self._engine, model)
        self._nose = [add_mesh(self._engine, mesh) for mesh in _nose(model)]
        wide, tall = model.radius + _RIM, model.height + _LID
        # Points about the robot (m), base frame: a little wider than its disc, from wheels to lid.
        self._hull = np.array(
            [(wide * math.cos(a), wide * math.sin(a), z) for a in _AROUND for z in (0.0, tall)]
        )

    def window(self, position: tuple[float, float]) -> Window | None:
        """Return the part of the picture that the robot covers, or None when it is out of sight."""
        corners = self._lens.project(np.add(self._hull, (*position, 0.0)))
        if not np.isfinite(corners).all():
            return None
        width, height = self._lens.size
        low, high = np.floor(corners.min(axis=0)), np.ceil(corners.max(axis=0))
        left, top = (int(max(edge, 0.0)) for edge in low)
        right, bottom = int(min(high[0], width)), int(min(high[1], height))
        return (left, top, right, bottom) if right > left and bottom > top else None

    def shoot(self, window: Window, position: tuple[float, float], heading: float) -> Picture:
        """Return what ``window`` shows of the robot; the mask is not negative where it is."""
        self._robot.place(position, heading)
        for body in self._nose:
            self._engine.api.resetBasePositionAndOrientation(
                body,
                (*position, 0.0),
                (0.0, 0.0, math.sin(heading / 2), math.cos(heading / 2)),
                physicsClientId=self._engine.client,
            )
        return shoot(self._engine, self._lens, window, self._oversampling)

    def close(self) -> None:
        """Free the engine."""
        self._engine.close()

    def __enter__(self) -> RobotCamera:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _nose(model: RobotModel) -> list[Mesh]:
    """Return an arrow on top of a user's robot; those of the package have a mark of their own.

    It is dark on a light rim, to be seen on a body of any colour.
    """
    if model.urdf_file in (None, FUZZYQ.urdf_file):
        return []
    return [
        Mesh(
            vertices=np.column_stack([_NOSE * size * model.radius, np.full(4, model.height + z)]),
            normals=np.tile((0.0, 0.0, 1.0), (4, 1)),
            triangles=np.array([(0, 1, 2), (0, 2, 3)]),
            colour=colour,
        )
        for size, z, colour in ((0.85, _RIM / 2, (238, 238, 242)), (0.64, _RIM, (33, 36, 43)))
    ]


def add_mesh(engine: Engine, mesh: Mesh) -> int:
    """Put a surface into an engine, to be seen and not to be touched, and return its body id."""
    api = engine.api
    shape = api.createVisualShape(
        api.GEOM_MESH,
        vertices=mesh.vertices.tolist(),
        indices=mesh.triangles.ravel().tolist(),
        normals=mesh.normals.tolist(),
        rgbaColor=(*(channel / 255 for channel in mesh.colour), 1.0),
        specularColor=(0.0, 0.0, 0.0),
        physicsClientId=engine.client,
    )
    body: int = api.createMultiBody(0.0, -1, shape, physicsClientId=engine.client)
    return body


def shoot(engine: Engine, lens: Lens, window: Window, oversampling: int = 1) -> Picture:
    """Return what a lens sees of all that is in an engine, within a window of its picture.

    Its mask holds body ids.

    Raises:
        ValueError: If the picture would be empty or absurdly large.
    """
    left, top, right, bottom = window
    width, height = (right - left) * oversampling, (bottom - top) * oversampling
    if not (0 < width <= MAX_SIZE and 0 < height <= MAX_SIZE):
        raise ValueError(f"a picture of {width} x {height} pixels cannot be taken")
    api = engine.api
    _, _, colour, depth, mask = api.getCameraImage(
        width,
        height,
        lens.view_list,
        lens.projection(window).T.ravel().tolist(),
        renderer=api.ER_TINY_RENDERER,
        physicsClientId=engine.client,
        **_LIGHT,
    )
    if isinstance(colour, tuple):
        # PyBullet without numpy support. By way of buffers, long tuples become arrays in half the
        # time: that saves a quarter of a second before the first frame.
        colour = np.frombuffer(bytes(colour), dtype=np.uint8)
        depth, mask = array("f", depth), array("i", mask)
    return Picture(
        np.asarray(colour, dtype=np.uint8).reshape(height, width, 4)[..., :3],
        np.asarray(depth, dtype=np.float32).reshape(height, width),
        np.asarray(mask, dtype=np.int32).reshape(height, width),
    )
