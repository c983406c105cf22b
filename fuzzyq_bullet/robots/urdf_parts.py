"""What the links of a URDF are made of: masses, friction, and the points that bound its shapes."""

from __future__ import annotations

import math
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import read_bytes
from fuzzyq_bullet.reading.xml_tree import Element
from fuzzyq_bullet.robots.urdf_file import Reader

_MAX_MESH = 20_000_000
_SIDES = 32
_LIGHTEST = 1e-4
_LONGEST = 5.0
"""Longest side of any shape (m)."""


class Link(NamedTuple):
    """One link.

    Attributes:
        element: Its element.
        mass: Its mass (kg).
        points: Points that bound its collision shapes (m), shape (n, 3), in its own frame.
        has_friction: Whether the file says what its friction is.
    """

    element: Element
    mass: float
    points: NDArray[np.float64]
    has_friction: bool


def read_link(reader: Reader, element: Element) -> Link:
    """Read and check one link.

    Raises:
        UserError: If something is wrong with it; one line.
    """
    name = reader.text(element, "name")
    mass = _mass(reader, element, name)
    for visual in element.every("visual"):
        _shape(reader, visual, collides=False)
    shapes = [_shape(reader, one, collides=True) for one in element.every("collision")]
    points = np.vstack([np.zeros((0, 3)), *shapes])
    return Link(element, mass, points, _friction(reader, element))


def transform(reader: Reader, owner: Element) -> NDArray[np.float64]:
    """Return the pose of an element's ``<origin>``, shape (4, 4); without one it is the identity.

    Raises:
        UserError: If it is no pose.
    """
    pose = np.eye(4)
    origin = owner.first("origin")
    if origin is None:
        return pose
    roll, pitch, yaw = reader.numbers(origin, "rpy", 3, "0 0 0")
    pose[:3, 3] = reader.numbers(origin, "xyz", 3, "0 0 0")
    (cr, sr), (cp, sp), (cy, sy) = ((math.cos(a), math.sin(a)) for a in (roll, pitch, yaw))
    about_x = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    about_y = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    about_z = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    pose[:3, :3] = about_z @ about_y @ about_x
    return pose


def moved(pose: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points (m), shape (n, 3), moved by a pose, shape (4, 4)."""
    found: NDArray[np.float64] = points @ pose[:3, :3].T + pose[:3, 3]
    return found


def _mass(reader: Reader, link: Element, name: str) -> float:
    inertial = link.first("inertial")
    if inertial is None:
        raise reader.error(link, f"link {name!r} has no <inertial>; it needs a mass and an inertia")
    transform(reader, inertial)
    mass, inertia = inertial.first("mass"), inertial.first("inertia")
    if mass is None or inertia is None:
        raise reader.error(inertial, f"link {name!r} needs both a <mass> and an <inertia>")
    [kilograms] = reader.positive(mass, "value")
    if kilograms < _LIGHTEST:
        raise reader.error(mass, f"link {name!r} weighs less than {_LIGHTEST:g} kg")
    moments = [reader.positive(inertia, key)[0] for key in ("ixx", "iyy", "izz")]
    mixed = [reader.numbers(inertia, key, 1, "0")[0] for key in ("ixy", "ixz", "iyz")]
    (a, b, c), (ab, ac, bc) = moments, mixed
    principal = np.linalg.eigvalsh([[a, ab, ac], [ab, b, bc], [ac, bc, c]])
    if principal[0] <= 0.0 or principal[2] > 1.01 * (principal[0] + principal[1]):
        why = "no body has this inertia: each principal moment is at most the sum of the others"
        raise reader.error(inertia, why)
    if principal[2] > kilograms * _LONGEST**2:
        why = f"too large for {kilograms:g} kg within {_LONGEST:g} m; are the units kg m²?"
        raise reader.error(inertia, why)
    return kilograms


def _friction(reader: Reader, link: Element) -> bool:
    contact = link.first("contact")
    if contact is None:
        return False
    for one in contact.children:
        if one.tag.endswith("friction"):
            [value] = reader.numbers(one, "value", 1)
            if not 0.0 <= value <= 10.0:
                raise reader.error(one, f"{one.tag} must be between 0 and 10, got {value:g}")
    return contact.first("lateral_friction") is not None


def _shape(reader: Reader, owner: Element, *, collides: bool) -> NDArray[np.float64]:
    """Return points that bound one shape (m), shape (n, 3), in the frame of its link."""
    geometry = owner.first("geometry")
    shape = geometry.children[0] if geometry is not None and geometry.children else None
    if shape is None:
        raise reader.error(owner, f"<{owner.tag}> has no geometry")
    if shape.tag == "box":
        size = np.array(reader.positive(shape, "size", 3))
        signs = np.array([(i, j, k) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
        points = signs * size / 2
    elif shape.tag == "cylinder":
        [radius], [length] = reader.positive(shape, "radius"), reader.positive(shape, "length")
        angles = np.arange(_SIDES) * math.tau / _SIDES
        ring = radius * np.column_stack([np.cos(angles), np.sin(angles)])
        points = np.vstack([np.c_[ring, np.full(_SIDES, z)] for z in (-length / 2, length / 2)])
    elif shape.tag == "sphere":
        [radius] = reader.positive(shape, "radius")
        angles = np.arange(_SIDES) * math.tau / _SIDES
        tilts = np.linspace(-math.pi / 2, math.pi / 2, _SIDES // 2 + 1)
        points = radius * np.array(
            [
                (math.cos(t) * math.cos(a), math.cos(t) * math.sin(a), math.sin(t))
                for t in tilts
                for a in angles
            ]
        )
    elif shape.tag == "mesh":
        points = _mesh(reader, shape, collides)
    else:
        allowed = "box, cylinder, sphere and mesh"
        raise reader.error(shape, f"no shape {shape.tag[:40]!r}; allowed: {allowed}")
    if len(points) and np.ptp(points, axis=0).max() > _LONGEST:
        raise reader.error(shape, f"is longer than {_LONGEST:g} m; are these millimetres?")
    return moved(transform(reader, owner), points)


def _mesh(reader: Reader, shape: Element, collides: bool) -> NDArray[np.float64]:
    name = reader.text(shape, "filename")
    if "://" in name:
        raise reader.error(shape, f"{name[:80]!r}: give the mesh as a path relative to the URDF")
    path = reader.path.parent / name
    allowed = (".obj",) if collides else (".obj", ".stl", ".dae")
    if path.suffix.lower() not in allowed:
        what = "a collision mesh" if collides else "a mesh"
        raise reader.error(shape, f"{name[:80]!r}: {what} must be {' or '.join(allowed)}")
    scale = np.array(reader.positive(shape, "scale", 3) if "scale" in shape.attributes else [1.0])
    try:
        content = read_bytes(path, what="a mesh", most=_MAX_MESH)
    except UserError as error:
        raise reader.error(shape, error.problems[0]) from error
    return _vertices(reader, shape, path, content) * scale if collides else np.zeros((0, 3))


def _vertices(reader: Reader, shape: Element, path: Path, content: bytes) -> NDArray[np.float64]:
    try:
        lines = [line.split()[1:4] for line in content.splitlines() if line.startswith(b"v ")]
        points = np.array([[float(word) for word in line] for line in lines], float)
    except ValueError:
        points = np.zeros(0)
    if points.ndim != 2 or points.shape[1] != 3 or len(points) < 4 or not np.isfinite(points).all():
        raise reader.error(shape, f"{path.name}: holds no mesh of 4 or more finite points")
    return points
