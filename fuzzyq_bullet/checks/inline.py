"""A scenario run within a test that somebody wrote by hand."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fuzzyq_bullet.checks.run_job import judge
from fuzzyq_bullet.checks.text import explanation, replay_command
from fuzzyq_bullet.checks.verdict import Job, Verdict
from fuzzyq_bullet.episode import run
from fuzzyq_bullet.metrics import Result, result_of
from fuzzyq_bullet.planning.registry import settings_for
from fuzzyq_bullet.scenario import find_scenario, load_scenario, with_options

if TYPE_CHECKING:
    from fuzzyq_bullet.trajectory import Trajectory


@dataclass(frozen=True)
class ScenarioRun:
    """What came of it.

    Attributes:
        trajectory: The record of the run.
        result: Its figures.
        verdict: What ``fuzzyq check`` would say.
    """

    trajectory: Trajectory
    result: Result
    verdict: Verdict

    @property
    def passed(self) -> bool:
        """Whether the run did what the scenario expects."""
        return self.verdict.status == "passed"

    @property
    def explanation(self) -> str:
        """Why not: when, where, at which obstacle, and how to see it again."""
        return explanation(self.verdict)


def run_scenario(
    source: str | os.PathLike[str],
    *,
    planner: str | None = None,
    seed: int | None = None,
    drive: str | None = None,
    again: str = "",
) -> ScenarioRun:
    """Run a scenario in this process, where whatever a test put in place is seen.

    Args:
        source: A file, or the name of a bundled scenario.
        planner: Planner to use instead of the scenario's own.
        seed: Seed to use instead.
        drive: ``wheels`` or ``kinematic``, instead.
        again: The command that runs the test again, which alone knows a planner of its own.

    Raises:
        UserError: If it cannot be run.
    """
    file = find_scenario(source)
    scenario = load_scenario(file, policies=planner is None)
    trajectory = run(with_options(scenario, planner=planner, seed=seed, drive=drive))
    result = result_of(trajectory)
    job = Job(file=str(file), name=scenario.name, planner=planner, seed=seed, drive=drive)
    own = not settings_for(result.planner).__module__.startswith("fuzzyq_bullet.")
    command = again if own and again else replay_command(job)
    asked = Verdict(name=job.name, file=job.file, status="passed", replay=command)
    return ScenarioRun(trajectory, result, judge(trajectory, result, asked))
