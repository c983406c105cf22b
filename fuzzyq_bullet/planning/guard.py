"""The guard: no step is longer than what is free along the way that the robot will really take."""

from __future__ import annotations

import math

from fuzzyq_bullet.geometry import wrap_angle
from fuzzyq_bullet.planning.base import Motion, Observation
from fuzzyq_bullet.planning.decision import Decision

RESERVE = 0.02
"""Free distance that is never used up (m): by so much a detection line may be too long where a
corner stands between two of its rays."""
NARROW = math.radians(0.3)
"""Up to this a turn is none: one corridor covers where the robot faces and where it will."""
SAME = math.radians(0.3)
"""A line already cast serves for headings as near to it as this."""
WIDEST = math.radians(90.0)
"""Further round than this the robot does not get before it stands."""


def guarded(decision: Decision, observation: Observation) -> Decision:
    """Return the decision with its step, and if need be its turn, cut down to what is free.

    The paper's point robot faces the new heading at once: one corridor along it is enough.
    """
    if observation.motion is not None:
        return _guarded_on_wheels(decision, observation, observation.motion)
    [free] = observation.sense([decision.heading])
    return decision._replace(step=_usable(free, decision.step), guard=free)


def _guarded_on_wheels(decision: Decision, observation: Observation, motion: Motion) -> Decision:
    """Guard a robot that comes round to its new heading on an arc, and stops late.

    Seen from here, every point of that arc up to a stop lies between the direction the robot faces
    and the new heading, so a fan of corridors between the two covers it: the least of them is how
    far the robot may be able to go. Where the fan is shorter somewhere than the robot now needs to
    stop, it may not turn that far yet; it brakes first, and turns as it gets slower.
    """
    facing = observation.heading
    turn = wrap_angle(decision.heading - facing)
    # What the robot still turns of itself while it reverses its turn rate.
    coast = observation.turn_rate * abs(observation.turn_rate) / (2.0 * motion.turn_acceleration)
    start = max(0.0, min(coast, turn)) if turn >= 0.0 else min(0.0, max(coast, turn))
    spacing = _spacing(motion, observation.speed)
    if start == coast and NARROW < abs(turn) <= spacing:
        # The two cover all that it comes by.
        passed, wanted = [0.0], [turn]
    else:
        first = turn if abs(turn) <= NARROW else 0.0
        passed = [first, *_spread(0.0, coast, spacing)]
        wanted = _spread(start, turn, spacing)
    # The very heading of the decision, not a sum that rounds: it may have been sensed already.
    headings = [decision.heading if way == turn else facing + way for way in (*passed, *wanted)]
    free = _free(decision, observation, headings)

    reach = min(free[: len(passed)]) - RESERVE
    heading, ahead = facing + start if wanted else decision.heading, reach + RESERVE
    need = observation.speed * motion.period + motion.way_to_stop(observation.speed)
    later = slice(len(passed), None)
    for further, length in zip(headings[later], free[later], strict=True):
        if RESERVE < need > length - RESERVE:
            reach = 0.0
            break
        reach = min(reach, length - RESERVE)
        heading, ahead = further, length
    return decision._replace(
        heading=heading,
        step=_usable(ahead, decision.step),
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


def _usable(free: float, step: float) -> float:
    return max(0.0, min(step, free - RESERVE))


def _spread(start: float, end: float, spacing: float) -> list[float]:
    """Return ways (rad) from next to ``start`` up to ``end``, at most ``spacing`` apart.

    None where the two are so close that the corridor at ``start`` covers both. Ways further round
    than ``WIDEST`` are left out but for the last.
    """
    if abs(end - start) <= NARROW:
        return []
    count = math.ceil(abs(end - start) / spacing)
    ways = [start + (end - start) * k / count for k in range(1, count)]
    return [*(way for way in ways if abs(way) <= WIDEST), end]


def _spacing(motion: Motion, speed: float) -> float:
    """Return the widest angle (rad) between neighbouring corridors that leaves no gap.

    Halfway between two corridors of radius R, a disc of radius r at the end of its way s to a stop
    stays within them while the law of cosines puts its foremost point, s + r away, within R of
    the end of either.
    """
    fastest = min(motion.max_speed, max(0.0, speed) + motion.acceleration * motion.period)
    way = max(fastest * motion.period + motion.way_to_stop(fastest), motion.margin)
    front, wide = way + motion.radius, motion.radius + motion.margin
    cosine = (front**2 + way**2 - wide**2) / (2.0 * front * way)
    return 2.0 * math.acos(min(1.0, max(0.0, cosine)))
