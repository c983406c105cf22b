"""The safety filter: no robot drives farther than what is free along the path that it takes."""

from __future__ import annotations

import math

from fuzzyq_bullet.geometry import wrap_angle
from fuzzyq_bullet.planning.base import Motion, Observation
from fuzzyq_bullet.planning.decision import Decision

RESERVE = 0.02
"""Free distance that is never used up (m): a detection line may be so much too long, where a corner
stands between two of its rays."""
NARROW = math.radians(0.3)
"""A turn up to this counts as none (rad): one corridor covers both headings."""
SAME = math.radians(0.3)
"""A line that was cast already serves for all headings as near to it as this (rad)."""
ROLLS = 0.05
"""A robot that rolls faster than this (m/s) the other way must stop first."""
WIDEST = math.radians(90.0)
"""The robot stops before it has turned further than this (rad)."""


def safety_filter(decision: Decision, observation: Observation) -> Decision:
    """Return the decision limited to what is free.

    The paper's point robot faces the new heading at once: one corridor along it caps its step. On
    wheels the reach is capped, from which the speed follows, and the turn if necessary.
    """
    motion = observation.motion
    if motion is not None:
        driven = observation.backwards() if decision.backward else observation
        if driven.speed < -ROLLS:
            return _brakes(decision, driven)
        return _filtered_on_wheels(decision, driven, motion)
    [free] = observation.sense([decision.heading])
    usable = free - RESERVE - observation.uncertainty
    return decision._replace(step=max(0.0, min(decision.step, usable)), guard=free)


def _brakes(decision: Decision, observation: Observation) -> Decision:
    """Return the decision of a robot that still rolls the other way: it stops as it is.

    That way was found free by the decision before.
    """
    return decision._replace(heading=observation.heading, reach=0.0, guard=0.0)


def _filtered_on_wheels(decision: Decision, observation: Observation, motion: Motion) -> Decision:
    """Filter the decision for a robot that turns on an arc and needs a distance to stop.

    Seen from the robot, every point of the arc up to a stop lies between its heading and the new
    one. A fan of corridors between the two covers the arc, and the shortest of them is how far the
    robot can go for certain. Where a corridor is shorter than the robot needs to stop, it does not
    turn that far yet: it brakes first, and turns as it becomes slower.
    """
    facing = observation.heading
    turn = wrap_angle(decision.heading - facing)
    # How far the robot still turns until it hears of it, and while it reverses its turn rate.
    coast = observation.turn_rate * abs(observation.turn_rate) / (2.0 * motion.turn_acceleration)
    coast += observation.turn_rate * motion.latency
    reserve = RESERVE + observation.uncertainty
    start = max(0.0, min(coast, turn)) if turn >= 0.0 else min(0.0, max(coast, turn))
    spacing = _spacing(motion, observation.speed)
    if start == coast and NARROW < abs(turn) <= spacing:
        # The two corridors cover the whole arc.
        passed, wanted = [0.0], [turn]
    else:
        first = turn if abs(turn) <= NARROW else 0.0
        passed = [first, *_spread(0.0, coast, spacing)]
        wanted = _spread(start, turn, spacing)
    # Take the decision's own heading, not a rounded sum: it may have been sensed already.
    headings = [decision.heading if one == turn else facing + one for one in (*passed, *wanted)]
    free = _free(decision, observation, headings)

    reach = min(free[: len(passed)]) - reserve
    heading, ahead = facing + start if wanted else decision.heading, reach + reserve
    fastest = min(motion.max_speed, observation.speed + motion.acceleration * motion.latency)
    speed = fastest if motion.latency > 0.0 else observation.speed
    need = speed * (motion.period + motion.latency) + motion.way_to_stop(speed)
    later = slice(len(passed), None)
    for further, length in zip(headings[later], free[later], strict=True):
        if reserve < need > length - reserve:
            reach = 0.0
            break
        reach = min(reach, length - reserve)
        heading, ahead = further, length
    return decision._replace(
        heading=heading,
        step=decision.step,
        reach=max(0.0, min(reach, decision.reach)),
        guard=ahead,
    )


def _free(decision: Decision, observation: Observation, headings: list[float]) -> list[float]:
    """Return the free distance along each heading, from the lines already cast where one serves."""
    known: dict[float, float] = {}
    for heading in headings:
        for line, length in zip(decision.lines, decision.lengths, strict=True):
            if abs(math.remainder(line - heading, math.tau)) <= SAME:
                known[heading] = length
    missing = [heading for heading in headings if heading not in known]
    if missing:
        known.update(zip(missing, observation.sense(missing), strict=True))
    return [known[heading] for heading in headings]


def _spread(start: float, end: float, spacing: float) -> list[float]:
    """Return turns (rad) from next to ``start`` up to ``end``, at most ``spacing`` apart.

    There are none if the two are so close that the corridor at ``start`` covers both. Of those
    wider than ``WIDEST`` only the last is returned.
    """
    if abs(end - start) <= NARROW:
        return []
    count = math.ceil(abs(end - start) / spacing)
    turns = [start + (end - start) * k / count for k in range(1, count)]
    return [*(turn for turn in turns if abs(turn) <= WIDEST), end]


def _spacing(motion: Motion, speed: float) -> float:
    """Return the widest angle (rad) between neighbouring corridors that leaves no gap.

    A disc of radius r drives a distance s, halfway between two corridors of half width R. It stays
    within them if its foremost point, s + r away, is within R of the end of either corridor. The
    law of cosines gives the angle.
    """
    fastest = min(motion.max_speed, max(0.0, speed) + motion.acceleration * motion.period)
    way = max(fastest * motion.period + motion.way_to_stop(fastest), motion.margin)
    front, wide = way + motion.radius, motion.radius + motion.margin
    cosine = (front**2 + way**2 - wide**2) / (2.0 * front * way)
    return 2.0 * math.acos(min(1.0, max(0.0, cosine)))
