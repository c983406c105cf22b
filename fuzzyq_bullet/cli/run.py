"""``fuzzyq run`` and ``replay``: a scenario driven, recorded and filmed; a record filmed again."""

from __future__ import annotations

import sys
from contextlib import redirect_stdout
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fuzzyq_bullet.cli.film import (
    FormatOption,
    FpsOption,
    FromOption,
    SizeOption,
    SpeedOption,
    StillOption,
    ToOption,
    ViewOption,
    film_request,
    kept_if_stopped,
)
from fuzzyq_bullet.cli.options import (
    FOLDER,
    PlannerOption,
    PluginOption,
    ReplaceOption,
    progress_bar,
    say,
)
from fuzzyq_bullet.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fuzzyq_bullet.recording.metrics import Result
    from fuzzyq_bullet.recording.trajectory import Trajectory
    from fuzzyq_bullet.scenario import Scenario


def run(
    scenario: Annotated[
        str,
        typer.Argument(metavar="SCENARIO", help="A scenario file, or the name of a bundled one."),
    ],
    *,
    planner: PlannerOption = None,
    seed: Annotated[int | None, typer.Option(help="Seed to use instead.")] = None,
    drive: Annotated[str | None, typer.Option(help="wheels (physics) or kinematic.")] = None,
    plugin: PluginOption = None,
    out: Annotated[Path, typer.Option(help="Folder to write into.", **FOLDER)] = Path("out"),
    video: Annotated[bool, typer.Option("--video/--no-video", help="Make the video.")] = True,
    speed: SpeedOption = 1.0,
    size: SizeOption = None,
    fps: FpsOption = None,
    from_: FromOption = None,
    to: ToOption = None,
    view: ViewOption = "explain",
    form: FormatOption = "mp4",
    still: StillOption = None,
    replace: ReplaceOption = False,
    json: Annotated[bool, typer.Option("--json", help="Result as JSON on stdout, alone.")] = False,
) -> None:
    """Drive a scenario; write NAME.mp4, NAME.npz (the record) and NAME.json (the result).

    What differs from the scenario's own settings becomes part of NAME: mixed-fuzzy-seed7. What
    differs from the usual video becomes part of its name: NAME-follow-1920x1080-4x.mp4. Exit code 1
    when the run misses what the scenario expects.
    """
    film = film_request(
        out, form, still, speed=speed, size=size, fps=fps, start=from_, end=to, view=view
    )
    # What takes long to load waits until the scenario is known to be right.
    from fuzzyq_bullet.files import refuse_inputs, writable_files, write_text
    from fuzzyq_bullet.outputs import (
        films_of,
        plugin_inputs,
        refuse_other_run,
        run_name,
        scenario_inputs,
    )
    from fuzzyq_bullet.scenario import load_scenario, realise

    given = load_scenario(scenario, policies=planner is None)  # another planner has its own
    asked = asked_for(given, planner=planner, seed=seed, drive=drive)
    task = realise(asked)
    name = run_name(given, asked)
    mp4, npz, result_file = written = writable_files(
        out, [film.name(name), f"{name}.npz", f"{name}.json"]
    )
    refuse_inputs(written, [*scenario_inputs(scenario, asked), *plugin_inputs(plugin or [])])
    if not video:
        written.remove(mp4)

    def refuse_others() -> None:
        if not replace:
            refuse_other_run(npz, [path for path in written if path != npz], task)

    refuse_others()

    from fuzzyq_bullet.early_warnings import early_warnings
    from fuzzyq_bullet.recording.metrics import result_of
    from fuzzyq_bullet.scenario.expectations import unmet_expectations

    for warning in early_warnings(scenario, asked, task):
        say(f"warning: {warning}")
    trajectory = driven(task)
    result = result_of(trajectory)
    refuse_others()  # again: another command may have written meanwhile
    # The record first: whatever happens to the video, it can be made again from that.
    trajectory.save(npz)
    write_text(result_file, result.model_dump_json(indent=2) + "\n")
    if video:
        with kept_if_stopped(film, "replay", [npz], plugin or []):
            film.make(trajectory, mp4)
    if json:
        typer.echo(result.model_dump_json(indent=2))
    misses = unmet_expectations(task.expect, result)
    summarise(result, misses, trajectory, listed=len(asked.obstacles))
    for path in written:
        say(f"  {path}")
    for path in films_of(out, name):
        if path not in written:
            say(f"{path} is of an earlier run")
    if misses:
        raise typer.Exit(1)


