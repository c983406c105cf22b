"""From a decision to a twist: one flowing motion that turns on the spot only when it must."""

from __future__ import annotations

import math
from typing import NamedTuple

from fuzzyq_bullet.drives.base import longest_step_time
from fuzzyq_bullet.geometry import wrap_angle
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.planning.rollout import TURN_GAIN
from fuzzyq_bullet.scenario.robot import Robot

GRIP = 2.5
"""Greatest sideways acceleration v·ω that the tyres are asked to hold (m/s²): a robot that is so
fast turns more slowly."""


class Twist(NamedTuple):
    """Forward speed (m/s) and turn rate (rad/s, positive to the left)."""

    speed: float
    turn_rate: float


STILL = Twist(0.0, 0.0)


class VelocityController:
    """Follows decisions within the robot's limits.

    Args:
        robot: The limits.
        period: Time between two commands (s), through which the robot cannot react.
    """

    def __init__(self, robot: Robot, period: float) -> None:
        self._robot = robot
        self._period = period
        self._step_time = longest_step_time(robot)

    def twist(self, decision: Decision, heading: float, travelled: float) -> Twist:
        """Return the twist to aim for.

        Args:
            decision: The decision in force.
            heading: Where the robot faces now (rad).
            travelled: Path driven since the decision (m), by which its reach has shrunk.
        """
        robot = self._robot
        if decision.backward:
            heading += math.pi
        error = wrap_angle(decision.heading - heading)
        turn_rate = self.turn_rate(error)
        speed = min(
            # Only what leads towards the new heading counts; more than a quarter turn away from it
            # the robot stands while it turns.
            decision.step / self._step_time * max(0.0, math.cos(error)),
            robot.max_speed,
            self._stoppable_speed(decision.reach - travelled),
            # A fast robot slows down for a turn: its tyres would not hold it on so tight an arc.
            GRIP / abs(turn_rate) if turn_rate else math.inf,
        )
        return Twist(-speed if decision.backward else speed, turn_rate)

    def turn_rate(self, error: float) -> float:
        """Return the turn rate to aim for (rad/s) at an error of the heading (rad)."""
        robot = self._robot
        stoppable = math.sqrt(robot.turn_acceleration * abs(error))
        rate = min(TURN_GAIN * abs(error), robot.max_turn_rate, stoppable)
        return math.copysign(rate, error)

    def _stoppable_speed(self, reach: float) -> float:
        """Return the greatest speed from which the robot still stops within ``reach`` (m/s).

        It drives on for one period before it brakes: v·τ + v²/(2a) = reach.
        """
        if reach <= 0.0:
            return 0.0
        lost = self._robot.acceleration * self._period
        return math.sqrt(lost * lost + 2.0 * self._robot.acceleration * reach) - lost


def limit_acceleration(now: Twist, wanted: Twist, robot: Robot, dt: float) -> Twist:
    """Return the twist after ``dt`` seconds of moving towards the wanted one within the limits.

    The turn rate is limited by the grip of the tyres, too: v·ω ≤ ``GRIP``.
    """
    fastest = max(abs(now.speed), abs(wanted.speed))
    turn_rate = wanted.turn_rate
    if fastest * abs(turn_rate) > GRIP:
        turn_rate = math.copysign(GRIP / fastest, turn_rate)
    return Twist(
        _towards(now.speed, wanted.speed, robot.acceleration * dt),
        _towards(now.turn_rate, turn_rate, robot.turn_acceleration * dt),
    )


def _towards(now: float, wanted: float, most: float) -> float:
    return max(now - most, min(wanted, now + most))
