"""A user's URDF, checked before it drives: two true wheels on the ground, and a body of its own."""

from __future__ import annotations

import math
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.reading.xml_tree import Element
from fuzzyq_bullet.robots.base import TALLEST, RobotModel
from fuzzyq_bullet.robots.urdf_file import Reader, read_urdf
from fuzzyq_bullet.robots.urdf_parts import Link, moved, read_link, transform

_NEAR = 0.002
"""How exactly wheels must lie opposite each other, and on the ground (m)."""
_TORQUE = 4.0
"""Torque of a wheel's motor for each kilogram and metre of the wheel's radius: 8 m/s² by two."""


def robot_from_urdf(path: Path, left: str | None = None, right: str | None = None) -> RobotModel:
    """Return the robot that a URDF describes; its footprint and wheels are measured there.

    Args:
        path: The file.
        left: Name of the joint of the left wheel; by default it is found by its name.
        right: Likewise of the right wheel.

    Raises:
        UserError: If it cannot be read, or could not drive; one line with file and line.
    """
    try:
        status = path.stat()
        stamp = (status.st_mtime_ns, status.st_size)
    except (OSError, ValueError):
        stamp = (0, 0)
    return _robot(path, left, right, stamp)


@lru_cache(maxsize=16)
def _robot(path: Path, left: str | None, right: str | None, stamp: tuple[int, int]) -> RobotModel:
    reader = Reader(path)
    root = read_urdf(path)
    links = _links(reader, root)
    joints = _joints(reader, root, links)
    axles = _axles(reader, root, joints, left, right)
    for name, joint in joints.items():
        kind = joint.attributes.get("type", "")
        if name in axles and kind != "continuous":
            raise reader.error(joint, f"{name!r} drives a wheel: its type must be continuous")
        if name not in axles and kind != "fixed":
            why = f"joint {name!r} is {kind or 'of no type'}; only the two wheels may move"
            raise reader.error(joint, f"{why}: it must be fixed")
    poses = _poses(reader, root, links, joints)
    centres = [_axle(reader, joints[name], poses) for name in axles]
    children = [_end(reader, joints[name], "child") for name in axles]
    track = _track(reader, [joints[name] for name in axles], centres)
    wheel = _wheel_radius(reader, children, links, poses, centres)
    everything = np.vstack([moved(poses[name], link.points) for name, link in links.items()])
    _check_stance(reader, root, children, links, poses)
    hull = _hull(everything[:, :2])
    if min(np.ptp(hull, axis=0)) < 0.02 or not _inside((0.0, 0.0), hull):
        raise reader.error(root, "the base frame must lie within the body's footprint")
    radius = float(np.hypot(*hull.T).max())
    if not 0.05 <= radius <= 2.0:
        raise reader.error(root, f"its footprint has a radius of {radius:.3g} m; 0.05 to 2 allowed")
    mass = sum(link.mass for name, link in links.items() if name not in children)
    return RobotModel(
        name=_tidy(root.attributes.get("name", "")),
        corners=tuple((float(x), float(y)) for x, y in hull),
        height=max(0.04, float(everything[:, 2].max())),
        track=track,
        wheel_radius=wheel,
        mass=mass,
        wheel_mass=links[children[0]].mass,
        motor_torque=min(1000.0, max(1.0, _TORQUE * mass * wheel)),
        urdf_file=path.absolute(),
        axles=axles,
        slippery=tuple(n for n, one in links.items() if not one.has_friction and n not in children),
        gripping=tuple(n for n in children if not links[n].has_friction),
        source=f"measured from {path.name}",
    )


def _links(reader: Reader, root: Element) -> dict[str, Link]:
    links: dict[str, Link] = {}
    for element in root.every("link"):
        name = reader.text(element, "name")
        if name in links:
            raise reader.error(element, f"link {name!r} is there twice")
        links[name] = read_link(reader, element)
    if not links:
        raise reader.error(root, "has no links")
    return links


def _joints(reader: Reader, root: Element, links: dict[str, Link]) -> dict[str, Element]:
    joints: dict[str, Element] = {}
    parents: dict[str, str] = {}
    for joint in root.every("joint"):
        name = reader.text(joint, "name")
        if name in joints:
            raise reader.error(joint, f"joint {name!r} is there twice")
        joints[name] = joint
        for end in ("parent", "child"):
            if _end(reader, joint, end) not in links:
                raise reader.error(joint, f"joint {name!r} has a {end} that is no link")
        child = _end(reader, joint, "child")
        if child in parents:
            raise reader.error(joint, f"link {child!r} has two parents")
        parents[child] = _end(reader, joint, "parent")
    return joints


def _end(reader: Reader, joint: Element, end: str) -> str:
    element = joint.first(end)
    if element is None:
        raise reader.error(joint, f"a joint without a <{end}>")
    return reader.text(element, "link")


def _axles(
    reader: Reader, root: Element, joints: dict[str, Element], left: str | None, right: str | None
) -> tuple[str, str]:
    found = []
    for side, given in (("left", left), ("right", right)):
        if given is not None:
            names = [given] if given in joints else []
        elif f"{side}_axle" in joints:
            names = [f"{side}_axle"]
        else:
            names = [n for n in joints if side in n.lower() and "wheel" in n.lower()]
        if len(names) != 1:
            what = "no joint" if not names else f"{len(names)} joints"
            listed = ", ".join(list(joints)[:8]) or "none"
            why = f"{what} for the {side} wheel; name it: {side}_wheel: JOINT"
            raise reader.error(root, f"{why}; joints: {listed}")
        found += names
    if found[0] == found[1]:
        raise reader.error(joints[found[0]], "is both the left and the right wheel")
    return found[0], found[1]


