"""PyBullet's own window: a robot among solid things, followed by a camera, with keys to press.

The window has an engine of its own, in which nothing is ever simulated: the world that is driven
knows nothing of it, and drives as it would without.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

import numpy as np

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.physics.camera import Mesh, add_mesh
from fuzzyq_bullet.physics.engine import Engine, silenced
from fuzzyq_bullet.physics.robot import VisibleRobot
from fuzzyq_bullet.platforms import no_screen
from fuzzyq_bullet.robots import RobotModel

Colour: TypeAlias = tuple[int, int, int]
"""Red, green and blue, 0 to 255."""

_SIZE = (1280, 800)
_DISTANCE, _YAW, _PITCH = 18.0, -20.0, -48.0
"""The camera at the start: how far away in radii of the robot, and its angles (degrees)."""
_TRAIL_STEP = 0.1
"""The path is drawn in pieces of this length (m); each costs time in every frame."""
_TEXT_SIZE = 1.3
_LINE_HEIGHT = 0.075
"""Height of a line of text, in half heights of the window."""


class Line(NamedTuple):
    """A straight line over the ground.

    Attributes:
        start: Where it begins (m).
        end: Where it ends (m).
        colour: Its colour.
    """

    start: tuple[float, float]
    end: tuple[float, float]
    colour: Colour


class WindowClosed(Exception):  # noqa: N818 (a person closes it; that is no error)
    """Somebody has closed the window."""


class Window:
    """A window on a robot. Close it, or use it as a context manager.

    The camera follows the robot; its angles and its distance are the mouse's to change.

    Args:
        still: All that never moves.
        model: The robot.
        moving: Solids that ``draw`` puts from pose to pose, each about the origin.
        background: Colour of the sky.
        paint: Colour of the robot, of its path and of all text.

    Raises:
        UserError: If there is no screen to open a window on.
    """

    def __init__(
        self,
        still: Sequence[Mesh],
        model: RobotModel,
        moving: Sequence[Mesh] = (),
        *,
        background: Colour,
        paint: Colour,
    ) -> None:
        if reason := no_screen():
            raise UserError(f"no window can be opened: {reason}; `fuzzyq run` needs no screen")
        sky = zip(("red", "green", "blue"), _part(background), strict=True)
        options = [f"--width={_SIZE[0]}", f"--height={_SIZE[1]}"]
        options += [f"--background_color_{name}={part:.3f}" for name, part in sky]
        self._paint = _part(paint)
        self._height = model.sensor_height
        self._view = (_YAW, _PITCH, _DISTANCE * model.radius)
        self._lines: tuple[Line, ...] = ()
        self._drawn: list[int] = []
        self._texts: dict[float, int] = {}
        self._trail: tuple[float, float] | None = None
        with silenced(1, 2):  # it says a lot as it opens
            self._engine = engine = Engine(window=" ".join(options))
            self._api, self._client = engine.api, engine.client
            self._set(self._api.COV_ENABLE_GUI, False)
            self._set(self._api.COV_ENABLE_SHADOWS, False)
            self._set(self._api.COV_ENABLE_MOUSE_PICKING, False)
            self._set(self._api.COV_ENABLE_KEYBOARD_SHORTCUTS, False)
            self._set(self._api.COV_ENABLE_RENDERING, False)
            for mesh in still:
                add_mesh(engine, mesh)
            self._moving = [add_mesh(engine, mesh) for mesh in moving]
            self._robot = VisibleRobot(engine, model)
            self._nose(model)

    def draw(
        self,
        position: tuple[float, float],
        heading: float,
        lines: Sequence[Line] = (),
        *,
        moved: Sequence[Sequence[float]] = (),
        passed: Sequence[tuple[float, float]] = (),
        above: Sequence[str] = (),
        below: Sequence[str] = (),
    ) -> str:
        """Show the robot at a pose, and what is to be seen with it.

        Args:
            position: Centre of the robot (m).
            heading: Direction it faces (rad).
            lines: What is drawn over the ground, instead of what was before.
            moved: Where the moving solids are: x, y (m) and how far each is turned (rad).
            passed: Where it has been since the last call (m).
            above: Lines of text for the upper left corner, in every call as many.
            below: Lines of text for the lower left corner, likewise.

        Returns:
            The keys that were pressed and let go since the last call.

        Raises:
            WindowClosed: If the window is not there any more.
        """
        try:
            with silenced(1):  # a window that was closed says so at length
                self._set(self._api.COV_ENABLE_RENDERING, False)  # until all of it is there
                self._robot.place(position, heading)
                for body, pose in zip(self._moving, moved, strict=True):
                    self._put(body, pose)
                self._follow(position)
                self._draw_lines(tuple(lines))
                for point in (*passed, position):
                    self._extend_trail(point)
                self._write(above, below)
                self._set(self._api.COV_ENABLE_RENDERING, True)
                return self._keys()
        except self._api.error as error:
            raise WindowClosed from error

    def close(self) -> None:
        """Close the window."""
        with silenced(1):
            self._engine.close()

    def __enter__(self) -> Window:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _set(self, part: int, on: bool) -> None:
        self._api.configureDebugVisualizer(part, int(on), physicsClientId=self._client)

    def _put(self, body: int, pose: Sequence[float]) -> None:
        x, y, turn = pose
        self._api.resetBasePositionAndOrientation(
            body,
            (x, y, 0.0),
            (0.0, 0.0, math.sin(turn / 2), math.cos(turn / 2)),
            physicsClientId=self._client,
        )

    def _nose(self, model: RobotModel) -> None:
        """Show which way the robot faces; the window gives all of a link one colour."""
        body = self._robot.body
        self._api.changeVisualShape(
            body, -1, rgbaColor=(*self._paint, 1.0), physicsClientId=self._client
        )
        top = model.height
        front = max(x for x, _ in model.footprint)
        self._line((0.0, 0.0, top), (front, 0.0, top), (0.1, 0.1, 0.1), width=7, parent=body)

    def _follow(self, position: tuple[float, float]) -> None:
        told = self._api.getDebugVisualizerCamera(self._client)
        if self._trail is not None:  # else the window does not know yet where it looks from
            self._view = told[8], told[9], told[10]
        yaw, pitch, distance = self._view
        target = (*position, self._height)
        self._api.resetDebugVisualizerCamera(
            distance, yaw, pitch, target, physicsClientId=self._client
        )
        turn, tilt = math.radians(yaw), math.radians(pitch)
        forward = np.array(
            (-math.sin(turn) * math.cos(tilt), math.cos(turn) * math.cos(tilt), math.sin(tilt))
        )
        right = np.array((math.cos(turn), math.sin(turn), 0.0))
        projection = told[3]
        self._eye = target - distance * forward
        # From the middle of the window to its right and to its upper edge, a metre away.
        self._axes = (
            forward,
            right / projection[0],
            np.cross(right, forward) / projection[5],
        )

    def _draw_lines(self, lines: tuple[Line, ...]) -> None:
        if lines == self._lines:
            return
        if len(lines) != len(self._drawn):
            for one in self._drawn:
                self._api.removeUserDebugItem(one, physicsClientId=self._client)
            self._drawn = [-1] * len(lines)
        z = self._height
        self._drawn = [
            self._line((*line.start, z), (*line.end, z), _part(line.colour), width=4, instead=one)
            for line, one in zip(lines, self._drawn, strict=True)
        ]
        self._lines = lines

    def _extend_trail(self, position: tuple[float, float]) -> None:
        if self._trail is None:
            self._trail = position
        elif math.dist(self._trail, position) >= _TRAIL_STEP:
            self._line((*self._trail, 0.01), (*position, 0.01), self._paint, width=2)
            self._trail = position

    def _write(self, above: Sequence[str], below: Sequence[str]) -> None:
        rows = [(0.92 - k * _LINE_HEIGHT, text) for k, text in enumerate(above)]
        rows += [(-0.95 + k * _LINE_HEIGHT, text) for k, text in enumerate(reversed(below))]
        forward, right, up = self._axes
        for y, text in rows:
            where = self._eye + forward - 0.97 * right + y * up
            self._texts[y] = self._api.addUserDebugText(
                text or " ",
                where.tolist(),
                textColorRGB=self._paint,
                textSize=_TEXT_SIZE,
                replaceItemUniqueId=self._texts.get(y, -1),
                physicsClientId=self._client,
            )

    def _line(
        self,
        start: tuple[float, ...],
        end: tuple[float, ...],
        colour: tuple[float, ...],
        *,
        width: float,
        parent: int = -1,
        instead: int = -1,
    ) -> int:
        number: int = self._api.addUserDebugLine(
            start,
            end,
            colour,
            lineWidth=width,
            parentObjectUniqueId=parent,
            replaceItemUniqueId=instead,
            physicsClientId=self._client,
        )
        return number

    def _keys(self) -> str:
        events = self._api.getKeyboardEvents(self._client)
        # A key that goes down and up between two calls is told of as let go only.
        let_go = [key for key, state in events.items() if state & self._api.KEY_WAS_RELEASED]
        return "".join(chr(key) for key in let_go if 0 < key < 128)


def _part(colour: Colour) -> tuple[float, float, float]:
    red, green, blue = colour
    return red / 255, green / 255, blue / 255
