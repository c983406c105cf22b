"""Where the robot would be in the next seconds: its turning and its acceleration simulated."""

from __future__ import annotations

import math

import numpy as np

from fuzzyq_bullet.planning.base import Floats, Motion, Observation

TURN_GAIN = 4.0
"""Turn rate for an error of heading of 1 rad (1/s)."""


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
) -> Floats:
    """Return where the robot's centre is (m) every ``dt`` seconds, shape (S + 1, C, 2).

    It does what the drive does: it turns as fast as it can, drives the slower the farther it still
    has to turn, and stops within the free length.

    Args:
        observation: Where it is now, and how it moves.
        motion: What its body can do.
        headings: World heading (rad) that each of C attempts turns to, shape (C,).
        speeds: Speed (m/s) that each aims for until its next decision, and that after it, each of
            shape (C,).
        lengths: How far (m) each may go, shape (C,).
        seconds: For how long.
        dt: Time between two places (s).
        brakes_after: When each begins to brake (s).
    """
    count, steps = len(headings), math.ceil(seconds / dt - 1e-9)
    x = np.full(count, observation.position[0])
    y = np.full(count, observation.position[1])
    facing = np.full(count, observation.heading)
    speed, rate = np.full(count, observation.speed), np.full(count, observation.turn_rate)
    driven, lost = np.zeros(count), motion.acceleration * (motion.period + motion.latency)
    places = np.empty((steps + 1, count, 2))
    places[0] = observation.position
    for k in range(steps):
        if k * dt >= motion.latency - 1e-9:
            error = np.remainder(headings - facing + math.pi, math.tau) - math.pi
            size = np.abs(error)
            quick = np.minimum(TURN_GAIN * size, np.sqrt(motion.turn_acceleration * size))
            wanted_rate = np.copysign(np.minimum(quick, motion.max_turn_rate), error)
            most = motion.turn_acceleration * dt
            rate = rate + np.clip(wanted_rate - rate, -most, most)
            soon = k * dt < motion.latency + motion.period - 1e-9
            room = np.maximum(lengths - driven, 0.0)
            stoppable = np.sqrt(lost * lost + 2.0 * motion.acceleration * room) - lost
            wanted = (speeds[0] if soon else speeds[1]) * np.maximum(np.cos(error), 0.0)
            wanted = np.where(k * dt < brakes_after - 1e-9, np.minimum(wanted, stoppable), 0.0)
            most = motion.acceleration * dt
            speed = speed + np.clip(wanted - speed, -most, most)
        facing = facing + rate * dt
        x, y = x + speed * np.cos(facing) * dt, y + speed * np.sin(facing) * dt
        driven = driven + np.abs(speed) * dt
        places[k + 1, :, 0], places[k + 1, :, 1] = x, y
    return places
