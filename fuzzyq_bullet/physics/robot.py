"""The robot's body in the simulation: loaded from its URDF, moved by its two wheels alone."""

from __future__ import annotations

import math
from typing import NamedTuple

from fuzzyq_bullet.physics.engine import Engine
from fuzzyq_bullet.robots import RobotModel

_TYRE = 1.5
"""Friction of a wheel whose URDF says nothing of it."""


class RobotState(NamedTuple):
    """The robot at one instant.

    Attributes:
        time: Simulated time (s).
        x: Centre between the wheels (m).
        y: Centre between the wheels (m).
        heading: Direction it faces (rad).
        speed: Forward speed (m/s).
        turn_rate: Turn rate (rad/s), positive to the left.
        left_wheel: Measured speed of the left wheel (rad/s).
        right_wheel: Measured speed of the right wheel (rad/s).
    """

    time: float
    x: float
    y: float
    heading: float
    speed: float
    turn_rate: float
    left_wheel: float
    right_wheel: float


class Robot:
    """A differential drive: two velocity-controlled wheels and a caster without friction."""

    def __init__(self, engine: Engine, model: RobotModel) -> None:
        self._engine = engine
        self._api = engine.api
        self.body = load_robot(engine, model)
        count = self._api.getNumJoints(self.body, physicsClientId=engine.client)
        told = [
            self._api.getJointInfo(self.body, index, physicsClientId=engine.client)
            for index in range(count)
        ]
        names = {one[1].decode(): index for index, one in enumerate(told)}
        self.links = tuple(names.values())
        self._wheels = (names[model.axles[0]], names[model.axles[1]])
        links = {one[12].decode(): index for index, one in enumerate(told)}
        for friction, given in ((_TYRE, model.gripping), (0.0, model.slippery)):
            for link in given:  # the base has index -1, and no joint
                self._api.changeDynamics(
                    self.body,
                    links.get(link, -1),
                    lateralFriction=friction,
                    rollingFriction=0.0,
                    spinningFriction=0.0,
                    physicsClientId=engine.client,
                )
        self._forces = (model.motor_torque, model.motor_torque)
        inertial = self._api.getDynamicsInfo(self.body, -1, physicsClientId=engine.client)[3]
        self._mass_x, self._mass_y, self._mass_z = inertial

    def place(self, x: float, y: float, heading: float) -> None:
        """Put the robot at rest on the ground, centre at (x, y)."""
        client = self._engine.client
        position = (
            x + self._mass_x * math.cos(heading) - self._mass_y * math.sin(heading),
            y + self._mass_x * math.sin(heading) + self._mass_y * math.cos(heading),
            self._mass_z,
        )
        orientation = (0.0, 0.0, math.sin(heading / 2), math.cos(heading / 2))
        self._api.resetBasePositionAndOrientation(
            self.body, position, orientation, physicsClientId=client
        )
        self._api.resetBaseVelocity(self.body, (0, 0, 0), (0, 0, 0), physicsClientId=client)
        for wheel in self._wheels:
            self._api.resetJointState(self.body, wheel, 0.0, 0.0, physicsClientId=client)
        self.command(0.0, 0.0)

    def command(self, left: float, right: float) -> None:
        """Set the speeds (rad/s) that the wheel motors hold from now on."""
        self._api.setJointMotorControlArray(
            self.body,
            self._wheels,
            self._api.VELOCITY_CONTROL,
            targetVelocities=(left, right),
            forces=self._forces,
            physicsClientId=self._engine.client,
        )

    def state(self, time: float = 0.0) -> RobotState:
        """Return the robot's state now.

        Args:
            time: What time it is (s), which the engine does not know.
        """
        client = self._engine.client
        (x, y, _), (i, j, k, w) = self._api.getBasePositionAndOrientation(self.body, client)
        (vx, vy, _), (_, _, turn_rate) = self._api.getBaseVelocity(self.body, client)
        # The quaternion's turn about the z axis.
        heading = math.atan2(2.0 * (w * k + i * j), 1.0 - 2.0 * (j * j + k * k))
        cos, sin = math.cos(heading), math.sin(heading)
        # PyBullet tells the centre of mass, which lies a little towards the caster.
        left, right = self._api.getJointStates(self.body, self._wheels, client)
        return RobotState(
            time,
            x - self._mass_x * cos + self._mass_y * sin,
            y - self._mass_x * sin - self._mass_y * cos,
            heading,
            vx * cos + vy * sin,
            turn_rate,
            left[1],
            right[1],
        )


class VisibleRobot:
    """A robot to be looked at: it has no motors, and is put from pose to pose."""

    def __init__(self, engine: Engine, model: RobotModel) -> None:
        self._engine = engine
        self.body = load_robot(engine, model, visible=True)
        # PyBullet places the centre of mass, everything else here speaks of the base frame.
        self._mass = engine.api.getDynamicsInfo(self.body, -1, physicsClientId=engine.client)[3]

    def place(self, position: tuple[float, float], heading: float) -> None:
        """Put its centre at ``position`` (m), facing ``heading`` (rad)."""
        cos, sin = math.cos(heading), math.sin(heading)
        x, y, z = self._mass
        self._engine.api.resetBasePositionAndOrientation(
            self.body,
            (position[0] + x * cos - y * sin, position[1] + x * sin + y * cos, z),
            (0.0, 0.0, math.sin(heading / 2), math.cos(heading / 2)),
            physicsClientId=self._engine.client,
        )


def load_robot(engine: Engine, model: RobotModel, *, visible: bool = False) -> int:
    """Load a robot from its URDF and return its body id; its visuals only if ``visible``."""
    if model.urdf_file is not None:
        return engine.load(model.urdf_file, visible=visible)
    return engine.load_text(model.urdf(), fixed=False, visible=visible)
