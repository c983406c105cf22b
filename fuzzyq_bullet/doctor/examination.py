"""All examinations of a scenario, one after the other."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from fuzzyq_bullet.doctor.finding import Finding
from fuzzyq_bullet.doctor.luck import examine_luck
from fuzzyq_bullet.doctor.sight import examine_sight
from fuzzyq_bullet.doctor.touch import examine_touch
from fuzzyq_bullet.physics.inspection import Inspection
from fuzzyq_bullet.reading.problems import Loc
from fuzzyq_bullet.recording.metrics import has_way
from fuzzyq_bullet.scenario import Scenario, realise
from fuzzyq_bullet.scenario.places import Goal, Start

_POSES = 72


def examine(given: Scenario) -> list[Finding]:
    """Return what is wrong with a scenario that is valid, and what is worth a note.

    Raises:
        UserError: If its obstacles cannot be placed.
    """
    scenario = realise(given)
    listed = len(given.obstacles)
    alone = list(examine_sight(scenario, listed))
    told = {one.loc for one in alone if one.wrong}
    return [
        *alone,
        *(one for one in examine_touch(scenario, listed) if one.loc not in told),
        *examine_turn(scenario),
        *examine_reach(scenario),
        *examine_luck(scenario, listed),
    ]


def examine_turn(scenario: Scenario) -> Iterator[Finding]:
    """Yield a finding if the body touches something while it turns once round in the start."""
    x, y = scenario.start.position
    with Inspection(scenario.obstacles, scenario.arena, model=scenario.robot.spec) as world:
        first = scenario.start_heading()
        headings = first + np.linspace(0.0, math.tau, _POSES, endpoint=False)
        gaps = [world.gap(x, y, heading) for heading in headings.tolist()]
    if min(gaps) <= 0.0:
        turned = math.degrees(
            next(k for k, gap in enumerate(gaps) if gap <= 0.0) * math.tau / _POSES
        )
        yield Finding(
            "turn",
            ("start", "position"),
            f"the robot cannot turn round here: its body touches something {turned:.0f}° to the "
            "left of its first heading",
        )


def examine_reach(scenario: Scenario) -> Iterator[Finding]:
    """Yield the first via point, or the goal, that no way leads to."""
    at = scenario.start.position
    for i, target in enumerate(scenario.targets):
        last = i == len(scenario.via)
        leg = scenario.model_copy(
            update={
                "start": Start(position=at),
                "via": (),
                "goal": Goal(position=target.position, radius=target.radius),
            }
        )
        way = has_way(leg)
        loc: Loc = ("goal",) if last else ("via", i)
        if way is None:
            yield Finding("limit", loc, "reach: too many obstacles to look at", wrong=False)
            return
        if not way:
            begin = f"via[{i - 1}]" if i else "the start"
            yield Finding("reach", loc, f"there is no way for the robot to it from {begin}")
            return
        at = target.position
