"""From what a user names (files, folders, globs, bundled names) to jobs, one for each seed."""

from __future__ import annotations

import glob
import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from fuzzyq_bullet.checks.run_job import Source
from fuzzyq_bullet.checks.verdict import Job, Keep
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.outputs import run_name, scenario_inputs
from fuzzyq_bullet.scenario import find_scenario, load_scenario, with_options
from fuzzyq_bullet.scenario.options import MAX_SEED, check_options

ENDINGS = (".yaml", ".yml")


@dataclass
class DiscoveredFiles:
    """What was found where a user looked.

    Attributes:
        files: Scenario files, each once, in the order asked for; those of a folder sorted.
        problems: One line for everything that could not be read or holds no scenario.
    """

    files: list[Path] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)


def discover(paths: Sequence[str]) -> DiscoveredFiles:
    """Look for scenario files; what is wrong with one path does not hide the others.

    Args:
        paths: Files, folders (searched with all below, hidden ones left out), globs such as
            ``fields/**/*.yaml``, or names of bundled scenarios.
    """
    found = DiscoveredFiles()
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


@dataclass(frozen=True)
class Plan:
    """How scenarios are to be run.

    Attributes:
        planner: Planner to use instead of their own.
        seed: First seed, instead of their own.
        drive: Drive to use instead of their own.
        repeat: How many seeds, one after the other.
        keep: Of which runs the trajectory is kept.
        folder: Where; it must outlive the jobs.
    """

    planner: str | None = None
    seed: int | None = None
    drive: str | None = None
    repeat: int = 1
    keep: Keep = "none"
    folder: Path | None = None


@dataclass
class Jobs:
    """What is to be done, and a line for everything that cannot be."""

    jobs: list[Job] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)
    inputs: list[Path] = field(default_factory=list)
    """All files that the jobs read."""
    names: list[str] = field(default_factory=list)
    """The scenarios' names; each has as many jobs as it is repeated, one after the other."""


def planned(files: Sequence[Path], plan: Plan) -> Jobs:
    """Return the jobs; a file that is wrong does not keep the others from being run.

    Raises:
        UserError: If an option is wrong for all of them.
    """
    _check_options(plan)
    all_of = Jobs()
    names: dict[str, Path] = {}
    for file in files:
        _add(file, plan, names, all_of)
    return all_of


def _add(file: Path, plan: Plan, names: dict[str, Path], all_of: Jobs) -> None:
    try:
        scenario = load_scenario(file, policies=plan.planner is None)
        first = scenario.seed if plan.seed is None else plan.seed
        if first + plan.repeat - 1 > MAX_SEED:
            raise UserError(f"{file}: seed: {first} and {plan.repeat - 1} more are too many")
        try:
            asked = with_options(
                scenario,
                planner=plan.planner,
                drive=plan.drive,
                seed=plan.seed if plan.repeat == 1 else None,
            )
        except UserError as error:
            raise UserError(*(f"{file}: --{problem}" for problem in error.problems)) from error
        if scenario.name in names:
            line = Source(str(file)).line_of("name")
            raise UserError(
                f"{file}:{line}: name: {scenario.name} is the name of {names[scenario.name]} too; "
                "give each its own"
            )
    except UserError as error:
        all_of.problems += error.problems
        return
    names[scenario.name] = file
    all_of.names.append(scenario.name)
    all_of.inputs += scenario_inputs(file, asked)
    for i in range(plan.repeat):
        ending = f"-seed-{first + i}" if plan.repeat > 1 else ""
        name = scenario.name + ending
        kept = f"{run_name(scenario, asked)}{ending}.npz"
        record = None if plan.folder is None else str(plan.folder / kept)
        own = plan.seed is None and plan.repeat == 1
        all_of.jobs.append(
            Job(
                file=str(file),
                name=name,
                planner=plan.planner,
                seed=None if own else first + i,
                drive=plan.drive,
                record=record,
                keep=plan.keep,
            )
        )


def _check_options(plan: Plan) -> None:
    try:
        check_options(planner=plan.planner, seed=plan.seed, drive=plan.drive)
    except UserError as error:
        raise UserError(*(f"--{problem}" for problem in error.problems)) from error
