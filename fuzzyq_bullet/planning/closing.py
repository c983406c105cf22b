"""Passive safety: whatever may come, the robot has stopped, and stood a moment, before it is there.

What moves straight on is taken to go on so until it meets something that stands, give or take
``FASTER``. From there on, or from now on where it cannot be told, it may be anywhere within its
greatest speed times the time. For as long as the robot goes on, brakes and has stood for ``STOOD``,
its disc must meet none of these circles. What stands is the safety filter's affair.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from fuzzyq_bullet.planning.base import (
    LONGEST_STRIDE,
    STEP_UNIT,
    USUAL_SPEED,
    Motion,
    Observation,
)
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.planning.rollout import rollout
from fuzzyq_bullet.planning.tracking import Traffic
from fuzzyq_bullet.planning.tracks import FASTER

STOOD = 0.3
"""How long the robot must have stood before anything touches it (s)."""
RESERVE = 0.02
"""Gap that is left (m)."""
AHEAD = math.cos(math.radians(15.0))
"""What is no farther aside of the robot's way than this angle is ahead: it may turn and come."""
SPEEDS = 6
"""Speeds that are tried, from as fast as the robot can be to as slow."""
GOES_ON = (0.0, 0.4, 0.8, 1.2)
"""How long the robot may go on before it brakes (s): what crosses is passed, not waited for in its
way."""
DT = 0.05
"""Time between two places of the robot that are looked at (s)."""
JUMP_TIME = LONGEST_STRIDE * STEP_UNIT / USUAL_SPEED
"""How long a step of the point robot lasts (s)."""
_PARTS = 8


def give_room(decision: Decision, observation: Observation, traffic: Traffic) -> Decision:
    """Return the decision, slow enough for what may come.

    Args:
        decision: What the safety filter has left of a decision.
        observation: What was observed.
        traffic: What moves, or cannot be told yet.
    """
    motion = observation.motion
    if not len(traffic.points):
        return decision
    if motion is None:
        return decision._replace(step=_safe_step(decision, observation, traffic))
    speed = safe_speed(decision.heading, decision.reach, observation, motion, traffic)
    if speed is None:
        return decision
    delay = motion.period + motion.latency
    return decision._replace(
        reach=min(decision.reach, speed * delay + motion.way_to_stop(speed) if speed else 0.0)
    )


def safe_speed(
    heading: float, reach: float, observation: Observation, motion: Motion, traffic: Traffic
) -> float | None:
    """Return the greatest speed (m/s) that leaves a way out; None if any will do.

    A way out is to hold that speed for one of ``GOES_ON``, or until what is free ends, and then to
    brake, without anything having come into the robot's disc until it has stood for ``STOOD``.

    Args:
        heading: World heading that it turns to (rad).
        reach: How far it may go among what stands (m).
        observation: Where it is, and how it moves.
        motion: What its body can do.
        traffic: What moves, or cannot be told yet.
    """
    traffic = _near(observation, motion, traffic)
    if not len(traffic.points):
        return None
    change = motion.acceleration * motion.period
    most = min(motion.max_speed, max(observation.speed, 0.0) + change)
    least = max(0.0, observation.speed - change)
    tried = np.repeat(np.linspace(most, least, SPEEDS), len(GOES_ON))
    delay = motion.latency + motion.period
    brakes = np.tile(GOES_ON, SPEEDS) + delay
    # Those that go on are as fast as the robot can be, once they have begun.
    goes_on = np.where(brakes > delay, motion.max_speed, tried)
    seconds = delay + GOES_ON[-1] + motion.max_speed / motion.acceleration + STOOD
    places = rollout(
        observation,
        motion,
        np.full(len(tried), heading),
        (tried, goes_on),
        np.full(len(tried), reach),
        seconds=seconds,
        dt=DT,
        brakes_after=brakes,
    )
    times = np.arange(len(places)) * DT
    moved = np.hypot(*np.moveaxis(np.diff(places, axis=0), 2, 0)) > 1e-3 * DT
    last = np.where(moved.any(axis=0), len(moved) - moved[::-1].argmax(axis=0), 0)
    counts = times[:, None] <= times[last][None] + STOOD + DT / 2.0
    near = motion.radius + RESERVE + observation.uncertainty
    rel = traffic.points - observation.position
    along = rel @ np.array([math.cos(heading), math.sin(heading)])
    # Nobody drives up to what may turn round.
    until = np.where(along > AHEAD * np.hypot(*rel.T), 0.0, traffic.until)
    straight = np.minimum(times[:, None], until)
    there = traffic.points + straight[..., None] * traffic.velocities
    grown = FASTER * straight + traffic.speeds * (times[:, None] - straight)
    apart = np.linalg.norm(places[:, :, None] - there[:, None], axis=3)
    gap = (apart - grown[:, None]).min(axis=2)
    fine = ((gap > near) | ~counts).all(axis=0).reshape(SPEEDS, len(GOES_ON)).any(axis=1)
    if fine[0]:
        return None
    return float(tried[:: len(GOES_ON)][int(fine.argmax())]) if fine.any() else 0.0


def _near(observation: Observation, motion: Motion, traffic: Traffic) -> Traffic:
    """Return what may come into the way before the robot could have stopped, if it brakes soon."""
    delay = motion.latency + motion.period
    time = delay + motion.max_speed / motion.acceleration + STOOD
    way = motion.max_speed * delay + motion.way_to_stop(motion.max_speed)
    apart = np.hypot(*(traffic.points - observation.position).T)
    fastest = np.hypot(*traffic.velocities.T) + traffic.speeds
    near = apart - motion.radius - 2.0 * RESERVE - observation.uncertainty < way + time * fastest
    return replace(
        traffic,
        points=traffic.points[near],
        velocities=traffic.velocities[near],
        speeds=traffic.speeds[near],
        until=traffic.until[near],
    )


def _safe_step(decision: Decision, observation: Observation, traffic: Traffic) -> float:
    """Return the longest part of the point robot's step that nothing can come into."""
    ahead = np.array([math.cos(decision.heading), math.sin(decision.heading)])
    parts = np.linspace(0.0, 1.0, _PARTS + 1)
    times = parts * JUMP_TIME
    near = observation.radius + observation.uncertainty
    for part in parts[::-1].tolist():
        step = part * decision.step
        places = observation.position + step * parts[:, None] * ahead
        apart = np.linalg.norm(places[:, None] - traffic.points, axis=2)
        if ((apart - times[:, None] * traffic.speeds).min(axis=1) > near).all():
            return float(step)
    return 0.0
