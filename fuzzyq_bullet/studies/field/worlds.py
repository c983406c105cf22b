"""The worlds of a folder for ``bench field --worlds``: scenario files, and maps of other programs.

A file that cannot be read is a problem of its own; the others are used.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.reading.untrusted import number
from fuzzyq_bullet.scenario import Goal, Scenario
from fuzzyq_bullet.scenario.importers import ImportOptions, import_map, importable, options_of
from fuzzyq_bullet.studies.field.plan import BOUND, World
from fuzzyq_bullet.studies.options import outfit_with

_PICTURES = (".png", ".pgm", ".bmp")
"""Pictures belong to ROS maps; a picture alone has no size."""
_UNUSED = {"planner", "drive", "expect", "description"}
"""Keys of a scenario that the study sets itself or ignores."""


@dataclass(frozen=True)
class WorldOptions:
    """The options that count for all worlds of a folder.

    Attributes:
        folder: The folder.
        start: Where to start, instead of a world's own place: ``X,Y`` or ``X,Y,HEADING``.
        goal: Where to go, instead of a world's own goal: ``X,Y`` or ``X,Y,RADIUS``.
        robot: Model of the robot, instead of a world's own.
        max_speed: Its greatest speed (m/s), instead of its own.
        sight: How far it sees (m), instead of what a world says.
    """

    folder: Path
    start: str | None = None
    goal: str | None = None
    robot: str | None = None
    max_speed: float | None = None
    sight: float | None = None


@dataclass
class WorldFolder:
    """The worlds of a folder.

    Attributes:
        worlds: Its worlds by name, in the order of their files.
        contents: The same worlds in full, as JSON.
        problems: A line for every mistake in a file that could not be read.
        notes: Number of worlds of which the import left out, or changed, each kind of thing.
    """

    worlds: dict[str, World] = field(default_factory=dict)
    contents: dict[str, str] = field(default_factory=dict)
    problems: list[str] = field(default_factory=list)
    notes: dict[str, int] = field(default_factory=dict)


def worlds_in(asked: WorldOptions) -> WorldFolder:
    """Read all worlds of a folder, sorted by the names of their files.

    Raises:
        UserError: If an option is wrong, there is no such folder, or no world in it can be read.
    """
    options, radius = _options(asked)
    options.robot_model()  # or every world would complain
    found = WorldFolder()
    files: dict[str, Path] = {}
    for path in _files(asked.folder):
        try:
            imported = import_map(path, options)
            name = imported.scenario.name
            if name in files or name == BOUND:
                other = files.get(name, "the bound")
                raise UserError(f"{path}: name: {name} is the name of {other} too")
        except UserError as error:
            found.problems += (_placed(line, path) for line in error.problems)
            continue
        world = _equipped(imported.scenario, asked, radius)
        files[name] = path
        for line in imported.notes():
            what = line.rpartition(": ")[0]
            found.notes[what] = found.notes.get(what, 0) + 1
        text = world.model_dump_json(exclude=_UNUSED)
        digest = hashlib.sha256(text.encode()).hexdigest()
        found.worlds[name] = World(sha256=digest, seed=world.seed, goal_radius=world.goal.radius)
        found.contents[name] = text
    if not found.worlds:
        raise UserError(*found.problems)
    return found


def _placed(line: str, path: Path) -> str:
    """Return a mistake with its file: not every importer names it."""
    return line if line.startswith(str(path)) else f"{path}: {line}"


def _options(asked: WorldOptions) -> tuple[ImportOptions, float | None]:
    """Return the options of an import, and the radius of the goal (m), if it is given."""
    goal, radius = asked.goal, None
    if goal is not None and goal.count(",") == 2:
        goal, _, last = goal.rpartition(",")
        least, most = 0.05, 10.0  # of ``scenario.Goal``
        radius = number(last, "--goal: RADIUS", least=least, most=most)
    return options_of(start=asked.start, goal=goal, robot=asked.robot), radius


def _files(folder: Path) -> Iterable[Path]:
    """Return the files of a folder that may be worlds, sorted.

    Raises:
        UserError: If there are none, or the folder cannot be read.
    """
    try:
        every = sorted(path for path in folder.iterdir() if not path.name.startswith("."))
    except OSError as error:
        why = error.strerror or error
        raise UserError(f"--worlds: {folder}: cannot be read: {why}; give a folder") from error
    known = [one for one in importable() if one not in _PICTURES]
    files = [path for path in every if path.suffix.lower() in known and not path.is_dir()]
    names = {path.name for path in files}
    files = [path for path in files if f"{path.name}.scen" not in names]  # it is the task's map
    if not files:
        raise UserError(f"--worlds: {folder}: no world here; looked for {', '.join(known)}")
    return files


def _equipped(world: Scenario, asked: WorldOptions, radius: float | None) -> Scenario:
    """Return a world with the goal and the robot that are asked for.

    Raises:
        UserError: If its robot cannot be so; it names the option.
    """
    changes: dict[str, Any] = {}
    if radius is not None:
        changes["goal"] = Goal.model_validate({**world.goal.model_dump(), "radius": radius})
    # The robot's model is there already: the import has seen to it.
    outfit = outfit_with(None, asked.max_speed, asked.sight or world.sensor_range, world)
    if asked.max_speed is not None:
        changes["robot"] = outfit.on(world).robot
    if asked.sight is not None:
        told = {**world.sensor.model_dump(), "range": asked.sight}
        changes["sensor"] = type(world.sensor).model_validate(told)
    return world.model_copy(update=changes)
