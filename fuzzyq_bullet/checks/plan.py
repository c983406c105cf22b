"""From scenario files to jobs: each file read, its name its own, a job for each seed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from fuzzyq_bullet.checks.explain import Source
from fuzzyq_bullet.checks.verdict import Job, Keep
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.outputs import run_name, scenario_inputs
from fuzzyq_bullet.scenario import load_scenario, with_options
from fuzzyq_bullet.scenario.options import MAX_SEED, check_options


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
    all_of.inputs += scenario_inputs(file, asked)
    for i in range(plan.repeat):
        ending = f"-seed-{first + i}" if plan.repeat > 1 else ""
        name = scenario.name + ending
        kept = f"{run_name(scenario, asked)}{ending}.npz"
        record = None if plan.folder is None else str(plan.folder / kept)
        own = plan.seed is None and i == 0
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
