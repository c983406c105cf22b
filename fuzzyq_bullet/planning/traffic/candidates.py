"""Motions that the robot may choose among moving obstacles, and what each of them comes to.

Obstacles keep their velocity, as for velocity obstacles (Fiorini, Shiller 1998). But each candidate
motion of the robot is simulated with its own turning and acceleration, as for the dynamic window.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fuzzyq_bullet.planning.aim import Aim
from fuzzyq_bullet.planning.base import Flags, Floats, Motion, Observation
from fuzzyq_bullet.planning.rollout import angle_between, distances_to, rollout
from fuzzyq_bullet.planning.traffic.tracker import Traffic

HORIZON = 2.5
"""How far ahead the motion is predicted (s)."""
DT = 0.1
"""Time step of the prediction (s)."""
MARGIN = 0.05
"""Gap to a moving obstacle now (m) ..."""
MARGIN_GROWTH = 0.05
"""... and what is added for each second ahead (m/s): its velocity is not known exactly."""
AFTER_STRAIGHT = 0.5
"""After it has met a standing one, an obstacle is expected within this part of speed × time."""
HEADINGS = 24
"""Number of headings that are tried, all around."""
SLOW = 0.5
"""The lower speed that is tried, as a part of the greatest."""
BEHIND = math.radians(61.0)
"""It backs up only where it turns its back no farther than this (rad)."""
STOP_SHORT = 0.05
"""How much of the free distance is not used (m)."""


class Candidates(NamedTuple):
    """C motions of the robot: the way to the aim, standing still, and others.

    Attributes:
        headings: World heading (rad), shape (C,).
        speeds: Speed (m/s), shape (C,).
        lengths: Length (m), shape (C,).
        backward: Whether the robot backs up, shape (C,).
    """

    headings: Floats
    speeds: Floats
    lengths: Floats
    backward: Flags

    def first(self) -> Candidates:
        """Return the way to the aim alone."""
        headings, speeds, lengths, backward = self
        return Candidates(headings[:1], speeds[:1], lengths[:1], backward[:1])


def candidates_towards(
    observation: Observation, motion: Motion, aim: Aim, traffic: Traffic
) -> Candidates:
    """Return the way to the aim, standing still, all headings at two speeds, and back."""
    around = np.float64(aim.bearing) + np.arange(HEADINGS) * (math.tau / HEADINGS)
    free = _free_distance(observation, traffic.standing, around)
    free = np.maximum(free - STOP_SHORT, 0.0)
    fast, slow = np.full(HEADINGS, motion.max_speed), np.full(HEADINGS, SLOW * motion.max_speed)
    behind = np.abs(angle_between(around, observation.heading + math.pi)) < BEHIND
    back, forward = fast[behind], 2 + 2 * HEADINGS
    return Candidates(
        headings=np.concatenate(
            [[aim.bearing, observation.heading], around, around, around[behind]]
        ),
        speeds=np.concatenate([[motion.max_speed, 0.0], fast, slow, back]),
        lengths=np.concatenate([[min(aim.reach, free[0]), 0.0], free, free, free[behind]]),
        backward=np.arange(forward + len(back)) >= forward,
    )


def predict(
    observation: Observation,
    motion: Motion,
    candidates: Candidates,
    traffic: Traffic,
    *,
    margins: bool = True,
) -> tuple[Floats, Floats]:
    """Simulate candidates among moving obstacles.

    Returns:
        The least gap to an obstacle (m), less the margin if ``margins``, shape (S, C), and the
        robot's positions (m), shape (S, C, 2).
    """
    headings, speeds, lengths, backward = candidates
    positions = rollout(
        observation,
        motion,
        headings,
        (speeds, speeds),
        lengths,
        seconds=HORIZON,
        dt=DT,
        backward=backward,
    )
    positions = _stop_at_standing(positions, traffic.standing, motion.radius)
    times = np.arange(len(positions)) * DT
    gaps = np.full(positions.shape[:2], np.inf)
    for track in traffic.tracks:
        known = track.velocity is not None
        velocity = np.array(track.velocity if known else (0.0, 0.0))
        speed = float(np.hypot(*velocity)) if known else observation.closing_speed
        straight = np.minimum(times, track.straight_for if known else 0.0)
        centres = np.array(track.centre) + straight[:, None] * velocity
        apart = np.linalg.norm(positions - centres[:, None], axis=2)
        least = track.radius + motion.radius + margins * (MARGIN + MARGIN_GROWTH * straight)
        least = least + AFTER_STRAIGHT * speed * (times - straight)
        np.minimum(gaps, apart - least[:, None], out=gaps)
    return gaps, positions


def _stop_at_standing(positions: Floats, standing: Floats, radius: float) -> Floats:
    """Return positions (m), shape (S, C, 2), that end before the disc meets a standing point.

    A disc that touches one at the start may still move, as long as it comes no nearer to any.
    """
    if not len(standing):
        return positions
    gap = distances_to(standing, positions)
    hit = (gap < radius) & (gap < gap[0])
    last = np.where(hit.any(axis=0), np.maximum(hit.argmax(axis=0) - 1, 0), len(positions))
    at = np.minimum(np.arange(len(positions))[:, None], last)
    return np.asarray(np.take_along_axis(positions, at[..., None], axis=0))


def _free_distance(observation: Observation, standing: Floats, headings: Floats) -> Floats:
    """Return how far (m) the disc can go along each heading before it meets a standing point."""
    if not len(standing):
        return np.full(len(headings), observation.range)
    local = (standing - observation.position) @ np.array([1.0, 1j])
    seen = local[None] * np.exp(-1j * headings)[:, None]
    wide = min(observation.radius, float(np.abs(local).min()) - 1e-3)
    depth = wide**2 - seen.imag**2
    ahead = (seen.real > 0.0) & (depth > 0.0)
    free = np.where(ahead, seen.real - np.sqrt(np.maximum(depth, 0.0)), np.inf)
    return np.asarray(np.clip(free.min(axis=1), 0.0, observation.range))