def replay(
    trajectory: Annotated[
        Path, typer.Argument(metavar="TRAJECTORY", help="A record (.npz) written by a run.")
    ],
    *,
    out: Annotated[
        Path | None,
        typer.Option(help="Folder to write into; by default that of the record.", **FOLDER),
    ] = None,
    speed: SpeedOption = 1.0,
    size: SizeOption = None,
    fps: FpsOption = None,
    from_: FromOption = None,
    to: ToOption = None,
    view: ViewOption = "explain",
    form: FormatOption = "mp4",
    still: StillOption = None,
    plugin: PluginOption = None,
    replace: ReplaceOption = False,
) -> None:
    """Make the video NAME.mp4 from a record, without running anything again.

    What differs from the usual video becomes part of its name: NAME-follow-1920x1080-4x.mp4.

    Raises:
        UserError: If the record cannot be read, or the video cannot be written.
    """
    film = film_request(
        out, form, still, speed=speed, size=size, fps=fps, start=from_, end=to, view=view
    )
    from fuzzyq_bullet.files import refuse_inputs, writable_files
    from fuzzyq_bullet.outputs import plugin_inputs, refuse_other_run
    from fuzzyq_bullet.recording.trajectory import Trajectory

    record = Trajectory.load(trajectory)
    folder = out or trajectory.parent
    (video,) = writable_files(folder, [film.name(trajectory.stem)])
    refuse_inputs([video], [trajectory, *plugin_inputs(plugin or [])])
    if not replace and not folder.samefile(trajectory.parent):
        refuse_other_run(folder / f"{trajectory.stem}.npz", [video], record.scenario)
    typer.echo(film.make(record, video))


def driven(task: Scenario) -> Trajectory:
    """Drive a scenario, every obstacle listed, showing how far it is."""
    from fuzzyq_bullet import episode

    # A planner may print; stdout is for the result.
    with (
        redirect_stdout(sys.stderr),
        progress_bar("driving", task.limits.time) as (progress, bar),
    ):
        return episode.run(
            task,
            progress=lambda time, to_goal: progress.update(
                bar, completed=time, note=f"{time:5.1f} s, {to_goal:4.1f} m to go"
            ),
        )


def asked_for(scenario: Scenario, **options: Any) -> Scenario:
    """Return a scenario with the planner, seed and drive that options ask for.

    Raises:
        UserError: If there is no such planner or drive, or the seed is none.
    """
    from fuzzyq_bullet.scenario import with_options

    try:
        return with_options(scenario, **options)
    except UserError as error:  # each names the argument, which here is an option
        raise UserError(*(f"--{problem}" for problem in error.problems)) from error


def summarise(
    result: Result, misses: Sequence[str], trajectory: Trajectory, *, listed: int
) -> None:
    """Say how a run went; ``listed`` obstacles of it are in the scenario file."""
    from fuzzyq_bullet.recording.metrics import collision_text
    from fuzzyq_bullet.wording import plain

    clearance = result.min_clearance_m
    near = "nothing near" if clearance is None else f"least clearance {plain(clearance, 3)} m"
    say(
        f"{result.scenario}: {result.outcome} after {result.time_s:.1f} s, "
        f"path {result.path_length_m:.2f} m, {near} "
        f"({result.planner}, {result.drive}, seed {result.seed})",
        style="bold",
    )
    contact = collision_text(trajectory, listed)
    if contact:
        say(contact, style="bold")
    for miss in misses:
        say(f"not as expected: {miss}", style="bold")
