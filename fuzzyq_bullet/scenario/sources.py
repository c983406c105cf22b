"""Where a scenario lies that is given by path or name, and what only looks like one."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TypeAlias

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.platforms import data_folder
from fuzzyq_bullet.wording import did_you_mean, shorten

Source: TypeAlias = "str | os.PathLike[str]"

_SUFFIXES = {
    ".world": "a Gazebo world",
    ".sdf": "a Gazebo world",
    ".map": "a MovingAI map",
    ".scen": "a MovingAI task",
    **dict.fromkeys((".png", ".pgm", ".bmp"), "a picture of a map"),
}
"""What files are that ``fuzzyq import`` reads, by suffix."""
_KEYS = {"a ROS map": ("image", "resolution"), "a world of ir-sim": ("world", "robot|obstacle")}
"""Keys of other programs' YAML files that no scenario has together."""


def bundled_paths() -> dict[str, Path]:
    """Return the file of each bundled scenario, by name, in alphabetical order."""
    return {path.stem: path for path in sorted(data_folder("scenarios").glob("*.yaml"))}


def find_scenario(source: Source) -> Path:
    """Return the path of a scenario given as a path or as the name of a bundled one.

    Raises:
        UserError: If there is neither, or the path is not that of a regular file.
    """
    path = Path(source)
    try:
        if path.is_file():
            return path
        bundled = bundled_paths()
        if str(source) in bundled:
            return bundled[str(source)]
        if path.is_dir():
            raise UserError(f"{path}: is a folder; give a scenario file")
        if path.exists():
            raise UserError(f"{path}: is not a regular file; give a scenario file")
        is_path = bool(path.suffix) or len(path.parts) > 1
        beside = [one.name for one in path.parent.glob("*.y*ml")] if is_path else []
    except (OSError, ValueError) as error:  # no access, a name too long, a null byte
        reason = getattr(error, "strerror", None) or error
        raise UserError(f"{shorten(str(source))}: cannot be read: {reason}") from error
    if not is_path:
        hint = did_you_mean(source, bundled)
        raise UserError(
            f"{path}: there is no such file and no bundled scenario of that name; "
            f"{hint}fuzzyq list names them"
        )
    if path.stem in bundled:
        raise UserError(f"{path}: there is no such file; {path.stem} alone is the bundled scenario")
    hint = did_you_mean(path.name, sorted(beside)).strip()
    raise UserError(f"{path}: there is no such file" + (f"; {hint}" if hint else ""))


def refuse_suffix(path: Path) -> None:
    """Make sure that a file is not one of another program, by its suffix.

    Raises:
        UserError: If it is, with the command that makes a scenario of it.
    """
    if (what := _SUFFIXES.get(path.suffix.lower())) is not None:
        raise UserError(_imported(str(path), what))


def refuse_keys(text: str, where: str) -> None:
    """Make sure that YAML text is not that of another program, by its keys.

    Raises:
        UserError: If it is, with the command that makes a scenario of it.
    """
    for what, keys in _KEYS.items():
        if all(re.search(rf"^({key})\s*:", text, re.MULTILINE) for key in keys):
            raise UserError(_imported(where, what))


def _imported(where: str, what: str) -> str:
    return f"{where}: looks like {what}: fuzzyq import {where} makes a scenario of it"
