"""One scenario run in this process: driven, held to what it expects, a miss explained.

``run_job`` is for workers, whatever goes wrong; ``run_scenario`` for a test that somebody wrote.
"""

from __future__ import annotations

import math
import os
import traceback
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fuzzyq_bullet.checks.verdict import Job, Touch, Verdict, explanation, replay_command
from fuzzyq_bullet.early_warnings import NO_WAY, early_warnings
from fuzzyq_bullet.errors import PlannerError, UserError
from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.planning.registry import settings_for
from fuzzyq_bullet.reading.yaml_tree import Node, read_tree
from fuzzyq_bullet.recording.fault import speeds_in_words
from fuzzyq_bullet.recording.metrics import Result, has_way, name_of, result_of, touch_in_words
from fuzzyq_bullet.recording.moving import nearest_to
from fuzzyq_bullet.recording.trajectory import Trajectory
from fuzzyq_bullet.scenario import (
    Scenario,
    find_scenario,
    load_scenario,
    realise,
    with_options,
)
from fuzzyq_bullet.scenario.expectations import unmet_expectations
from fuzzyq_bullet.wording import error_in_words, plain

OUT_OF_MEMORY = "ran out of the memory that it may use (--memory)"


def run_job(job: Job) -> Verdict:
    """Run a scenario and judge it; whatever goes wrong in it is part of the verdict."""
    verdict = Verdict(name=job.name, file=job.file, status="passed")
    try:
        given = load_scenario(job.file, policies=job.planner is None)
        given = with_options(given, planner=job.planner, seed=job.seed, drive=job.drive)
        scenario = realise(given)
        verdict.warnings = early_warnings(job.file, given, scenario)
        trajectory = _run(scenario)
        verdict = judge(trajectory, result_of(trajectory), verdict)
        if NO_WAY in verdict.why:  # said already
            verdict.warnings = [one for one in verdict.warnings if not one.endswith(NO_WAY)]
    except PlannerError as error:
        memory = isinstance(error.__cause__, MemoryError)
        return _broken(job, verdict, OUT_OF_MEMORY if memory else str(error))
    except UserError as error:
        why = [_named(problem, job.file) for problem in error.problems]
        return verdict.model_copy(update={"status": "invalid", "why": why})
    except MemoryError:
        return _broken(job, verdict, OUT_OF_MEMORY)
    except Exception as error:  # of a planner of the user's own, or ours: the others go on
        return _broken(job, verdict, _in_a_line(error))
    except (SystemExit, KeyboardInterrupt) as error:  # of a scenario's settings, or a sensor's
        return _broken(job, verdict, _in_a_line(error))
    if job.record and (job.keep == "all" or (job.keep == "failed" and verdict.why)):
        _keep(trajectory, job.record, verdict)
    return verdict


@dataclass(frozen=True)
class ScenarioRun:
    """What came of a scenario that a test ran: record, figures, what ``fuzzyq check`` would say."""

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
    trajectory = _run(with_options(scenario, planner=planner, seed=seed, drive=drive))
    result = result_of(trajectory)
    job = Job(file=str(file), name=scenario.name, planner=planner, seed=seed, drive=drive)
    own = not settings_for(result.planner).__module__.startswith("fuzzyq_bullet.")
    command = again if own and again else replay_command(job)
    asked = Verdict(name=job.name, file=job.file, status="passed", replay=command)
    return ScenarioRun(trajectory, result, judge(trajectory, result, asked))


def judge(trajectory: Trajectory, result: Result, verdict: Verdict) -> Verdict:
    """Return the verdict with what the run came to, and why it was not what was expected."""
    expect = trajectory.scenario.expect
    misses = unmet_expectations(expect, result)
    update: dict[str, Any] = {"expect": expect.model_dump(mode="json"), "result": result}
    if not misses:
        return verdict.model_copy(update=update)
    source = Source(verdict.file)
    touch = touched(trajectory, source)
    least, wanted = result.min_clearance_m, expect.min_clearance
    if touch is None and least is not None and wanted is not None and least < wanted:
        touch = nearest(trajectory, source)
    why = list(misses)
    if expect.outcome == "goal" != result.outcome and not has_way(trajectory.scenario):
        why.insert(0, NO_WAY)  # before what came of it
    if touch is not None:
        contact = trajectory.collision is not None
        speeds = speeds_in_words(trajectory) if contact else ""
        told = in_words(touch, verdict.file, contact=contact)
        why.append(told + (f"; {speeds}" if speeds else ""))
    elif result.outcome in ("timeout", "stuck"):
        why.append(whereabouts(trajectory, result))
    line = touch.line if touch is not None else source.line_of("expect", "goal", "name")
    update |= {"status": "failed", "why": why, "touch": touch, "line": line}
    return verdict.model_copy(update=update)


