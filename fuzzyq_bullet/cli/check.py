"""``fuzzyq check``: scenarios as tests, for the CI of robot teams."""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
import textwrap
import time
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fuzzyq_bullet.cli.film import ReplaceOption
from fuzzyq_bullet.cli.folder import FILE, FOLDER
from fuzzyq_bullet.cli.plugin import PluginOption
from fuzzyq_bullet.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from fuzzyq_bullet.checks.verdict import Verdict
    from fuzzyq_bullet.workers import WorkerPool


class Video(str, Enum):
    """Of which runs a film is kept."""

    failed = "failed"
    all = "all"
    none = "none"


def check(
    paths: Annotated[
        list[str],
        typer.Argument(
            metavar="PATH...",
            help="Scenario files, folders, globs, or names of bundled scenarios.",
        ),
    ],
    *,
    planner: Annotated[
        str | None,
        typer.Option(help="Planner to use instead, with the same settings as far as it has them."),
    ] = None,
    seed: Annotated[int | None, typer.Option(help="(First) seed to use instead.")] = None,
    drive: Annotated[str | None, typer.Option(help="wheels or kinematic, instead.")] = None,
    repeat: Annotated[
        int, typer.Option(min=1, max=10_000, help="Runs of each, with seeds that count up.")
    ] = 1,
    plugin: PluginOption = None,
    jobs: Annotated[
        int | None, typer.Option(min=1, max=1024, help="Worker processes; one a core by default.")
    ] = None,
    timeout: Annotated[
        float, typer.Option(min=0.1, max=86400.0, help="Wall-clock seconds for one run.")
    ] = 120.0,
    memory: Annotated[
        int, typer.Option(min=256, max=1_000_000, help="Memory (MB) for one run.")
    ] = 2048,
    junit: Annotated[Path | None, typer.Option(help="Write a report as JUnit XML.", **FILE)] = None,
    github: Annotated[
        bool, typer.Option("--github", help="Print annotations for GitHub Actions.")
    ] = False,
    json: Annotated[bool, typer.Option("--json", help="As JSON on stdout, alone.")] = False,
    video: Annotated[
        Video, typer.Option(help="Of which runs to keep a film and its record in --out.")
    ] = Video.none,
    out: Annotated[Path, typer.Option(help="Folder for films.", **FOLDER)] = Path("out/check"),
    replace: ReplaceOption = False,
    record: Annotated[
        bool, typer.Option("--record", help="Note how they behave now, beside the scenarios.")
    ] = False,
    strict: Annotated[
        bool, typer.Option("--strict", help="Fail what behaves otherwise than recorded.")
    ] = False,
) -> None:
    """Run scenarios and hold each to what it expects: by default the goal, and no collision.

    Each runs in a worker process: one that crashes, hangs or eats memory fails alone. Exit code 1
    when one fails, 2 when one cannot be run at all.

    Raises:
        UserError: If an option is wrong, or there is no scenario.
    """
    from fuzzyq_bullet.checks.collect import find
    from fuzzyq_bullet.checks.github import harmless, problem_command
    from fuzzyq_bullet.checks.jobs import check_all
    from fuzzyq_bullet.checks.junit import junit_xml
    from fuzzyq_bullet.checks.plan import Plan, planned
    from fuzzyq_bullet.checks.record import Records, records_beside
    from fuzzyq_bullet.checks.report import as_json
    from fuzzyq_bullet.checks.words import summary
    from fuzzyq_bullet.cli.console import say
    from fuzzyq_bullet.cli.process import say_error
    from fuzzyq_bullet.files import refuse_inputs, writable_files, writable_folder, write_text
    from fuzzyq_bullet.outputs import plugin_inputs
    from fuzzyq_bullet.workers import WorkerPool

    if record and strict:
        raise UserError("--record and --strict exclude each other: one notes, the other compares")
    if record:
        _refuse_bundled(paths)
    found = find(paths)
    if video is not Video.none:
        writable_folder(out)
    with tempfile.TemporaryDirectory(prefix="fuzzyq-check-") as kept:
        # Whether a run behaves otherwise than recorded is known when its process is done with it.
        keep = Video.all if strict and video is Video.failed else video
        folder = None if video is Video.none else Path(kept)
        plan = planned(found.files, Plan(planner, seed, drive, repeat, keep.value, folder))
        if not plan.jobs:
            raise UserError(*found.problems, *plan.problems)
        problems = [*found.problems, *plan.problems]
        written = [out / Path(job.record).name for job in plan.jobs if job.record is not None]
        written += [path.with_suffix(".mp4") for path in written]
        if junit is not None:
            writable_files(junit.parent, [junit.name])  # what cannot be is told before the work
            written.append(junit)
        inputs = [*plan.inputs, *plugin_inputs(plugin or []), *records_beside(plan.inputs)]
        refuse_inputs(written, inputs)
        begun = time.monotonic()
        records = Records()
        show = _printer(json=json, github=github, width=max(len(job.name) for job in plan.jobs))

        def settle(verdict: Verdict) -> None:
            if not record:
                verdict.changes = records.changes(verdict)
                if strict and verdict.changes and verdict.status == "passed":
                    verdict.status = "failed"
                    verdict.why = ["behaves otherwise than recorded (--strict)"]
            if verdict.record is not None:
                _put_away(verdict, None if _is_dropped(verdict, video) else out, replace=replace)
            show(verdict)

        with WorkerPool(jobs, plugins=plugin or [], timeout=timeout, memory_mb=memory) as pool:
            verdicts = _settled(check_all(pool, plan.jobs), settle)
            _make_films(pool, verdicts, say)
    if record:
        for path in records.write(verdicts):
            say(f"recorded in {path}")
    if strict and records.missing:
        say(f"{records.missing} not compared: not recorded yet (fuzzyq check --record)")
    problems += records.problems
    for problem in problems:
        say_error(harmless(problem) if github else problem)
        if github:
            typer.echo(problem_command(problem), err=json)
    seconds = time.monotonic() - begun
    say(summary(verdicts, len(problems), seconds), style="bold")
    if junit is not None:
        write_text(junit, junit_xml(verdicts, problems, seconds))
    if json:
        typer.echo(as_json(verdicts, problems, seconds))
    if problems or any(verdict.status == "invalid" for verdict in verdicts):
        raise typer.Exit(2)
    if len(verdicts) < len(plan.jobs) or any(one.status != "passed" for one in verdicts):
        raise typer.Exit(1)


