"""What an importer is asked, and what it answers: a map of another program in plain terms."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, TypeAlias, cast, get_args

from pydantic import ValidationError

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.quantities import MAX_OBSTACLES, MIN_RADIUS
from fuzzyq_bullet.reading.untrusted import number as number_of
from fuzzyq_bullet.robots import RobotModel
from fuzzyq_bullet.scenario.places import Bounds
from fuzzyq_bullet.scenario.problems import problems_of
from fuzzyq_bullet.scenario.robot import URDF, Robot
from fuzzyq_bullet.wording import not_one_of, shorten

Unknown: TypeAlias = Literal["blocked", "free"]
Obstacle: TypeAlias = "dict[str, Any]"
"""An obstacle as a scenario file has it: ``{"shape": "box", "position": (x, y), ...}``."""

FAR = 1000.0
"""Greatest coordinate and side of an arena (m), as ``quantities`` allows them."""
THIN = 0.02
"""Whatever is thinner than this (m) is grown to it: the physics could step over it."""


@dataclass(frozen=True)
class ImportOptions:
    """What the user asks of an import; what is None, the map decides.

    Attributes:
        resolution: Size of a cell or pixel (m).
        start: Where the robot starts (m).
        heading: Where it faces there (rad).
        goal: Where it must stop (m).
        crop: The part of the map that is kept (m).
        unknown: What cells are that nobody has seen.
        number: The row of a file of tasks, counted from 1.
        robot: The robot's model: a name, or a URDF file.
        left_wheel: Joint of the left wheel in that URDF; by default it is found by its name.
        right_wheel: Likewise of the right wheel.
    """

    resolution: float | None = None
    start: tuple[float, float] | None = None
    heading: float | None = None
    goal: tuple[float, float] | None = None
    crop: Bounds | None = None
    unknown: Unknown = "blocked"
    number: int = 1
    robot: str | None = None
    left_wheel: str | None = None
    right_wheel: str | None = None

    def robot_keys(self) -> dict[str, str]:
        """Return what a scenario says of the robot that is asked for; a URDF's path is absolute."""
        model = self.robot
        if model is not None and model.endswith(URDF):
            model = str(Path(model).absolute())
        keys = {"model": model, "left_wheel": self.left_wheel, "right_wheel": self.right_wheel}
        return {key: value for key, value in keys.items() if value is not None}

    def robot_model(self) -> RobotModel:
        """Return the robot that is asked for, or the default one.

        Raises:
            UserError: If there is none of that name, or its URDF is wrong; it names the option.
        """
        keys = self.robot_keys()
        if self.robot is not None:
            keys["model"] = self.robot  # messages show it as it was given
        try:
            return Robot.model_validate(keys).spec
        except ValidationError as error:
            options = {"left_wheel": "--left-wheel", "right_wheel": "--right-wheel"}
            problems = problems_of(error, keys)
            lines = (f"{options.get(str(p.loc[-1]), '--robot')}: {p.message}" for p in problems)
            raise UserError(*lines) from error


def options_of(
    *,
    resolution: float | None = None,
    start: str | None = None,
    goal: str | None = None,
    crop: str | None = None,
    unknown: str = "blocked",
    number: int = 1,
    robot: str | None = None,
    left_wheel: str | None = None,
    right_wheel: str | None = None,
) -> ImportOptions:
    """Return the options that texts of a command line stand for: ``start="1,2.5"``.

    Raises:
        UserError: If one is wrong; it names the option.
    """
    if unknown not in get_args(Unknown):
        raise UserError(f"--unknown: {not_one_of('answer', unknown, get_args(Unknown))}")
    x, y, *heading = _numbers("--start", start, "X,Y or X,Y,HEADING", (2, 3), FAR) or (None, None)
    end = _numbers("--goal", goal, "X,Y", (2,), FAR)
    part = _numbers("--crop", crop, "X0,Y0,X1,Y1", (4,))
    if part and (part[0] >= part[2] or part[1] >= part[3]):
        raise UserError(f"--crop: {crop}: X0 must be less than X1, and Y0 less than Y1")
    return ImportOptions(
        resolution=resolution,
        start=None if x is None or y is None else (x, y),
        heading=heading[0] if heading else None,
        goal=(end[0], end[1]) if end else None,
        crop=Bounds(*part) if part else None,
        unknown=cast("Unknown", unknown),
        number=number,
        robot=robot,
        left_wheel=left_wheel,
        right_wheel=right_wheel,
    )


