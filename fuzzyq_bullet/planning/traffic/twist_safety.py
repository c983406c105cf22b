"""Passive safety of twists: each is rolled out on its own arc, up to a stop.

What passive safety is, and where obstacles may be, says ``passive_safety``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from fuzzyq_bullet.planning.base import Flags, Floats, Motion, Observation
from fuzzyq_bullet.planning.commands import TwistCommand
from fuzzyq_bullet.planning.rollout import distances_to
from fuzzyq_bullet.planning.traffic.passive_safety import (
    BRAKE_DELAYS,
    DT,
    STANDSTILL,
    are_safe,
    in_reach,
)
from fuzzyq_bullet.planning.traffic.tracker import Traffic


def safe_twists(
    twists: Sequence[TwistCommand], observation: Observation, motion: Motion, traffic: Traffic
) -> Flags:
    """Return which of T twists are passively safe, shape (T,).

    A twist is if for one of ``BRAKE_DELAYS`` the robot may hold it until its next answer and so
    much longer, and then brake. Longer it may hold only what leads to nothing that stands.

    Args:
        twists: What the robot may be asked for, within its limits.
        observation: Where it is, and how it moves.
        motion: What its body can do.
        traffic: What moves, is uncertain or stands.
    """
    near = in_reach(observation, motion, traffic)
    if not len(near.points):
        return np.ones(len(twists), dtype=np.bool_)
    delay = motion.latency + motion.period
    speeds, rates = (
        np.repeat([getattr(one, name) for one in twists], len(BRAKE_DELAYS))
        for name in ("speed", "turn_rate")
    )
    delays = np.tile(BRAKE_DELAYS, len(twists))
    positions = rollout_twists(
        observation,
        motion,
        speeds,
        rates,
        seconds=delay + BRAKE_DELAYS[-1] + motion.max_speed / motion.acceleration + STANDSTILL,
        dt=DT,
        brakes_after=delays + delay,
    )
    back = math.pi if twists[0].speed < 0.0 else 0.0
    safe = are_safe(positions, observation.heading + back, observation, motion, near)
    safe &= (delays == 0.0) | _keeps_off(positions, traffic.standing, observation.radius)
    return np.asarray(safe.reshape(len(twists), -1).any(axis=1))


def rollout_twists(
    observation: Observation,
    motion: Motion,
    speeds: Floats,
    rates: Floats,
    *,
    seconds: float,
    dt: float,
    brakes_after: Floats,
) -> Floats:
    """Return the positions of the robot's centre (m) every ``dt`` seconds, shape (S + 1, C, 2).

    The robot goes on until a command reaches its wheels, then comes to each of C twists within its
    acceleration, holds it, and brakes.

    Args:
        observation: Where the robot is, and how it moves.
        motion: What its body can do.
        speeds: Forward speeds (m/s), shape (C,).
        rates: Turn rates (rad/s), shape (C,).
        seconds: For how long.
        dt: Time step (s).
        brakes_after: When the robot begins to brake (s), shape (C,).
    """
    count, steps = len(speeds), math.ceil(seconds / dt - 1e-9)
    at = np.tile(np.array(observation.position), (count, 1))
    facing = np.full(count, observation.heading)
    speed, rate = np.full(count, observation.speed), np.full(count, observation.turn_rate)
    positions = np.empty((steps + 1, count, 2))
    positions[0] = at
    for k in range(steps):
        if k * dt >= motion.latency - 1e-9:
            holds = k * dt < brakes_after - 1e-9
            speed = _towards(speed, np.where(holds, speeds, 0.0), motion.acceleration * dt)
            rate = _towards(rate, np.where(holds, rates, 0.0), motion.turn_acceleration * dt)
        facing = facing + rate * dt
        at = at + (speed * dt)[:, None] * np.column_stack([np.cos(facing), np.sin(facing)])
        positions[k + 1] = at
    return positions


def _keeps_off(positions: Floats, standing: Floats, radius: float) -> Flags:
    """Return which motions (S, C, 2) keep a disc off standing points (m) (H, 2), shape (C,).

    A disc that touches one at the start must come no nearer to any.
    """
    if not len(standing):
        return np.ones(positions.shape[1], dtype=np.bool_)
    gaps = distances_to(standing, positions)
    return np.asarray(((gaps >= radius) | (gaps >= gaps[0] - 1e-9)).all(axis=0))


def _towards(now: Floats, wanted: Floats, most: float) -> Floats:
    return now + np.clip(wanted - now, -most, most)
