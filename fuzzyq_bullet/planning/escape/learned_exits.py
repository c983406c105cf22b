"""What the ways out of one field are worth, to a robot that has crossed it before.

With t(s, g) the time that the known way from where the robot is, s, to a temporary goal g takes at
full speed, and T the learned time from there to the goal,

    Q(s, g) = −t(s, g) − T(place of g)

so ∂Q/∂T = −1: what Eq. 19 asks for, in a table of places. Where T was never learned, the planner's
own guess stands in: the way on as if there were nothing that was not seen. It is seldom too long,
so what is unknown looks good, and is tried.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import NamedTuple, TypeAlias

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.learning import Policy
from fuzzyq_bullet.planning.base import USUAL_SPEED
from fuzzyq_bullet.planning.escape.exploration import ENCLOSED, WaysOut
from fuzzyq_bullet.reading.untrusted import shown

Place: TypeAlias = tuple[int, int]
"""Column and row of a square cell of the world."""

LEARNER = "exits"
"""What a policy that holds these says it was learned by."""
CELL = 2.5
"""Side of a place, in S_p."""
ELSEWHERE = "elsewhere"
"""The first row of such a policy: of all places that were never tried nothing is known."""
SECONDS = "seconds to the goal"
_PLACE = re.compile(r"(0|-?[1-9][0-9]{0,6}) (0|-?[1-9][0-9]{0,6})", re.ASCII)


class Choice(NamedTuple):
    """A temporary goal that was chosen.

    Attributes:
        time: When (s).
        place: Where it lies.
        seconds: −Q: the time to the goal over it, as it seemed (s).
        beyond: The part of that from the temporary goal on (s).
    """

    time: float
    place: Place
    seconds: float
    beyond: float


class LearnedExits:
    """Judges ways out by what was learned, and remembers what was chosen (one episode).

    Args:
        seconds: T, the time to the goal (s) from each place that was tried.

    Attributes:
        choices: What was chosen so far, in turn.
    """

    def __init__(self, seconds: Mapping[Place, float]) -> None:
        self._seconds = seconds
        self.choices: list[Choice] = []

    def judge(self, out: WaysOut) -> list[float]:
        """Return what the way to the goal over each temporary goal takes (s): −Q."""
        observation = out.observation
        speed = USUAL_SPEED if observation.motion is None else observation.motion.max_speed
        guesses = out.guess()
        side = CELL * observation.unit
        places = [(math.floor(x / side), math.floor(y / side)) for x, y in out.points]
        beyond = [
            # What is walled in by all that was seen stays so, whatever the rest of its place is.
            guessed / speed if guessed >= ENCLOSED else self._seconds.get(place, guessed / speed)
            for place, guessed in zip(places, guesses, strict=True)
        ]
        costs = [way / speed + on for way, on in zip(out.ways, beyond, strict=True)]
        best = min(range(len(costs)), key=costs.__getitem__)
        self.choices.append(Choice(observation.time, places[best], costs[best], beyond[best]))
        return costs


def names_of(seconds: Mapping[Place, float]) -> tuple[str, ...]:
    """Return what the rows of a policy mean, in the order of ``rows_of``."""
    return (ELSEWHERE, *(f"{column} {row}" for column, row in sorted(seconds)))


def rows_of(seconds: Mapping[Place, float]) -> tuple[tuple[float], ...]:
    """Return the rows of a policy: the time (s) from each place; 0 for what was never tried."""
    return ((0.0,), *((seconds[place],) for place in sorted(seconds)))


def seconds_of(policy: Policy, where: str) -> dict[Place, float]:
    """Return what a policy says of each place.

    Args:
        policy: The policy.
        where: What to call it in the message, usually its path.

    Raises:
        UserError: If its rows are no places, or its columns no times.
    """
    if policy.actions != (SECONDS,) or policy.states[0] != ELSEWHERE:
        raise UserError(
            f"{where}: states begin with {shown(policy.states[0])}, actions with "
            f"{shown(policy.actions[0])}; a field has {ELSEWHERE!r} and {SECONDS!r} alone"
        )
    seconds = {}
    for name, (value,) in zip(policy.states[1:], policy.table[1:], strict=True):
        if not _PLACE.fullmatch(name):
            raise UserError(
                f"{where}: states: {shown(name)} is no place; one is a column and a row, as in "
                "'3 -1'"
            )
        column, row = map(int, name.split())
        if value < 0.0:
            raise UserError(f"{where}: table: {shown(name)}: no time is less than 0, got {value:g}")
        seconds[column, row] = value
    return seconds
