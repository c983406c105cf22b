"""Forward simulation of the robot: its turning and acceleration over the next seconds."""

from __future__ import annotations

import math

import numpy as np

from fuzzyq_bullet.planning.base import Flags, Floats, Motion, Observation

TURN_GAIN = 4.0
"""Turn rate for a heading error of 1 rad (1/s)."""


def angle_between(one: Floats, other: Floats | float) -> Floats:
    """Return the turn (rad) from one direction to another, within [−π, π): ``one`` − ``other``."""
    return np.asarray(np.remainder(one - other + math.pi, math.tau) - math.pi)


def rollout(
    observation: Observation,
    motion: Motion,
    headings: Floats,
    speeds: tuple[Floats, Floats],
    lengths: Floats,
    *,
    seconds: float,
    dt: float,
    brakes_after: Floats | float = math.inf,
    backward: Flags | bool = False,
) -> Floats:
    """Return the positions of the robot's centre (m) every ``dt`` seconds, shape (S + 1, C, 2).

    The robot is controlled as the drive does it: it turns as fast as it can, drives more slowly
    the farther it still has to turn, and stops within the free length.

    Args:
        observation: Where the robot is, and how it moves.
        motion: What its body can do.
        headings: World heading (rad) that each of C candidates turns to, shape (C,).
        speeds: Speed (m/s) of each candidate until its next decision, and after it, each of
            shape (C,).
        lengths: How far (m) each candidate may go, shape (C,).
        seconds: For how long.
        dt: Time step (s).
        brakes_after: When each candidate begins to brake (s).
        backward: Whether each candidate backs up.
    """
    count, steps = len(headings), math.ceil(seconds / dt - 1e-9)
    x = np.full(count, observation.position[0])
    y = np.full(count, observation.position[1])
    # The back of a robot that backs up is taken for its front.
    facing = observation.heading + np.where(np.broadcast_to(backward, count), math.pi, 0.0)
    speed = observation.speed * np.where(np.broadcast_to(backward, count), -1.0, 1.0)
    rate = np.full(count, observation.turn_rate)
    driven = np.zeros(count)
    positions = np.empty((steps + 1, count, 2))
    positions[0] = observation.position
    for k in range(steps):
        time = k * dt
        if time >= motion.latency - 1e-9:
            error = angle_between(headings, facing)
            rate = _approach(rate, _wanted_rate(error, motion), motion.turn_acceleration * dt)
            first = time < motion.latency + motion.period - 1e-9
            aimed = (speeds[0] if first else speeds[1]) * np.maximum(np.cos(error), 0.0)
            wanted = np.minimum(aimed, stoppable(np.maximum(lengths - driven, 0.0), motion))
            wanted = np.where(time < brakes_after - 1e-9, wanted, 0.0)
            speed = _approach(speed, wanted, motion.acceleration * dt)
        facing = facing + rate * dt
        x, y = x + speed * np.cos(facing) * dt, y + speed * np.sin(facing) * dt
        driven = driven + np.abs(speed) * dt
        positions[k + 1, :, 0], positions[k + 1, :, 1] = x, y
    return positions


def _approach(now: Floats, wanted: Floats, most: float) -> Floats:
    """Return values changed towards the wanted ones, by no more than so much."""
    return now + np.clip(wanted - now, -most, most)


def _wanted_rate(error: Floats, motion: Motion) -> Floats:
    """Return the turn rates (rad/s) for heading errors (rad)."""
    size = np.abs(error)
    quick = np.minimum(TURN_GAIN * size, np.sqrt(motion.turn_acceleration * size))
    return np.asarray(np.copysign(np.minimum(quick, motion.max_turn_rate), error))


def stoppable(room: Floats, motion: Motion) -> Floats:
    """Return the greatest speeds (m/s) that the robot can stop from within so much room (m).

    With a = ``acceleration`` and T = ``period`` + ``latency``, v·T + v²/2a = room gives
    v = √((a·T)² + 2a·room) − a·T.
    """
    lost = motion.acceleration * (motion.period + motion.latency)
    return np.asarray(np.sqrt(lost * lost + 2.0 * motion.acceleration * room) - lost)


def distances_to(points: Floats, positions: Floats) -> Floats:
    """Return the distance (m) from positions (S, C, 2) to the nearest of points (H, 2), (S, C)."""
    x = positions[..., 0, None] - points[:, 0]
    y = positions[..., 1, None] - points[:, 1]
    return np.asarray(np.sqrt((x * x + y * y).min(axis=2)))