def _run(scenario: Scenario) -> Trajectory:
    # Asked of the module at each run: a plugin may have put another in its place.
    from fuzzyq_bullet import episode

    return episode.run(scenario)


def _keep(trajectory: Trajectory, record: str, verdict: Verdict) -> None:
    """Write the record; that this fails, as on a full disk, is no failure of the robot."""
    try:
        trajectory.save(Path(record))
        verdict.record = record
    except UserError as error:
        verdict.no_film = str(error)


def _broken(job: Job, verdict: Verdict, why: str) -> Verdict:
    no_film = "" if job.record is None else "the run did not come to an end"
    return verdict.model_copy(update={"status": "broken", "why": [why], "no_film": no_film})


def _named(problem: str, file: str) -> str:
    return problem if problem.startswith(file) else f"{file}: {problem}"


def _in_a_line(error: BaseException) -> str:
    """Say what an exception is and where it comes from, as a traceback's last lines would."""
    last = traceback.extract_tb(error.__traceback__)[-1]
    place = f"({last.filename}:{last.lineno}, in {last.name})"
    return f"stopped by an error: {error_in_words(error)} {place}"


class Source:
    """The lines of a scenario file.

    Args:
        file: The file, which was read as a scenario before.
    """

    def __init__(self, file: str) -> None:
        self._tree: Node = read_tree(Path(file).read_text(encoding="utf-8-sig"), file)
        obstacles = self._tree.children.get("obstacles")
        self.listed = len(obstacles.lines) if obstacles is not None else 0

    def line_of(self, *keys: str) -> int:
        """Return the line of the first of these keys that the file has; else its first line."""
        return next((self._tree.lines[key] for key in keys if key in self._tree.lines), 1)

    def line_of_obstacle(self, index: int) -> int:
        """Return the line that put an obstacle, or a wall (−1), where it is."""
        if index < 0:
            return self.line_of("arena")
        if index < self.listed:
            return self._tree.children["obstacles"].lines[index]
        return self.line_of("random")


def touched(trajectory: Trajectory, source: Source) -> Touch | None:
    """Return what the robot touched; None if it touched nothing."""
    collision = trajectory.collision
    if collision is None:
        return None
    return Touch(
        what=name_of(trajectory.scenario, collision.obstacle, source.listed),
        obstacle=collision.obstacle,
        line=source.line_of_obstacle(collision.obstacle),
        point=(round(collision.point[0], 6), round(collision.point[1], 6)),
        time_s=round(collision.time, 6),
        distance_m=0.0,
    )


def nearest(trajectory: Trajectory, source: Source) -> Touch:
    """Return what the robot came nearest to."""
    scenario, ticks = trajectory.scenario, trajectory.ticks
    i = int(np.argmin(ticks.clearance))
    x, y = ticks.position[i].tolist()
    if scenario.drive == "kinematic" and i:  # somewhere on the way to that tick
        field = Field.of(scenario.standing, scenario.arena)
        _, places = field.clearance_along(ticks.position[i - 1], ticks.position[i])
        x, y = places[0].tolist()
    closest, _ = nearest_to(scenario, (x, y), trajectory.movers[i])
    return Touch(
        what=name_of(scenario, closest, source.listed),
        obstacle=closest,
        line=source.line_of_obstacle(closest),
        point=(round(x, 6), round(y, 6)),
        time_s=round(float(ticks.time[i]), 6),
        distance_m=round(float(ticks.clearance[i]), 6),
    )


def in_words(touch: Touch, file: str, *, contact: bool) -> str:
    """Say when and where it was, at which obstacle and line of the file.

    Args:
        touch: What the robot touched, or came nearest to.
        file: The scenario file.
        contact: Whether the two touched. Without a contact the disc around a robot of another shape
            may overlap an obstacle all the same: then the distance is negative.
    """
    place = f"{file}:{touch.line}"
    if contact:
        return touch_in_words(touch.what, touch.point, touch.time_s, place)
    x, y = (plain(value, 2) for value in touch.point)
    near = f"{plain(touch.distance_m, 3)} m from {touch.what} ({place})"
    if touch.distance_m < 0:
        near = (
            f"the disc around the robot {plain(-touch.distance_m, 3)} m into {touch.what} "
            f"({place}), no contact"
        )
    return f"nearest after {touch.time_s:.2f} s, {near}, the robot at ({x}, {y})"


def whereabouts(trajectory: Trajectory, result: Result) -> str:
    """Say where a run ended that neither arrived nor hit anything."""
    x, y = trajectory.ticks.position[-1]
    left = math.dist((x, y), trajectory.scenario.goal.position)
    return (
        f"ended at ({plain(x, 2)}, {plain(y, 2)}) after {result.time_s:.1f} s, "
        f"{plain(left, 2)} m from the goal"
    )