def _numbers(
    option: str, text: str | None, form: str, counts: tuple[int, ...], most: float = 1e6
) -> list[float] | None:
    if text is None:
        return None
    words = text.split(",")
    if len(words) not in counts:
        raise UserError(f"{option}: expected {form}, got {shorten(text)}")
    return [number_of(word, option, least=-most, most=most) for word in words]


@dataclass
class ForeignMap:
    """A map of another program, in metres and in its own coordinates.

    Attributes:
        bounds: Its edges (m).
        walls: Whether nothing leaves it: a map of cells ends at its edge.
        obstacles: What stands in it.
        start: Where its robot starts (m), if it says so.
        heading: Where that robot faces (rad).
        goal: Where that robot is to go (m).
        headroom: Up to which height (m) the obstacles are all that a robot can touch; None if
            they are so for every robot, or the map knows no heights.
        left_out: What the scenario has not: a line each, with the reason.
        changed: What the scenario has otherwise, a line each.
    """

    bounds: Bounds
    walls: bool
    obstacles: list[Obstacle] = field(default_factory=list)
    start: tuple[float, float] | None = None
    heading: float | None = None
    goal: tuple[float, float] | None = None
    headroom: float | None = None
    left_out: list[str] = field(default_factory=list)
    changed: list[str] = field(default_factory=list)


def beside(folder: Path, name: str, where: str) -> Path:
    """Return the path of a file that another one names; it lies in that one's folder or below.

    Args:
        folder: Folder of the file that names it.
        name: The name, relative to it.
        where: File, line and key of the name, for messages.

    Raises:
        UserError: If it lies elsewhere, or is not there.
    """
    try:
        path = folder / name
        inside = path.resolve().is_relative_to(folder.resolve())
        if inside and path.is_file():
            return path
    except (OSError, ValueError, RuntimeError):  # a name too long, a null character, a loop
        inside = True
    if not inside:
        raise UserError(
            f"{where}: {shorten(name)} lies outside the folder {folder}; only files in it are read"
        )
    raise UserError(f"{where}: there is no file {shorten(str(folder / name))}")


def too_many(path: Path, count: int) -> str:
    """Say that a map has more obstacles than a scenario may."""
    return (
        f"{path}: becomes {count} obstacles, and a scenario has at most {MAX_OBSTACLES}; "
        "take a part of it with --crop X0,Y0,X1,Y1"
    )


def rectangle(
    position: tuple[float, float], size: tuple[float, float], yaw: float
) -> tuple[Obstacle, bool]:
    """Return a rectangle as an obstacle, and whether it had to be grown because it was thin.

    Args:
        position: Its centre (m).
        size: Its sides along its own x and y (m).
        yaw: Its turn (rad).
    """
    length, width = (max(side, THIN) for side in size)
    grown = min(size) < THIN
    if min(length, width) >= 2 * MIN_RADIUS:
        yaw = math.remainder(yaw, math.tau)
        return {"shape": "box", "position": position, "size": (length, width), "yaw": yaw}, grown
    (x, y), cos, sin = position, math.cos(yaw), math.sin(yaw)
    half = [(length / 2 * a, width / 2 * b) for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
    points = [(x + cos * px - sin * py, y + sin * px + cos * py) for px, py in half]
    return {"shape": "polygon", "points": points}, grown
