"""What a robot is: its footprint, wheels, masses, limits, and the URDF made from them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, TypeAlias

from pydantic import Field

from fuzzyq_bullet.quantities import Model, Number
from fuzzyq_bullet.wording import not_one_of

MaxSpeed: TypeAlias = Annotated[Number, Field(ge=0.05, le=3.0)]
MaxTurnRate: TypeAlias = Annotated[Number, Field(ge=0.2, le=6.0)]
Acceleration: TypeAlias = Annotated[Number, Field(ge=0.1, le=20.0)]
TurnAcceleration: TypeAlias = Annotated[Number, Field(ge=0.5, le=30.0)]
_Positive: TypeAlias = Annotated[Number, Field(gt=0.0, le=1000.0)]

RANGE_UNITS = 5.0
"""Range of the detection lines, in units of the robot's radius: 5·S_p (Section 3.1)."""
_GROUND_CLEARANCE = 0.03
"""Height of the body's underside, and radius of the caster (m)."""


class RobotModel(Model):
    """A differential drive: two driven wheels and a caster under a round body.

    Attributes:
        name: What a scenario calls it: ``robot: {model: NAME}``.
        radius: Radius of the footprint, a disc (m). It is the paper's unit S_p: the sensor reaches
            5·S_p, and the controller's steps are multiples of it.
        height: Height of the body's lid (m); the sensor looks out half way up the body.
        track: Distance between the wheels (m).
        wheel_radius: Radius of the wheels (m).
        mass: Mass of the body (kg).
        wheel_mass: Mass of each wheel (kg).
        motor_torque: Greatest torque of a wheel's motor (N·m).
        max_speed: Greatest speed (m/s), unless the scenario says otherwise; likewise the rest.
        max_turn_rate: Greatest turn rate (rad/s).
        acceleration: Greatest change of speed (m/s²).
        turn_acceleration: Greatest change of the turn rate (rad/s²).
        urdf_file: A URDF whose base frame lies on the ground between the wheels, x forward, with
            the driven joints ``left_axle`` and ``right_axle``; by default it is made from the
            numbers above.
    """

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]{0,99}$")]
    radius: Annotated[Number, Field(ge=0.05, le=2.0)] = 0.2
    height: Annotated[Number, Field(gt=_GROUND_CLEARANCE, le=0.24)] = 0.15
    track: _Positive = 0.28
    wheel_radius: _Positive = 0.05
    mass: _Positive = 5.0
    wheel_mass: _Positive = 0.2
    motor_torque: _Positive = 3.0
    max_speed: MaxSpeed = 0.6
    max_turn_rate: MaxTurnRate = 2.0
    acceleration: Acceleration = 1.0
    turn_acceleration: TurnAcceleration = 6.0
    urdf_file: Path | None = None

    @property
    def sensor_range(self) -> float:
        """Longest distance that a detection line tells (m) unless the sensor says more: 5·S_p."""
        return RANGE_UNITS * self.radius

    @property
    def sensor_height(self) -> float:
        """Height of the sensor's rays above the ground (m): the middle of the body."""
        return (_GROUND_CLEARANCE + self.height) / 2

    def wheel_commands(self, speed: float, turn_rate: float) -> tuple[float, float]:
        """Return the wheel speeds (rad/s), left and right, of an ideal differential drive.

        Args:
            speed: Forward speed (m/s).
            turn_rate: Turn rate (rad/s).
        """
        half = turn_rate * self.track / 2
        return (speed - half) / self.wheel_radius, (speed + half) / self.wheel_radius

    def urdf(self) -> str:
        """Return a URDF of these numbers: the same build as ``assets/robot.urdf``.

        The centre of mass lies a little towards the caster. Wheels roll on spheres; the caster
        slides without friction.
        """
        r, length = self.radius, self.height - _GROUND_CLEARANCE
        across = self.mass * (3 * r * r + length * length) / 12
        body = (
            f'<visual><origin xyz="0 0 {self.sensor_height!r}"/><geometry>'
            f'<cylinder radius="{r!r}" length="{length!r}"/></geometry>{_colour(0.93)}</visual>'
            f'<visual><origin xyz="{r / 3!r} 0 {self.height + 0.003!r}"/><geometry>'
            f'<box size="{0.9 * r!r} {0.3 * r!r} 0.006"/></geometry>{_colour(0.13)}</visual>'
            f'<collision><origin xyz="0 0 {self.sensor_height!r}"/><geometry>'
            f'<cylinder radius="{r!r}" length="{length!r}"/></geometry></collision>'
        )
        middle = (-0.15 * r, 0.0, self.sensor_height - 0.01)
        parts = [
            f'<robot name="{self.name}">',
            _link("chassis", body, self.mass, middle, (across, across, self.mass * r * r / 2)),
        ]
        w, m = self.wheel_radius, self.wheel_mass
        inertia = (0.4 * m * w * w, 0.5 * m * w * w, 0.4 * m * w * w)
        for side, y in (("left", self.track / 2), ("right", -self.track / 2)):
            parts.append(_link(f"{side}_wheel", _ball(w), m, (0.0, 0.0, 0.0), inertia, 1.5))
            joint = '<axis xyz="0 1 0"/>'
            parts.append(_joint(f"{side}_axle", "continuous", f"{side}_wheel", (0.0, y, w), joint))
        c = _GROUND_CLEARANCE
        parts.append(_link("caster", _ball(c), 0.05, (0.0, 0.0, 0.0), (2e-5, 2e-5, 2e-5), 0.0))
        parts.append(_joint("caster_mount", "fixed", "caster", (-0.7 * r, 0.0, c)))
        return "\n".join([*parts, "</robot>"])


def _xyz(point: tuple[float, float, float]) -> str:
    return " ".join(map(repr, point))


def _colour(grey: float) -> str:
    return f'<material name="grey{grey}"><color rgba="{grey} {grey} {grey} 1"/></material>'


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


_robots: dict[str, RobotModel] = {}


def register_robot(robot: RobotModel) -> RobotModel:
    """Make a robot known, so that scenario files may ask for it: ``robot: {model: NAME}``.

    One call in a file that ``--plugin`` names is enough::

        from fuzzyq_bullet.robots import RobotModel, register_robot

        register_robot(RobotModel(name="mouse", radius=0.08, track=0.12, wheel_radius=0.02))

    A robot of the package itself is a module here that ``robots/__init__.py`` imports.

    What is not given is that of the default robot. Physics, sensor, planner, shortest path, layouts
    and film take its radius from here.

    Raises:
        ValueError: If the name is taken, or the wheels do not fit under the body.
    """
    if robot.name in _robots:
        raise ValueError(f"a robot named {robot.name!r} is registered already")
    if robot.track / 2 > robot.radius or 2 * robot.wheel_radius > robot.height:
        raise ValueError(f"the wheels of {robot.name!r} do not fit under its body")
    _robots[robot.name] = robot
    return robot


def robot_names() -> tuple[str, ...]:
    """Return all registered names, in order of registration."""
    return tuple(_robots)


def robot_model(name: str) -> RobotModel:
    """Return the robot of that name.

    Raises:
        KeyError: If there is none.
    """
    return _robots[name]


def no_robot(name: Any) -> str:
    """Say that no robot has this name, which do exist, and how others come to be known."""
    return f"{not_one_of('robot', name, robot_names())}; --plugin FILE adds one of your own"
