"""``fuzzyq race``: several runs of one scenario in one film, in step."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fuzzyq_bullet.cli.film import (
    FilmRequest,
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
from fuzzyq_bullet.cli.options import FOLDER, Json, PluginOption, ReplaceOption, say
from fuzzyq_bullet.cli.run import asked_for, driven, summarise
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.wording import shorten

if TYPE_CHECKING:
    from fuzzyq_bullet.recording.trajectory import Trajectory

LEAST, MOST = 2, 4


def race(
    what: Annotated[
        list[str],
        typer.Argument(
            metavar="SCENARIO | RECORD RECORD...",
            help="A scenario, or two to four records (.npz) of one field.",
        ),
    ],
    *,
    planners: Annotated[
        str | None, typer.Option(metavar="A,B[,C[,D]]", help="Planners that race.")
    ] = None,
    seed: Annotated[int | None, typer.Option(help="Seed to use instead.")] = None,
    drive: Annotated[str | None, typer.Option(help="wheels (physics) or kinematic.")] = None,
    plugin: PluginOption = None,
    out: Annotated[
        Path | None,
        typer.Option(help="Folder to write into; out, or that of the first record.", **FOLDER),
    ] = None,
    speed: SpeedOption = 1.0,
    size: SizeOption = None,
    fps: FpsOption = None,
    from_: FromOption = None,
    to: ToOption = None,
    view: ViewOption = "explain",
    form: FormatOption = "mp4",
    still: StillOption = None,
    replace: ReplaceOption = False,
    json: Json = False,
) -> None:
    """Film two to four runs of one scenario in step, with a clock each and one map.

    With --planners each drives the scenario, and its record and result are written as by fuzzyq
    run; the video is NAME-race-A-vs-B.mp4. With records nothing runs again. The exit code is 0
    however the runs end.

    Raises:
        UserError: If there are too few or too many runs, they are of different fields, or a file
            cannot be read or written.
    """
    shot = {"speed": speed, "size": size, "fps": fps, "start": from_, "end": to, "view": view}
    film = film_request(out, form, still, race=True, **shot)
    records = [Path(one) for one in what if one.lower().endswith(".npz")]
    if records and len(records) == len(what):
        if (planners, seed, drive) != (None, None, None):
            raise UserError("race: records race as they are; leave out --planners, --seed, --drive")
        runs = _of_records(film, records, out, plugin or [], replace=replace)
    else:
        if len(what) > 1:
            got = ", ".join(what)
            raise UserError(f"race: one scenario, or {LEAST} to {MOST} records (.npz); got {got}")
        names = _planners(planners)
        folder = out or Path("out")
        runs = _of_scenario(
            film, what[0], names, seed, drive, folder, plugin or [], replace=replace
        )
    if json:
        from json import dumps

        from fuzzyq_bullet.recording.metrics import result_of

        typer.echo(dumps([result_of(run).model_dump(mode="json") for run in runs], indent=2))


def _planners(text: str | None) -> list[str]:
    names = [name.strip() for name in (text or "").split(",") if name.strip()]
    if not LEAST <= len(names) <= MOST or len(set(names)) < len(names):
        raise UserError(
            f"--planners: must be {LEAST} to {MOST} different planners, "
            f"such as fuzzy,fuzzy-q-lambda; got {shorten(text)}"
        )
    return names


def _of_records(
    film: FilmRequest, records: list[Path], out: Path | None, plugin: list[str], *, replace: bool
) -> list[Trajectory]:
    """Race records."""
    from fuzzyq_bullet.files import refuse_inputs, writable_files
    from fuzzyq_bullet.outputs import plugin_inputs
    from fuzzyq_bullet.recording.trajectory import Trajectory

    if not LEAST <= len(records) <= MOST:
        raise UserError(f"race: needs {LEAST} to {MOST} records; got {len(records)}")
    runs = [Trajectory.load(path) for path in records]
    folder = out or records[0].parent
    name = "race-" + "-vs-".join(path.stem for path in records)
    (video,) = writable_files(folder, [film.name(name)])
    refuse_inputs([video], [*records, *plugin_inputs(plugin)])
    if not replace and video.exists() and not folder.samefile(records[0].parent):
        raise UserError(f"{video}: is there already; --replace replaces it, another --out keeps it")
    say(str(film.make(runs, video, _told_apart(runs, records))))
    return runs


def _told_apart(runs: list[Trajectory], records: list[Path]) -> list[str]:
    """Name the runs by what differs: their planners, else their files, else their folders."""
    ways = (
        [run.scenario.planner.name for run in runs],
        [path.stem for path in records],
        [path.absolute().parent.name for path in records],
    )
    return next((names for names in ways if len(set(names)) == len(names)), ways[1])


def _of_scenario(
    film: FilmRequest,
    scenario: str,
    planners: list[str],
    seed: int | None,
    drive: str | None,
    out: Path,
    plugin: list[str],
    *,
    replace: bool,
) -> list[Trajectory]:
    """Let planners drive a scenario, and race them."""
    from fuzzyq_bullet.files import refuse_inputs, writable_files, write_text
    from fuzzyq_bullet.outputs import plugin_inputs, refuse_other_run, run_name, scenario_inputs
    from fuzzyq_bullet.recording.metrics import result_of
    from fuzzyq_bullet.scenario import load_scenario, realise

    given = load_scenario(scenario, policies=False)  # the planners have their own
    try:
        asked = [asked_for(given, planner=name, seed=seed, drive=drive) for name in planners]
    except UserError as error:  # a race has one option for all of them
        said = (f"{one}".replace("--planner:", "--planners:", 1) for one in error.problems)
        raise UserError(*said) from error
    tasks = [realise(one) for one in asked]
    base = run_name(given, asked_for(given, planner=None, seed=seed, drive=drive))
    (video,) = writable_files(out, [film.name(f"{base}-race-{'-vs-'.join(planners)}")])
    files = []
    for one in asked:
        name = run_name(given, one)
        files.append(writable_files(out, [f"{name}.npz", f"{name}.json"]))
    written = [video, *(path for pair in files for path in pair)]
    inputs = [path for one in asked for path in scenario_inputs(scenario, one)]
    refuse_inputs(written, [*inputs, *plugin_inputs(plugin)])

    def refuse_others() -> None:
        for (npz, result), task in zip(files, tasks, strict=True):
            if not replace:
                refuse_other_run(npz, [result, *([video] if npz == files[0][0] else [])], task)

    refuse_others()
    runs = [driven(task) for task in tasks]
    refuse_others()  # again: another command may have written meanwhile
    for (npz, result_file), run, one in zip(files, runs, asked, strict=True):
        result = result_of(run)
        run.save(npz)
        write_text(result_file, result.model_dump_json(indent=2) + "\n")
        summarise(result, [], run, listed=len(one.obstacles))
    with kept_if_stopped(film, "race", [npz for npz, _ in files], plugin):
        film.make(runs, video, planners)
    for path in written:
        say(f"  {path}")
    return runs
