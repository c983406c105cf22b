"""What keeps an imported map from being driven, in the words of the command's options."""

from __future__ import annotations

from pathlib import Path

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.geometry import WALL, Field
from fuzzyq_bullet.quantities import TOUCH, Point
from fuzzyq_bullet.reading.problems import Loc, first_lines, key_path
from fuzzyq_bullet.scenario.checks import find_conflicts
from fuzzyq_bullet.scenario.importers.foreign import ImportOptions
from fuzzyq_bullet.scenario.importers.room import Room
from fuzzyq_bullet.scenario.models import Scenario

_OPTIONS: dict[Loc, str] = {("start",): "start", ("goal",): "goal", ("arena", "headroom"): "robot"}
"""Which option decides a key of the scenario, if it is given."""


def refuse_places(
    path: Path,
    scenario: Scenario,
    options: ImportOptions,
    places: tuple[Point | None, Point | None],
) -> None:
    """Make sure that the robot can be at the start and at the goal.

    Args:
        path: The map.
        scenario: What has become of it; its own start and goal do not matter.
        options: What is asked for.
        places: Start and goal (m), where they are known.

    Raises:
        UserError: If it cannot; one line for each of the two that is wrong.
    """
    lines = []
    for name, place in zip(("start", "goal"), places, strict=True):
        why = None if place is None else _why_not(scenario, options, place)
        if place is None or why is None:
            continue
        whose = _place_of(path, (name, "position"), options)
        room = Room(scenario).nearest(place)
        remedy = "" if room is None else f"; there is room at --{name} {room[0]:g},{room[1]:g}"
        lines.append(f"{whose}: ({place[0]:g}, {place[1]:g}) {why}{remedy}")
    if lines:
        raise UserError(*lines)


def _why_not(scenario: Scenario, options: ImportOptions, place: Point) -> str | None:
    """Return why the robot cannot be at a place; None if it can."""
    bounds, radius = scenario.arena.bounds, scenario.robot.radius
    if not bounds.holds(*place):
        return f"is outside {'the map' if options.crop is None else '--crop'}, {bounds}"
    field = Field.of(scenario.standing, scenario.arena)
    nearest, gap = field.nearest(place)
    if gap > radius + TOUCH:
        return None
    what = "the edge of the map"
    if nearest != WALL:
        one = scenario.standing[nearest]
        what = f"an obstacle, the {one.shape} at ({one.position[0]:.2f}, {one.position[1]:.2f})"
    if gap <= TOUCH:
        return f"is inside {what}"
    return f"is {gap:.2g} m from {what}; the robot needs more than {radius:g} m"


def refuse_conflicts(path: Path, scenario: Scenario, options: ImportOptions) -> None:
    """Make sure that the scenario of a map can be run.

    Raises:
        UserError: If it cannot; one line for each reason, with the option that led to it.
    """
    conflicts = find_conflicts(scenario)
    if conflicts:
        lines = [f"{_place_of(path, loc, options)}: {why}" for loc, why in conflicts]
        raise UserError(*first_lines(lines, str(path)))


def _place_of(path: Path, loc: Loc, options: ImportOptions) -> str:
    """Return the option that decides a key of the scenario, or the map and the key."""
    option = next((name for keys, name in _OPTIONS.items() if loc[: len(keys)] == keys), None)
    if option is not None and getattr(options, option) is not None:
        return f"--{option}"
    return f"{path}: {key_path(loc)}"


def no_places(path: Path, room: Room, start: Point | None, goal: Point | None) -> UserError:
    """Return the error of a map without a start, a goal or both; it names two that would do.

    Args:
        path: The map.
        room: Where in it there is room.
        start: Where the robot starts (m), if anybody says so.
        goal: Where it is to go (m), if anybody says so.
    """
    lacking = " and ".join(
        name for name, given in (("start", start), ("goal", goal)) if given is None
    )
    options = " ".join(f"--{name} X,Y" for name in lacking.split(" and "))
    places = room.apart(start or goal)
    if places is None:
        return UserError(
            f"{path}: has no {lacking}; give {options}, but nowhere is there room for two "
            f"places that the robot, {room.radius:g} m in radius, can go between"
        )
    (x0, y0), (x1, y1), way = places
    if start is None and goal is None:
        example = f"--start {x0:g},{y0:g} --goal {x1:g},{y1:g}"
    else:
        example = f"--{lacking} {x1:g},{y1:g}"
    return UserError(
        f"{path}: has no {lacking}; give {options}. There is room for example with {example} "
        f"({way:.3g} m to drive)"
    )
