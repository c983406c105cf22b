"""What is allowed and yet hardly meant: told before a run, and no verdict."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from fuzzyq_bullet.fuzzy import ControllerDefinition
from fuzzyq_bullet.fuzzy.definition_checks import gaps_of
from fuzzyq_bullet.quantities import ANGLE_KEYS
from fuzzyq_bullet.reading.problems import Loc, Problem, key_path
from fuzzyq_bullet.recording.metrics import has_way
from fuzzyq_bullet.scenario import Scenario
from fuzzyq_bullet.scenario.files import problem_lines
from fuzzyq_bullet.scenario.motion_warnings import doubtful_motions
from fuzzyq_bullet.shapes.outlines import FINEST

NO_WAY = "there is no way from the start to the goal for the robot, wherever it drives"


def early_warnings(file: str, given: Scenario, realised: Scenario) -> list[str]:
    """Return one line for each thing that is probably a mistake, ``FILE:LINE: KEY: ...``.

    They are: no way to the goal at all, although it is expected to be reached; a limit of time, of
    decisions or an expectation that the robot could not keep on a straight line at full speed; an
    angle that looks like degrees; rules with an input that belongs to none of its sets; settings of
    the planner that are of no effect, or need a package that is not installed; a polygon
    with a tip so sharp, or a part so thin, that the detection lines may see it too late; an
    obstacle that moves through what stands, out of the arena, or into the robot at the start.

    Args:
        file: The scenario file.
        given: What it says.
        realised: The same with every obstacle listed.
    """
    found = [*_degrees(given), *_too_short(given), *_gaps(given), *_too_thin(given)]
    found += [Problem(("planner", key), why) for key, why in given.planner.doubts()]
    if given.expect.outcome == "goal" and not has_way(realised):
        found.append(Problem(("goal",), NO_WAY))
    doubtful = doubtful_motions(realised, len(given.obstacles))
    found += [Problem(loc, why) for loc, why in doubtful]
    return problem_lines(file, found)


def _too_thin(scenario: Scenario) -> Iterator[Problem]:
    thin = [i for i, one in enumerate(scenario.obstacles) if one.thickness() < FINEST]
    if thin:
        others = f"; so have {len(thin) - 1} others" if len(thin) > 1 else ""
        yield Problem(
            ("obstacles", thin[0]),
            f"has a sharp tip, or a part thinner than {FINEST:g} m: the detection lines may see it "
            f"too late{others}",
        )


def _gaps(scenario: Scenario) -> Iterator[Problem]:
    rules = getattr(scenario.planner, "rules", None)
    if isinstance(rules, ControllerDefinition):
        for loc, why in gaps_of(rules):
            yield Problem(("planner", "rules"), f"{key_path(loc)}: {why}")


def _degrees(scenario: Scenario) -> Iterator[Problem]:
    data = scenario.model_dump(include={"start", "goal", "obstacles", "random"})
    for loc, value in _numbers(data, ()):
        if loc[-1] in ANGLE_KEYS and abs(value) > math.tau:
            turned = math.radians(value)
            yield Problem(
                loc, f"{value:g} rad looks like degrees; did you mean {round(turned, 2):g}?"
            )


def _numbers(data: Any, loc: Loc) -> Iterator[tuple[Loc, float]]:
    if isinstance(data, dict):
        for key, value in data.items():
            yield from _numbers(value, (*loc, key))
    elif isinstance(data, list | tuple):
        for i, value in enumerate(data):
            yield from _numbers(value, (*loc, i))
    elif isinstance(data, int | float):
        yield loc, data


def _too_short(scenario: Scenario) -> Iterator[Problem]:
    if scenario.drive != "wheels" or scenario.expect.outcome != "goal":
        return  # the point robot has no speed
    speed = scenario.robot.max_speed
    at, way = scenario.start.position, 0.0
    for i, target in enumerate(scenario.targets):  # from centre to centre, less what discs save
        slack = target.radius * (1 if i == len(scenario.via) else 2)
        way, at = way + math.dist(at, target.position) - slack, target.position
    least, past = way / speed, " past the via points" if scenario.via else ""
    for loc, limit in (
        (("limits", "time"), scenario.limits.time),
        (("expect", "max_time"), scenario.expect.max_time),
    ):
        if limit is not None and limit < least:
            yield Problem(
                loc,
                f"{limit:g} s is too short: the straight line of {way:.1f} m to the goal{past} "
                f"takes {least:.1f} s at {speed:g} m/s",
            )
