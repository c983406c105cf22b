"""A study run from the command line: its sweeps, what it writes, what it prints."""

from __future__ import annotations

import os
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import typer

from fuzzyq_bullet.cli.options import progress_bar, say
from fuzzyq_bullet.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from rich.console import Group
    from rich.table import Table as RichTable

    from fuzzyq_bullet.studies.study import Findings, Stage, Study, Swept, Table
    from fuzzyq_bullet.studies.sweep import Progress, State
    from fuzzyq_bullet.workers import Pool

BACKENDS = ("loky", "dask")
"""Processes of this machine, which were loky's once, or of a cluster."""


def run_study(
    study: Study,
    out: Path,
    where: tuple[str, str | None, int | None],
    plugins: Sequence[str],
    *,
    replace: bool,
    json: bool,
) -> None:
    """Run a study, write what it found, and print it.

    Exit code 1 when targets are missed, 2 when an input of several could not be read.

    Args:
        study: What is asked.
        out: Its folder.
        where: Backend, address of its scheduler, and how many episodes at a time.
        plugins: Modules that each worker imports first.
        replace: Whether files may be replaced that no sweep of these settings has made.
        json: Whether to print JSON, alone.

    Raises:
        UserError: If an option is wrong, the folder holds a sweep with other settings or files of
            somebody else's, or the scheduler cannot be used.
    """
    stages = study.stages()
    stage = next(stages)  # what is wrong with an option is told before anything is begun

    from fuzzyq_bullet.files import writable_files, write_text, written_beside
    from fuzzyq_bullet.outputs import plugin_settings

    more = plugin_settings(plugins)
    if not replace:
        _refuse_others(study, out)
    names = [f"{study.name}.json", *([f"{study.name}.png"] if study.pictured else [])]
    results: dict[str, Swept] = {}
    here = where[1] is None  # no scheduler of a cluster
    with _pool(*where, plugins) as pool:
        text, *images = writable_files(out, names)
        while True:
            results[stage.name] = _swept(study, stage, out, pool, more, here=here)
            try:
                stage = stages.send(results[stage.name])
            except StopIteration:
                break
    findings = study.findings(results)
    import json as writer

    shown = writer.dumps(findings.data, indent=2)
    write_text(text, shown + "\n")
    for image in images:
        with written_beside(image) as part:
            findings.pictures[0].draw().savefig(part, format="png")
    if json:
        typer.echo(shown)
    else:
        from rich.console import Console

        # A narrow terminal may break lines, but no figure is cut off.
        width = max(study.width, Console().width)
        Console(highlight=False, width=width).print(printed(findings))
    for name, one in results.items():
        say(f"  {one.folder / name}.csv")
        if study.kept and any((one.folder / "records").iterdir()):
            say(f"  {one.folder / 'records'}")
    for path in (text, *images):
        say(f"  {path}")
    _judge(findings, results[stage.name])


def _refuse_others(study: Study, out: Path) -> None:
    """Make sure that what is there under the names of a study's files is its own.

    It is where settings lie beside it: a sweep of other settings is refused for those.

    Raises:
        UserError: If it is not.
    """
    from fuzzyq_bullet.studies.storage import SETTINGS, Folder

    folders = {name: out / study.folders.get(name, "") for name in study.stage_kinds()}
    claimed = {name for name, folder in folders.items() if Folder(folder).is_claimed()}
    files = [folder / f"{name}.csv" for name, folder in folders.items() if name not in claimed]
    if not claimed:
        files += [out / f"{study.name}.json", out / f"{study.name}.png"]
    for file in files:
        if os.path.lexists(file):
            raise UserError(
                f"{file}: is there already, and no {SETTINGS} tells of which sweep; "
                "--replace replaces it, another --out keeps it"
            )