def _poses(
    reader: Reader, root: Element, links: dict[str, Link], joints: dict[str, Element]
) -> dict[str, NDArray[np.float64]]:
    """Return the pose of every link in the base frame, shape (4, 4)."""
    children = {_end(reader, joint, "child"): joint for joint in joints.values()}
    bases = [name for name in links if name not in children]
    if len(bases) != 1:
        raise reader.error(root, f"must be one tree: {len(bases)} links have no parent, 1 is right")
    poses = {bases[0]: np.eye(4)}
    waiting = dict(children)
    while waiting:
        ready = [n for n, joint in waiting.items() if _end(reader, joint, "parent") in poses]
        if not ready:
            raise reader.error(next(iter(waiting.values())), "its joints go round in a circle")
        for name in ready:
            joint = waiting.pop(name)
            parent = poses[_end(reader, joint, "parent")]
            poses[name] = parent @ transform(reader, joint)
    return poses


def _axle(
    reader: Reader, joint: Element, poses: dict[str, NDArray[np.float64]]
) -> NDArray[np.float64]:
    """Return the centre of a wheel (m), whose axis must point to the left of the robot."""
    pose = poses[_end(reader, joint, "child")]
    axis = joint.first("axis")
    along = np.array([1.0, 0.0, 0.0] if axis is None else reader.numbers(axis, "xyz", 3))
    turned = pose[:3, :3] @ along
    length = float(np.linalg.norm(turned))
    if length < 1e-6 or turned[1] / length < math.cos(math.radians(0.5)):
        shown = " ".join(f"{value:.3g}" for value in turned)
        why = "a wheel turns about the robot's y axis: 0 1 0 in the base frame, both the same way"
        raise reader.error(axis or joint, f"{why}; this is {shown}")
    return np.array(pose[:3, 3])


def _track(reader: Reader, axles: list[Element], centres: list[NDArray[np.float64]]) -> float:
    left, right = centres
    if left[1] <= right[1]:
        raise reader.error(axles[0], "the left wheel must be on the left: y greater than 0")
    off = np.abs(left * (1, -1, 1) - right).max()
    if off > _NEAR:
        raise reader.error(axles[1], f"the wheels must lie opposite each other; {off:.3g} m off")
    if abs(left[0]) > _NEAR:
        why = f"the base frame must lie between the wheels; they are at x = {left[0]:.3g} m"
        raise reader.error(axles[0], why)
    return float(left[1] - right[1])


def _wheel_radius(
    reader: Reader,
    wheels: list[str],
    links: dict[str, Link],
    poses: dict[str, NDArray[np.float64]],
    centres: list[NDArray[np.float64]],
) -> float:
    radii = []
    for name, centre in zip(wheels, centres, strict=True):
        link = links[name]
        if not len(link.points):
            raise reader.error(link.element, f"wheel {name!r} has no collision shape")
        lowest = float(moved(poses[name], link.points)[:, 2].min())
        if abs(lowest) > _NEAR:
            why = f"wheel {name!r} ends at z = {lowest:.3g} m; it must stand on the ground, z = 0"
            raise reader.error(link.element, why)
        radii.append(float(centre[2]) - lowest)
    if abs(radii[0] - radii[1]) > _NEAR or min(radii) < 0.005:
        raise reader.error(links[wheels[1]].element, "both wheels must have the same radius")
    return radii[0]


def _check_stance(
    reader: Reader,
    root: Element,
    wheels: list[str],
    links: dict[str, Link],
    poses: dict[str, NDArray[np.float64]],
) -> None:
    others = [n for n, link in links.items() if n not in wheels and len(link.points)]
    if not others:
        raise reader.error(root, "has no body: give a link other than the wheels a <collision>")
    heights = {name: moved(poses[name], links[name].points)[:, 2] for name in others}
    lowest = min(others, key=lambda name: heights[name].min())
    at = float(heights[lowest].min())
    if at < -_NEAR:
        why = f"link {lowest!r} reaches to z = {at:.3g} m, below the ground"
        raise reader.error(links[lowest].element, why)
    if at > 2.5 * _NEAR:
        raise reader.error(root, "stands on its two wheels alone; give it a caster down to z = 0")
    top = max(float(z.max()) for z in heights.values())
    if top > TALLEST:
        raise reader.error(root, f"is {top:.3g} m tall; obstacles are {TALLEST:g} m high")


def _hull(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the convex hull of points (m), shape (n, 2), counter-clockwise (monotone chain)."""
    ordered = sorted({(round(float(x), 6), round(float(y), 6)) for x, y in points})

    def half(along: list[tuple[float, float]]) -> list[tuple[float, float]]:
        chain: list[tuple[float, float]] = []
        for x, y in along:
            while len(chain) > 1:
                (ax, ay), (bx, by) = chain[-2:]
                if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 1e-12:
                    break
                chain.pop()
            chain.append((x, y))
        return chain[:-1]

    return np.array([*half(ordered), *half(ordered[::-1])]).reshape(-1, 2)


def _inside(point: tuple[float, float], hull: NDArray[np.float64]) -> bool:
    ahead = np.roll(hull, -1, axis=0) - hull
    to = np.array(point) - hull
    return bool((ahead[:, 0] * to[:, 1] - ahead[:, 1] * to[:, 0] > 0.0).all())


def _tidy(name: str) -> str:
    kept = "".join(c if c.isascii() and (c.isalnum() or c in "._-") else "-" for c in name)
    return kept.lstrip("._-")[:100] or "robot"
