"""The files of a run: what they are called, what they may replace, and what they may not."""

from __future__ import annotations

import hashlib
import os
import re
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.filming import ANIMATION_SIZE, EXPLAIN, USUAL_SIZE, VIEWS, Filming
from fuzzyq_bullet.planning.settings import PolicySettings
from fuzzyq_bullet.recording.trajectory import Trajectory
from fuzzyq_bullet.scenario import Scenario, find_scenario

_ASIDE = {"description", "expect"}
"""What makes a scenario no other run."""


def run_name(given: Scenario, asked: Scenario) -> str:
    """Return what the files of a run are called: ``mixed``, or ``mixed-improved-fuzzy-seed7``.

    What differs from the scenario's own settings is part of the name, so that runs to be compared
    lie side by side.

    Args:
        given: The scenario as its file says.
        asked: The same with the planner, drive and seed that were asked for.
    """
    parts = [given.name]
    if asked.planner.name != given.planner.name:
        parts.append(asked.planner.name)
    if asked.drive != given.drive:
        parts.append(asked.drive)
    if asked.seed != given.seed:
        parts.append(f"seed{asked.seed}")
    return "-".join(parts)


def film_name(
    name: str, film: Filming | None = None, form: str = "mp4", still: float | None = None
) -> str:
    """Return ``NAME.mp4``, or ``NAME-follow-1920x1080-4x.mp4``: no film replaces another kind.

    Args:
        name: What the run is called.
        film: How it is filmed; what differs from the usual film becomes part of the name.
        form: The format.
        still: The time (s) of the one picture that is made of it, if one is.
    """
    film = film or Filming()
    parts = [name]
    if film.view != EXPLAIN:
        parts.append(film.view)
    if film.size not in (None, USUAL_SIZE if form == "mp4" else ANIMATION_SIZE):
        parts.append("x".join(map(str, film.size)))
    if film.fps is not None:
        parts.append(f"{film.fps}fps")
    if f"{film.speed:g}" != "1":
        parts.append(f"{film.speed:g}x")
    if film.start is not None or film.end is not None:
        begin = "" if film.start is None else f"from{film.start:g}s"
        parts.append(begin + ("" if film.end is None else f"to{film.end:g}s"))
    if still is not None:
        parts.append(f"at{still:g}s")
        form = "png"
    return f"{'-'.join(parts)}.{form}"


_PARTS = (
    rf"(-({'|'.join(VIEWS[1:])}))?(-\d+x\d+)?(-\d+fps)?(-[0-9.]+x)?"
    r"(-(from[0-9.]+s)?(to[0-9.]+s)?)?(-at[0-9.]+s)?\.(mp4|gif|png)"
)


def films_of(folder: Path, name: str) -> list[Path]:
    """Return the films in a folder that ``film_name`` gives this name, however they were made."""
    films = re.compile(re.escape(name) + _PARTS)
    try:
        return sorted(path for path in folder.iterdir() if films.fullmatch(path.name))
    except OSError:  # a folder that may be written to, and not be looked into
        return []


def scenario_inputs(source: str | os.PathLike[str], scenario: Scenario) -> list[Path]:
    """Return the files that a scenario is read from: its own, and the policy it names."""
    planner = scenario.planner
    policy = planner.policy if isinstance(planner, PolicySettings) else None
    return [find_scenario(source), *([Path(policy)] if policy is not None else [])]


def plugin_inputs(plugins: Sequence[str]) -> list[Path]:
    """Return the files that loaded plugins were read from."""
    modules = [getattr(sys.modules.get(name), "__file__", None) for name in plugins]
    files = [name for name in plugins if name.endswith(".py")]
    return [Path(str(file)) for file in (*modules, *files) if file]


def plugin_settings(plugins: Sequence[str]) -> dict[str, dict[str, str]]:
    """Return what a sweep's settings say of plugins: each file, by its name, as a hash.

    So rows of a planner that was changed since are not taken for its own; nothing without plugins.
    """
    hashes = {
        path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in plugin_inputs(plugins)
    }
    return {"plugins": hashes} if hashes else {}


def refuse_other_run(record: Path, others: Iterable[Path], scenario: Scenario) -> None:
    """Make sure that what is there was written by the same run, which may be done again.

    Args:
        record: The record that is to be written.
        others: The films and the result beside it.
        scenario: What is to be run, every obstacle listed.

    Raises:
        UserError: If a file there is of another run, or nothing tells of which.
    """
    there = [path for path in (record, *others) if os.path.lexists(path)]
    if not there:
        return
    try:
        before = Trajectory.load(record).scenario
    except UserError as error:
        raise UserError(
            f"{there[0]}: is there already, and no record tells of which run; "
            "--replace replaces it, another --out keeps it"
        ) from error
    differs = _differences(before, scenario)
    if differs:
        raise UserError(
            f"{record}: is of another run ({', '.join(differs)} differs); "
            "--replace replaces it, another --out keeps it"
        )


def refuse_others_file(path: Path, mark: str) -> None:
    """Make sure that a file that is there was made by the command that is to make it again.

    Args:
        path: The file that is to be written.
        mark: What stands near the beginning of all that the command writes.

    Raises:
        UserError: If it was not.
    """
    if not os.path.lexists(path):
        return
    head = b""
    if path.is_file():  # nor anything that would keep a reader waiting
        with path.open("rb") as file:
            head = file.read(_HEAD)
    if mark.encode() not in head:
        raise UserError(
            f"{path}: is there already, and not made by {mark}; "
            "--replace replaces it, another --out keeps it"
        )


_HEAD = 4096
"""Bytes of a file within which a mark is looked for."""


def _differences(before: Scenario, now: Scenario) -> list[str]:
    old, new = (one.model_dump(exclude=_ASIDE) for one in (before, now))
    return [key for key in new if old[key] != new[key]]
