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

from fuzzyq_bullet.cli.options import FILE, FOLDER, Json, PlannerOption, PluginOption, ReplaceOption
from fuzzyq_bullet.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from fuzzyq_bullet.checks.group import Group
    from fuzzyq_bullet.checks.verdict import Verdict


_COLOURS = {"ok": "green", "miss": "yellow"}


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
    planner: PlannerOption = None,
    seed: Annotated[int | None, typer.Option(help="(First) seed to use instead.")] = None,
    drive: Annotated[str | None, typer.Option(help="wheels or kinematic, instead.")] = None,
    repeat: Annotated[
        int,
        typer.Option(
            min=1, max=10_000, help="Runs of each, with seeds that count up; one verdict on all."
        ),
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
    json: Json = False,
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
    from fuzzyq_bullet.checks.baseline import (
        Baselines,
        baselines_beside,
        refuse_bundled,
        refuse_unwritable,
    )
    from fuzzyq_bullet.checks.group import Group
    from fuzzyq_bullet.checks.plan import Plan, discover, planned
    from fuzzyq_bullet.checks.reports import as_json, harmless, junit_xml, problem_command
    from fuzzyq_bullet.checks.session import Session, check_all, make_films
    from fuzzyq_bullet.checks.verdict import summary
    from fuzzyq_bullet.cli.options import say
    from fuzzyq_bullet.cli.process import say_error
    from fuzzyq_bullet.files import refuse_inputs, writable_files, writable_folder, write_text
    from fuzzyq_bullet.outputs import plugin_inputs
    from fuzzyq_bullet.workers import WorkerPool

    if record and strict:
        raise UserError("--record and --strict exclude each other: one notes, the other compares")
    if record:
        refuse_bundled(paths)
    found = discover(paths)
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
        if record:
            refuse_unwritable([Path(job.file) for job in plan.jobs])
        inputs = [*plan.inputs, *plugin_inputs(plugin or []), *baselines_beside(plan.inputs)]
        refuse_inputs(written, inputs)
        begun = time.monotonic()
        baselines = Baselines()
        width = max(len(job.name) for job in plan.jobs)
        show = _printer(json=json, github=github, width=width, member=repeat > 1)

        compared = None if record else baselines
        session = Session(compared, strict, video.value, out, replace, repeat, plan.names)
        verdicts: list[Verdict] = []
        groups: list[Group] = []
        with WorkerPool(jobs, plugins=plugin or [], timeout=timeout, memory_mb=memory) as pool:
            for one in session.settled(check_all(pool, plan.jobs)):
                if isinstance(one, Group):
                    groups.append(one)
                    show(one, verdicts[-repeat:])
                else:
                    verdicts.append(one)
                    show(one)
            for line in make_films(pool, verdicts):
                say(line)
    if record:
        for path in baselines.write(verdicts, groups):
            say(f"recorded in {path}")
    if strict and baselines.missing:
        say(f"{baselines.missing} not compared: not recorded yet (fuzzyq check --record)")
    problems += baselines.problems
    for problem in problems:
        say_error(harmless(problem) if github else problem)
        if github:
            typer.echo(problem_command(problem), err=json)
    seconds = time.monotonic() - begun
    if groups:
        passed = sum(group.status == "passed" for group in groups)
        say(f"{passed} of {len(groups)} scenarios passed, each with {repeat} seeds", style="bold")
    say(summary(verdicts, len(problems), seconds), style="bold")
    if junit is not None:
        write_text(junit, junit_xml(verdicts, problems, seconds, groups))
    if json:
        typer.echo(as_json(verdicts, problems, seconds, groups))
    if problems or any(verdict.status == "invalid" for verdict in verdicts):
        raise typer.Exit(2)
    judged = groups if repeat > 1 else verdicts
    if len(verdicts) < len(plan.jobs) or any(one.status != "passed" for one in judged):
        raise typer.Exit(1)


def _printer(*, json: bool, github: bool, width: int, member: bool) -> Callable[..., None]:
    """Return what prints a verdict, or a group's with those of its runs behind it.

    On stdout, or on stderr where stdout is for JSON alone.
    """
    from fuzzyq_bullet.checks.group import Group, group_lines
    from fuzzyq_bullet.checks.reports import group_commands, harmless, verdict_commands
    from fuzzyq_bullet.checks.verdict import lines_of

    terminal = (sys.stderr if json else sys.stdout).isatty()

    def show(one: Verdict | Group, members: Sequence[Verdict] = ()) -> None:
        if isinstance(one, Group):
            lines, commands = group_lines(one, width), group_commands(one, members)
        else:
            lines = lines_of(one, width, member=member)
            commands = [] if member else verdict_commands(one)
        if github:
            lines = [harmless(line) for line in lines]
        if terminal:
            lines = _fitted(lines)
        for line in [*lines, *(commands if github else [])]:
            typer.echo(line, err=json)

    return show


def _fitted(lines: list[str]) -> list[str]:
    """Return lines for a terminal: the mark coloured, what is too long broken between words.

    Not so the command to copy, which the terminal itself breaks where it must.
    """
    from fuzzyq_bullet.checks.verdict import AGAIN

    mark, rest = lines[0][:5], lines[0][5:]
    if not os.environ.get("NO_COLOR"):
        mark = typer.style(mark, fg=_COLOURS.get(mark.strip(), "red"), bold=True)
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
