"""Passive safety: before anything touches the robot, the robot has stopped.

A state is *passively safe* if the robot can brake and stand for ``STANDSTILL`` before its disc
meets anything that moves (Macek et al. 2009; Bouraine, Fraichard, Salhi 2012). A state that is not
is a braking inevitable collision state. The speed is limited so that the next state is safe.

An obstacle that goes straight on keeps its velocity, give or take ``SPEED_TOLERANCE``, until it
meets something that stands. After that, or if its velocity is not known, it may be anywhere within
its greatest speed × time. The safety filter takes care of what stands.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from fuzzyq_bullet.planning.base import (
    LONGEST_STRIDE,
    STEP_UNIT,
    USUAL_SPEED,
    Flags,
    Floats,
    Motion,
    Observation,
)
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.planning.rollout import rollout
from fuzzyq_bullet.planning.safety_filter import safety_filter
from fuzzyq_bullet.planning.traffic.track import SPEED_TOLERANCE
from fuzzyq_bullet.planning.traffic.tracker import Traffic

STANDSTILL = 0.3
"""How long the robot must have stood before anything touches it (s)."""
RESERVE = 0.02
"""Gap that is left (m)."""
COS_AHEAD = math.cos(math.radians(15.0))
"""An obstacle within this angle of the robot's heading is ahead: it may turn and come."""
SPEEDS = 6
"""Number of speeds that are tried, from the greatest that the robot can reach to the least."""
BRAKE_DELAYS = (0.0, 0.4, 0.8, 1.2)
"""How long the robot may go on before it brakes (s): to pass in front of an obstacle may be safer
than to stop in its way."""
EARLIER = 0.25
"""An obstacle may meet what stands, and turn, so much earlier than it is expected to (s)."""
DT = 0.05
"""Time step of the prediction (s)."""
JUMP_TIME = LONGEST_STRIDE * STEP_UNIT / USUAL_SPEED
"""How long a step of the point robot lasts (s)."""
STEP_PARTS = 8
"""The step of the point robot is shortened by multiples of this part of it."""


class Course(NamedTuple):
    """A heading that the robot may keep, ahead or backwards.

    Attributes:
        heading: World heading (rad).
        backward: Whether the robot backs up.
    """

    heading: float
    backward: bool


class PassiveSafety:
    """Keeps the robot passively safe for one episode.

    As long as a speed along some heading is safe, the robot has a way out. A decision that leaves
    none is replaced by the latest heading that had one, if that is still safe.
    """

    def __init__(self) -> None:
        self._way_out: Course | None = None

    def limit(self, decision: Decision, observation: Observation, traffic: Traffic) -> Decision:
        """Return the decision, limited so that the robot is passively safe.

        Args:
            decision: A decision that the safety filter has passed.
            observation: What was observed.
            traffic: What moves or is uncertain.
        """
        motion = observation.motion
        if motion is None:
            return decision._replace(step=_safe_step(decision, observation, traffic))
        speed = safe_speed_of(decision, observation, motion, traffic)
        if speed is None and self._way_out is not None:
            out = keeping(self._way_out, decision, observation)
            speed = safe_speed_of(out, observation, motion, traffic)
            decision = decision if speed is None else out
        self._way_out = None if speed is None else Course(decision.heading, decision.backward)
        if speed == math.inf:
            return decision
        delay = motion.period + motion.latency
        reach = speed * delay + motion.way_to_stop(speed) if speed else 0.0
        return decision._replace(reach=min(decision.reach, reach))


def keeping(course: Course, decision: Decision, observation: Observation) -> Decision:
    """Return a decision to keep a course instead, at full speed and as far as it is free."""
    step = LONGEST_STRIDE * observation.unit
    taken = decision._replace(
        heading=course.heading, step=step, reach=math.inf, backward=course.backward
    )
    return safety_filter(taken, observation)


def safe_speed_of(
    decision: Decision, observation: Observation, motion: Motion, traffic: Traffic
) -> float | None:
    """Return the greatest passively safe speed (m/s) of a decision; see ``safe_speed``."""
    driven = observation.backwards() if decision.backward else observation
    return safe_speed(decision.heading, decision.reach, driven, motion, traffic)


def safe_speed(
    heading: float, reach: float, observation: Observation, motion: Motion, traffic: Traffic
) -> float | None:
    """Return the greatest passively safe speed (m/s); None if none is, infinite if all are.

    A speed is safe if for one of ``BRAKE_DELAYS`` the robot may hold it until its next decision, go
    on as fast as it can, and then brake.

    Args:
        heading: World heading that the robot turns to (rad).
        reach: How far it may go among what stands (m).
        observation: Where it is, and how it moves.
        motion: What its body can do.
        traffic: What moves or is uncertain.
    """
    traffic = in_reach(observation, motion, traffic)
    if not len(traffic.points):
        return math.inf
    speeds, brakes_after = _attempts(observation, motion)
    delay = motion.latency + motion.period
    positions = rollout(
        observation,
        motion,
        np.full(len(speeds), heading),
        (speeds, np.where(brakes_after > delay, motion.max_speed, speeds)),
        np.full(len(speeds), reach),
        seconds=delay + BRAKE_DELAYS[-1] + motion.max_speed / motion.acceleration + STANDSTILL,
        dt=DT,
        brakes_after=brakes_after,
    )
    safe = are_safe(positions, heading, observation, motion, traffic)
    safe_speeds = safe.reshape(SPEEDS, len(BRAKE_DELAYS)).any(axis=1)
    if safe_speeds[0]:
        return math.inf
    if not safe_speeds.any():
        return None
    return float(speeds[:: len(BRAKE_DELAYS)][int(safe_speeds.argmax())])


