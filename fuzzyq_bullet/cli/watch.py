"""``fuzzyq watch``: a scenario driven in PyBullet's window, as it happens."""

from __future__ import annotations

import sys
from contextlib import redirect_stdout
from typing import Annotated

import typer

from fuzzyq_bullet.cli.film import SpeedOption
from fuzzyq_bullet.cli.options import PlannerOption, PluginOption, say
from fuzzyq_bullet.cli.run import asked_for, summarise


def watch(
    scenario: Annotated[
        str,
        typer.Argument(metavar="SCENARIO", help="A scenario file, or the name of a bundled one."),
    ],
    *,
    planner: PlannerOption = None,
    seed: Annotated[int | None, typer.Option(help="Seed to use instead.")] = None,
    drive: Annotated[str | None, typer.Option(help="wheels (physics) or kinematic.")] = None,
    plugin: PluginOption = None,
    speed: SpeedOption = 1.0,
) -> None:
    """Drive a scenario in PyBullet's window, in real time; needs a screen, and writes no files.

    The camera follows the robot, the mouse turns it (ctrl and drag) and zooms. Keys: space pauses,
    s drives for one decision, + and - are faster and slower, q quits. The robot drives as in
    `fuzzyq run`, which writes the film and the record. Exit code 1 when the run misses what the
    scenario expects.

    Raises:
        UserError: If the scenario cannot be run, or there is no screen.
    """
    from fuzzyq_bullet.scenario import load_scenario, realise

    given = load_scenario(scenario, policies=planner is None)
    asked = asked_for(given, planner=planner, seed=seed, drive=drive)
    task = realise(asked)

    from fuzzyq_bullet import live
    from fuzzyq_bullet.physics.engine import silenced
    from fuzzyq_bullet.physics.window import WindowClosed
    from fuzzyq_bullet.recording.metrics import result_of
    from fuzzyq_bullet.scenario.expectations import unmet_expectations

    try:
        # A planner may print. PyBullet does so when somebody closes its window, whenever it likes.
        with redirect_stdout(sys.stderr), silenced(1):
            trajectory = live.watch(task, speed=speed)
    except WindowClosed:
        say("closed before the run was over")
        return
    result = result_of(trajectory)
    misses = unmet_expectations(task.expect, result)
    summarise(result, misses, trajectory, listed=len(asked.obstacles))
    if misses:
        raise typer.Exit(1)
