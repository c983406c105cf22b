"""``fuzzyq run``: one scenario, driven, recorded and explained."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fuzzyq_bullet.cli.console import progress_bar, say
from fuzzyq_bullet.cli.film import SpeedOption, film

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fuzzyq_bullet.metrics import Result


def run(
    scenario: Annotated[
        str,
        typer.Argument(metavar="SCENARIO", help="A scenario file, or the name of a bundled one."),
    ],
    *,
    planner: Annotated[str | None, typer.Option(help="Planner to use instead.")] = None,
    seed: Annotated[int | None, typer.Option(help="Seed to use instead.")] = None,
    drive: Annotated[str | None, typer.Option(help="wheels (physics) or kinematic.")] = None,
    out: Annotated[Path, typer.Option(help="Folder to write into.")] = Path("out"),
    video: Annotated[bool, typer.Option("--video/--no-video", help="Make the video.")] = True,
    speed: SpeedOption = 1.0,
    json: Annotated[bool, typer.Option("--json", help="Result as JSON on stdout, alone.")] = False,
) -> None:
    """Drive a scenario; write NAME.mp4, NAME.npz (the record) and NAME.json (the result).

    Exit code 1 when the run misses what the scenario expects.
    """
    # What takes long to load waits until the scenario is known to be right.
    from fuzzyq_bullet.files import writable_files, write_text
    from fuzzyq_bullet.scenario import load_scenario, realise, with_options

    task = realise(with_options(load_scenario(scenario), planner=planner, seed=seed, drive=drive))
    names = [f"{task.name}{ending}" for ending in (".mp4", ".npz", ".json")]
    mp4, npz, result_file = written = writable_files(out, names)

    from fuzzyq_bullet.episode import run as run_episode
    from fuzzyq_bullet.metrics import result_of
    from fuzzyq_bullet.verdict import missed

    with progress_bar("driving", task.limits.time) as (progress, bar):
        trajectory = run_episode(
            task,
            progress=lambda time, to_goal: progress.update(
                bar, completed=time, note=f"{time:5.1f} s, {to_goal:4.1f} m to go"
            ),
        )
    result = result_of(trajectory)
    # The record first: whatever happens to the video, it can be made again from that.
    trajectory.save(npz)
    write_text(result_file, result.model_dump_json(indent=2) + "\n")
    if video:
        film(trajectory, mp4, speed)
    else:
        written.remove(mp4)
    if json:
        typer.echo(result.model_dump_json(indent=2))
    misses = missed(task.expect, result)
    _summarise(result, misses, written)
    if misses:
        raise typer.Exit(1)


def _summarise(result: Result, misses: Sequence[str], written: Sequence[Path]) -> None:
    clearance = result.min_clearance_m
    near = "nothing near" if clearance is None else f"least clearance {clearance:.3f} m"
    say(
        f"{result.scenario}: {result.outcome} after {result.time_s:.1f} s, "
        f"path {result.path_length_m:.2f} m, {near} "
        f"({result.planner}, {result.drive}, seed {result.seed})",
        style="bold",
    )
    for miss in misses:
        say(f"not as expected: {miss}", style="bold")
    for path in written:
        say(f"  {path}")