def are_safe(
    positions: Floats, heading: float, observation: Observation, motion: Motion, traffic: Traffic
) -> Flags:
    """Return which of C motions are passively safe, shape (C,).

    Args:
        positions: The robot's centre (m) every ``DT`` seconds until it stands, shape (S, C, 2).
        heading: World heading along which it goes (rad).
        observation: Where it is.
        motion: What its body can do.
        traffic: What moves or is uncertain.
    """
    gaps = _gaps(positions, heading, observation, traffic)
    least = motion.radius + RESERVE + observation.uncertainty
    return np.asarray(((gaps > least) | ~_until_stood(positions)).all(axis=0))


def in_reach(observation: Observation, motion: Motion, traffic: Traffic) -> Traffic:
    """Return the part of the traffic that can touch the robot before it could have stopped."""
    delay = motion.latency + motion.period + BRAKE_DELAYS[-1]
    time = delay + motion.max_speed / motion.acceleration + STANDSTILL
    way = motion.max_speed * delay + motion.way_to_stop(motion.max_speed)
    apart = np.hypot(*(traffic.points - observation.position).T)
    fastest = np.hypot(*traffic.velocities.T) + traffic.max_speeds
    gap = apart - motion.radius - 2.0 * RESERVE - observation.uncertainty
    near = gap < way + time * fastest
    return replace(
        traffic,
        points=traffic.points[near],
        velocities=traffic.velocities[near],
        max_speeds=traffic.max_speeds[near],
        straight_for=traffic.straight_for[near],
    )


def _attempts(observation: Observation, motion: Motion) -> tuple[Floats, Floats]:
    """Return speed (m/s) and time of braking (s) of each attempt: all pairs, fastest first."""
    change = motion.acceleration * motion.period
    most = min(motion.max_speed, max(observation.speed, 0.0) + change)
    least = max(0.0, observation.speed - change)
    speeds = np.repeat(np.linspace(most, least, SPEEDS), len(BRAKE_DELAYS))
    return speeds, np.tile(BRAKE_DELAYS, SPEEDS) + (motion.latency + motion.period)


def _until_stood(positions: Floats) -> Flags:
    """Return which of the positions (S, C, 2) count: those until the robot has stood a while."""
    times = np.arange(len(positions)) * DT
    moved = np.hypot(*np.moveaxis(np.diff(positions, axis=0), 2, 0)) > 1e-3 * DT
    last = np.where(moved.any(axis=0), len(moved) - moved[::-1].argmax(axis=0), 0)
    return np.asarray(times[:, None] <= times[last][None] + STANDSTILL + DT / 2.0)


def _gaps(positions: Floats, heading: float, observation: Observation, traffic: Traffic) -> Floats:
    """Return the distance (m) from each position (S, C, 2) to the nearest point that moves, (S, C).

    Each point is a disc that grows with time: where the obstacle may be.
    """
    times = np.arange(len(positions)) * DT
    relative = traffic.points - observation.position
    along = relative @ np.array([math.cos(heading), math.sin(heading)])
    ahead = along > COS_AHEAD * np.hypot(*relative.T)
    # An obstacle that goes away hides what it is about to meet, and may turn at any time.
    goes_away = (relative * traffic.velocities).sum(axis=1) > 0.0
    straight_for = np.where(ahead | goes_away, 0.0, np.maximum(traffic.straight_for - EARLIER, 0.0))
    straight = np.minimum(times[:, None], straight_for)
    centres = traffic.points + straight[..., None] * traffic.velocities
    grown = SPEED_TOLERANCE * straight + traffic.max_speeds * (times[:, None] - straight)
    gaps = np.linalg.norm(positions[:, :, None] - centres[:, None], axis=3) - grown[:, None]
    return np.asarray(gaps.min(axis=2))


def _safe_step(decision: Decision, observation: Observation, traffic: Traffic) -> float:
    """Return the longest part of the point robot's step (m) that nothing can come into."""
    ahead = np.array([math.cos(decision.heading), math.sin(decision.heading)])
    parts = np.linspace(0.0, 1.0, STEP_PARTS + 1)
    times = parts * JUMP_TIME
    near = observation.radius + observation.uncertainty
    for part in parts[::-1].tolist():
        step = part * decision.step
        positions = observation.position + step * parts[:, None] * ahead
        apart = np.linalg.norm(positions[:, None] - traffic.points, axis=2)
        gaps = apart - times[:, None] * traffic.max_speeds
        if (gaps.min(axis=1, initial=math.inf) > near).all():
            return float(step)
    return 0.0