def _settled(
    finished: Iterable[tuple[int, Verdict]], settle: Callable[[Verdict], None]
) -> list[Verdict]:
    """Return verdicts in the order asked for, each settled as soon as all before it are."""
    verdicts: list[Verdict] = []
    waiting: dict[int, Verdict] = {}
    for i, verdict in finished:
        waiting[i] = verdict
        while len(verdicts) in waiting:
            verdicts.append(waiting.pop(len(verdicts)))
            settle(verdicts[-1])
    return verdicts


def _is_dropped(verdict: Verdict, video: Video) -> bool:
    return video is Video.failed and verdict.status == "passed"


def _put_away(verdict: Verdict, folder: Path | None, *, replace: bool) -> None:
    """Move the record of a run to where it is kept; without a folder it is removed.

    It takes the place of one of the same run alone. That it cannot be kept changes no verdict.
    """
    from fuzzyq_bullet.files import written_beside
    from fuzzyq_bullet.outputs import refuse_other_run
    from fuzzyq_bullet.trajectory import Trajectory

    source = Path(str(verdict.record))
    verdict.record = None
    try:
        if folder is None:
            return
        target = folder / source.name
        if not replace:
            film = target.with_suffix(".mp4")
            refuse_other_run(target, [film], Trajectory.load(source).scenario)
        with written_beside(target) as part:
            shutil.copyfile(source, part)
        verdict.record = str(target)
    except UserError as error:
        verdict.no_film = str(error)
    finally:
        source.unlink(missing_ok=True)


def _printer(*, json: bool, github: bool, width: int) -> Callable[[Verdict], None]:
    """Return what prints a verdict: on stdout, or on stderr where stdout is for JSON alone."""
    from fuzzyq_bullet.checks.github import harmless, verdict_commands
    from fuzzyq_bullet.checks.words import lines_of

    terminal = (sys.stderr if json else sys.stdout).isatty()

    def show(verdict: Verdict) -> None:
        lines = lines_of(verdict, width)
        if github:
            lines = [harmless(line) for line in lines]
        if terminal:
            lines = _fitted(lines)
        for line in [*lines, *(verdict_commands(verdict) if github else [])]:
            typer.echo(line, err=json)

    return show


def _fitted(lines: list[str]) -> list[str]:
    """Return lines for a terminal: the mark coloured, what is too long broken between words.

    Not so the command to copy, which the terminal itself breaks where it must.
    """
    from fuzzyq_bullet.checks.words import AGAIN

    mark, rest = lines[0][:5], lines[0][5:]
    if not os.environ.get("NO_COLOR"):
        mark = typer.style(mark, fg="green" if mark.startswith("ok") else "red", bold=True)
    columns = shutil.get_terminal_size().columns
    told = [mark + rest]
    for line in lines[1:]:
        if line.startswith(AGAIN):
            told.append(line)
            continue
        told += textwrap.wrap(
            line,
            columns,
            subsequent_indent=" " * 8,
            break_long_words=False,
            break_on_hyphens=False,
        )
    return told


def _refuse_bundled(paths: Sequence[str]) -> None:
    """Make sure that --record is not asked to write beside what is bundled.

    Raises:
        UserError: If one of the paths is the name of a bundled scenario, and no file.
    """
    from fuzzyq_bullet.resources import data_folder

    bundled = {file.stem: file for file in data_folder("scenarios").glob("*.yaml")}
    for path in paths:
        if path in bundled and not os.path.exists(path):  # noqa: PTH110 - a long name is no error
            raise UserError(
                f"{path}: --record notes beside the scenario, and this one is bundled with the "
                f"package; copy {bundled[path]} to a folder of your own"
            )


def _make_films(pool: WorkerPool, verdicts: list[Verdict], say: Callable[[str], None]) -> None:
    """Make the films of all runs whose record was kept; a film that fails changes no verdict."""
    from fuzzyq_bullet.checks.jobs import film_all
    from fuzzyq_bullet.checks.verdict import FilmJob

    kept = [verdict for verdict in verdicts if verdict.record]
    films = [
        FilmJob(
            record=str(verdict.record), video=str(Path(str(verdict.record)).with_suffix(".mp4"))
        )
        for verdict in kept
    ]
    for i, why in film_all(pool, films):
        if why:
            kept[i].no_film = why
            say(f"no film {films[i].video}: {why}")
        else:
            kept[i].video = films[i].video
            say(f"film {films[i].video}")
