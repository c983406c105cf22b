"""Poses of SDF: where links, models and frames are, one relative to another."""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.reading.xml_tree import Element
from fuzzyq_bullet.wording import shorten

Matrix: TypeAlias = NDArray[np.float64]
"""Shape (4, 4): from a frame's own coordinates to those of the frame around it."""

HERE: Matrix = np.eye(4)
_LONGEST = 100
"""Most frames one behind the other, each relative to the next."""
_PLACED = ("link", "model", "include", "frame", "joint")


def pose_matrix(element: Element | None) -> Matrix:
    """Return the matrix of a ``<pose>``: x y z, then roll pitch yaw, or a quaternion.

    Raises:
        UserError: If it is none.
    """
    if element is None or not element.text.split():
        return HERE
    form = element.attributes.get("rotation_format", "euler_rpy")
    if form == "quat_xyzw":
        *place, qx, qy, qz, qw = element.numbers(7)
        size = math.sqrt(qx * qx + qy * qy + qz * qz + qw * qw)
        if size < 1e-9:
            raise UserError(f"{element.where}: a quaternion of length 0 turns nothing")
        x, y, z, w = (part / size for part in (qx, qy, qz, qw))
        turn = np.array(
            [
                (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
                (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
                (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
            ]
        )
    elif form == "euler_rpy":
        *place, roll, pitch, yaw = element.numbers(6)
        if element.attributes.get("degrees") in ("true", "1"):
            roll, pitch, yaw = map(math.radians, (roll, pitch, yaw))
        turn = _about(2, yaw) @ _about(1, pitch) @ _about(0, roll)
    else:
        raise UserError(
            f"{element.where}: rotation_format {shorten(form)}; allowed: euler_rpy, quat_xyzw"
        )
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn, place
    return matrix


def _about(axis: int, angle: float) -> Matrix:
    cos, sin = math.cos(angle), math.sin(angle)
    one, other = (axis + 1) % 3, (axis + 2) % 3
    turn = np.eye(3)
    turn[one, one] = turn[other, other] = cos
    turn[other, one], turn[one, other] = sin, -sin
    return turn


class Scope:
    """A world or a model: what is placed directly in it, by name.

    Args:
        element: Its element.
    """

    def __init__(self, element: Element) -> None:
        self._named = {
            one.attributes["name"]: one
            for one in element.every(*_PLACED)
            if "name" in one.attributes
        }

    def pose(self, element: Element, given: Element | None = None) -> Matrix:
        """Return the pose of what is placed in it, in its own coordinates.

        Args:
            element: The link, model, include, frame or joint.
            given: Its ``<pose>``, if that stands elsewhere.

        Raises:
            UserError: If it is relative to what is not there, or to itself.
        """
        return self._pose(element, given or element.first("pose"), ())

    def within(self, base: Matrix, element: Element) -> Matrix:
        """Return the pose of a part of a link, in the coordinates of the model.

        Args:
            base: The pose of the link.
            element: The collision.

        Raises:
            UserError: As ``pose``.
        """
        pose = element.first("pose")
        if pose is None or not _relative(pose):
            return base @ pose_matrix(pose)
        return self._pose(element, pose, ())

    def _pose(self, element: Element, pose: Element | None, seen: tuple[str, ...]) -> Matrix:
        name = "" if pose is None else _relative(pose)
        if not name and element.tag == "frame":
            name = element.attributes.get("attached_to", "")
        if not name and element.tag == "joint":
            child = element.first("child")
            name = "" if child is None else child.text.strip()
        if name in ("", "world", "__model__"):
            return pose_matrix(pose)
        where = element if pose is None else pose
        if name in seen or len(seen) > _LONGEST:
            raise UserError(f"{where.where}: {shorten(name)} is placed relative to itself")
        if name not in self._named:
            raise UserError(
                f"{where.where}: relative to {shorten(name)}, which is no link, model, frame or "
                "joint beside it"
            )
        other = self._named[name]
        return self._pose(other, other.first("pose"), (*seen, name)) @ pose_matrix(pose)


def _relative(pose: Element) -> str:
    return pose.attributes.get("relative_to", pose.attributes.get("frame", "")).strip()
