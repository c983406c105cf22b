"""From what a user names (files, folders, globs, bundled names) to scenario files."""

from __future__ import annotations

import glob
import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.scenario import find_scenario

ENDINGS = (".yaml", ".yml")


@dataclass
class Found:
    """What was found.

    Attributes:
        files: Scenario files, each once, in the order asked for; those of a folder sorted.
        problems: One line for everything that could not be read or holds no scenario.
    """

    files: list[Path] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)


def find(paths: Sequence[str]) -> Found:
    """Look for scenario files; what is wrong with one path does not hide the others.

    Args:
        paths: Files, folders (searched with all below, hidden ones left out), globs such as
            ``fields/**/*.yaml``, or names of bundled scenarios.
    """
    found = Found()
    seen: set[str] = set()
    for path in paths:
        before = len(found.problems)
        files = _files_of(path, found.problems)
        if not files and len(found.problems) == before:
            found.problems.append(f"{path}: no scenario here; looked for *.yaml and *.yml")
        for file in files:
            real = os.path.realpath(file)
            if real not in seen:
                seen.add(real)
                found.files.append(file)
    return found


def _files_of(path: str, problems: list[str]) -> list[Path]:
    try:
        if not path:  # else it would become ".", as an unset variable in a script does
            raise UserError("an empty path; give a file, a folder, a glob or a bundled name")
        if Path(path).is_dir():
            return sorted(_below(Path(path), problems))
        if glob.has_magic(path) and not Path(path).exists():
            # Path.glob refuses patterns that begin at the root.
            matches = sorted(glob.glob(path, recursive=True))  # noqa: PTH207
            return list(_sound((Path(one) for one in matches if one.endswith(ENDINGS)), problems))
        refuse_dead_link(Path(path))
        return [find_scenario(path)]
    except UserError as error:
        problems += error.problems
    except (OSError, ValueError) as error:  # no access, a null character
        problems.append(f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}")
    return []


def _below(folder: Path, problems: list[str]) -> Iterator[Path]:
    def note(error: OSError) -> None:
        problems.append(f"{error.filename}: cannot be read: {error.strerror}")

    seen = set()
    for place, folders, files in os.walk(folder, onerror=note, followlinks=True):
        real = os.path.realpath(place)
        folders[:] = [name for name in folders if not name.startswith(".") and real not in seen]
        if real in seen:  # a link that leads back
            continue
        seen.add(real)
        named = [name for name in files if name.endswith(ENDINGS) and not name.startswith(".")]
        yield from _sound((Path(place, name) for name in named), problems)


def _sound(files: Iterable[Path], problems: list[str]) -> Iterator[Path]:
    """Yield files, but for folders; a dead link or a pipe is a problem."""
    for file in files:
        if not file.is_dir() and _is_sound(file, problems):
            yield file


def _is_sound(file: Path, problems: list[str]) -> bool:
    try:
        refuse_dead_link(file)
        find_scenario(file)
    except UserError as error:
        problems += error.problems
        return False
    return True


def refuse_dead_link(path: Path) -> None:
    """Say so if a link leads nowhere, rather than that there is no such file.

    Raises:
        UserError: If it does.
    """
    if path.is_symlink() and not path.exists():
        raise UserError(f"{path}: cannot be read: a link to {path.readlink()}, which is not there")
