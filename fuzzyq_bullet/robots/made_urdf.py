"""The URDF that is made from a robot's numbers: the same build as ``assets/robot.urdf``."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fuzzyq_bullet.robots.base import RobotModel

GROUND_CLEARANCE = 0.03
"""Height of the body's underside, and radius of the caster (m)."""
_BACK = -0.15
"""Where the centre of mass lies, in halves of the body's length ahead of its middle."""
_LOW = 0.08
"""Greatest height of the centre of mass (m): a robot that brakes hard must not tip over."""


def made_urdf(robot: RobotModel) -> str:
    """Return a URDF of a robot's numbers.

    The centre of mass lies a little towards the caster. Wheels roll on spheres; the caster slides
    without friction.
    """
    r, length, middle_z = robot.radius, robot.height - GROUND_CLEARANCE, robot.sensor_height
    # How far the body reaches forward and back of its middle.
    if robot.size is None:
        half, solid = r, f'<cylinder radius="{r!r}" length="{length!r}"/>'
        across = robot.mass * (3 * r * r + length * length) / 12
        inertia = (across, across, robot.mass * r * r / 2)
    else:
        (a, b), m = robot.size, robot.mass
        half, solid = a / 2, f'<box size="{a!r} {b!r} {length!r}"/>'
        squares = (b * b + length * length, a * a + length * length, a * a + b * b)
        inertia = (m * squares[0] / 12, m * squares[1] / 12, m * squares[2] / 12)
    x = robot.offset
    origin = f'<origin xyz="{x!r} 0 {middle_z!r}"/>'
    body = (
        f"<visual>{origin}<geometry>{solid}</geometry>{_colour(0.93)}</visual>"
        f'<visual><origin xyz="{x + half / 3!r} 0 {robot.height + 0.003!r}"/><geometry>'
        f'<box size="{0.9 * half!r} {0.3 * half!r} 0.006"/></geometry>{_colour(0.13)}</visual>'
        f"<collision>{origin}<geometry>{solid}</geometry></collision>"
    )
    middle = (_BACK * half + x, 0.0, min(middle_z - 0.01, _LOW))
    parts = [
        f'<robot name="{robot.name}">',
        _link("chassis", body, robot.mass, middle, inertia),
    ]
    w, m = robot.wheel_radius, robot.wheel_mass
    rolling = (0.4 * m * w * w, 0.5 * m * w * w, 0.4 * m * w * w)
    for side, y in (("left", robot.track / 2), ("right", -robot.track / 2)):
        parts.append(_link(f"{side}_wheel", _tyre(w), m, (0.0, 0.0, 0.0), rolling, 1.5))
        joint = '<axis xyz="0 1 0"/>'
        parts.append(_joint(f"{side}_axle", "continuous", f"{side}_wheel", (0.0, y, w), joint))
    c = GROUND_CLEARANCE
    parts.append(_link("caster", _ball(c), 0.05, (0.0, 0.0, 0.0), (2e-5, 2e-5, 2e-5), 0.0))
    parts.append(_joint("caster_mount", "fixed", "caster", (-0.7 * half + x, 0.0, c)))
    return "\n".join([*parts, "</robot>"])


def _xyz(point: tuple[float, float, float]) -> str:
    return " ".join(map(repr, point))


def _colour(grey: float) -> str:
    return f'<material name="grey{grey}"><color rgba="{grey} {grey} {grey} 1"/></material>'


def _tyre(radius: float) -> str:
    """Return a wheel that looks like a cylinder, and rolls on a sphere."""
    seen = f'<geometry><cylinder radius="{radius!r}" length="{0.5 * radius!r}"/></geometry>'
    turned = '<origin rpy="1.5707963267948966 0 0"/>'
    rolling = f'<geometry><sphere radius="{radius!r}"/></geometry>'
    visual = f"<visual>{turned}{seen}{_colour(0.13)}</visual>"
    return f"{visual}<collision>{rolling}</collision>"


def _ball(radius: float) -> str:
    geometry = f'<geometry><sphere radius="{radius!r}"/></geometry>'
    return f"<visual>{geometry}{_colour(0.13)}</visual><collision>{geometry}</collision>"


def _link(
    name: str,
    body: str,
    mass: float,
    middle: tuple[float, float, float],
    inertia: tuple[float, float, float],
    friction: float | None = None,
) -> str:
    ixx, iyy, izz = inertia
    contact = (
        ""
        if friction is None
        else f'<contact><lateral_friction value="{friction}"/><rolling_friction value="0"/>'
        '<spinning_friction value="0"/></contact>'
    )
    return (
        f'<link name="{name}">{contact}<inertial><origin xyz="{_xyz(middle)}"/>'
        f'<mass value="{mass!r}"/><inertia ixx="{ixx!r}" iyy="{iyy!r}" izz="{izz!r}" '
        f'ixy="0" ixz="0" iyz="0"/></inertial>\n{body}</link>'
    )


def _joint(name: str, kind: str, child: str, at: tuple[float, float, float], more: str = "") -> str:
    return (
        f'<joint name="{name}" type="{kind}"><parent link="chassis"/><child link="{child}"/>'
        f'<origin xyz="{_xyz(at)}"/>{more}</joint>'
    )