def _judge(findings: Findings, last: Swept) -> None:
    """Say what is wrong; then the exit code is 1, or 2 where an input could not be read."""
    from fuzzyq_bullet.cli.process import say_error

    errors = [row for row in last.rows if row.outcome == "error"]
    if errors:
        first, plural = errors[0], "" if len(errors) == 1 else "s"
        say(f"{len(errors)} episode{plural} failed: see the column error; the first:", style="bold")
        say(f"  {first.planner}: {first.error}")
    if findings.missed:
        say("targets missed: " + "; ".join(findings.missed), style="bold")
    for problem in findings.problems:
        say_error(problem)
    if findings.problems:
        raise typer.Exit(2)
    if errors or findings.missed:
        raise typer.Exit(1)


def _swept(
    study: Study, stage: Stage, out: Path, pool: Pool, more: dict[str, Any], *, here: bool
) -> Swept:
    """Run one sweep of a study in its folder, and say how it went; ``here``: on this machine."""
    from fuzzyq_bullet.studies.study import Swept
    from fuzzyq_bullet.studies.sweep import sweep

    for note in stage.notes:
        say(note)
    folder = out / study.folders.get(stage.name, "")
    settings = {**stage.plan.model_dump(mode="json"), **more}
    with _bar() as progress:
        done = sweep(
            stage.name,
            stage.plan.jobs(stage.planners),
            folder,
            settings,
            pool=pool,
            work=study.work(),
            progress=progress,
            here=here,
        )
    state = done.state
    say(
        f"{stage.name + ': ' if study.folders else ''}{state.ran} episodes in {state.seconds:.1f} "
        f"s: {state.rate:.2f} episodes/s; {state.done - state.ran} were there already"
    )
    return Swept(stage.plan, done.rows, settings, state.rate, folder)


def printed(findings: Findings) -> Group:
    """Return what a study found for a terminal: its tables, and its remarks below them."""
    from rich.console import Group

    parts: list[Any] = []
    for table in findings.tables:
        parts += ["", _rich(table)] if parts else [_rich(table)]
    return Group(*parts, *(["", *findings.remarks] if findings.remarks else []))


def _rich(table: Table) -> RichTable:
    """Return a table for a terminal."""
    from rich.markup import escape
    from rich.table import Table as RichTable

    shown = RichTable(
        box=None, padding=(0, 1, 0, 0), caption=escape(table.caption), caption_justify="left"
    )
    for i, name in enumerate(table.columns):
        shown.add_column(name, justify="left" if i in table.left else "right", no_wrap=True)
    for cells in table.rows:
        shown.add_row(*map(escape, cells))
    return shown


@contextmanager
def _pool(
    backend: str, scheduler: str | None, jobs: int | None, plugins: Sequence[str]
) -> Iterator[Pool]:
    """Yield who does the work of a sweep.

    Args:
        backend: ``loky``, processes of this machine, or ``dask``.
        scheduler: Address of the Dask scheduler.
        jobs: Episodes at a time; None for one a core.
        plugins: Modules that each worker imports first.

    Raises:
        UserError: If there is no such backend, or its scheduler cannot be used.
    """
    from fuzzyq_bullet.wording import not_one_of

    if backend not in BACKENDS:
        raise UserError(f"--backend: {not_one_of('backend', backend, BACKENDS)}")
    if (backend == "dask") != (scheduler is not None):
        raise UserError("--backend dask and --scheduler ADDRESS belong together")
    if scheduler is None:
        from fuzzyq_bullet.studies.sweep import local_pool

        with local_pool(jobs, plugins) as pool:
            yield pool
        return

    files = [name for name in plugins if name.endswith(".py")]
    if files:
        raise UserError(
            f"--plugin: {files[0]} is a file of this machine; with --backend dask install it as a "
            "module on the workers, and give its name"
        )

    from fuzzyq_bullet.workers.cluster import cluster

    with cluster(scheduler, jobs) as pool:
        yield pool


@contextmanager
def _bar() -> Iterator[Progress]:
    """Show how far a sweep is: rate, remaining time, and the success so far."""
    with progress_bar("sweeping") as (progress, bar):

        def show(state: State) -> None:
            success = f"{state.successes / state.feasible:.2f}" if state.feasible else "–"
            progress.update(
                bar,
                completed=state.done,
                total=state.total,
                note=f"{state.done} of {state.total}, {state.rate:.1f}/s, "
                f"found {success} of feasible",
            )

        yield show
