"""``fuzzyq report``: all sweeps of a folder as one HTML page."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated

import typer

from fuzzyq_bullet.cli.options import FILE, Jobs, PluginOption


def report(
    folder: Annotated[
        Path, typer.Argument(metavar="DIR", help="Folder that holds sweeps, or that of one.")
    ] = Path("out"),
    *,
    out: Annotated[
        Path | None,
        typer.Option(help="The page; by default report.html in DIR.", **FILE),
    ] = None,
    videos: Annotated[
        bool, typer.Option("--videos/--no-videos", help="Best, median and worst run as films.")
    ] = True,
    figures: Annotated[
        bool, typer.Option("--figures/--no-figures", help="The paper's Figs. 4 and 9 to 12.")
    ] = True,
    jobs: Jobs = None,
    plugin: PluginOption = None,
) -> None:
    """Make one page of what fuzzyq bench success, steps, learning and escape wrote below DIR.

    It needs no server and no other file. Unfinished sweeps are shown as far as they are. Films are
    of runs made again from their seeds, and held to the digests of their rows.

    Raises:
        UserError: If DIR holds no sweep, one is damaged, or the page cannot be written.
    """
    from fuzzyq_bullet.cli.console import progress_bar, say
    from fuzzyq_bullet.experiments.report.evaluation import evaluation_of, wanted_films
    from fuzzyq_bullet.files import refuse_inputs, writable_files, write_text
    from fuzzyq_bullet.outputs import plugin_inputs

    evaluation = evaluation_of(folder)
    target = folder / "report.html" if out is None else out
    (target,) = writable_files(target.parent, [target.name])
    sources = [path for sweep in evaluation.sweeps for path in sweep.files]
    refuse_inputs([target], [*sources, *plugin_inputs(plugin or [])])

    from fuzzyq_bullet.experiments.figures import FIGURES
    from fuzzyq_bullet.experiments.report.films import Film, Wanted
    from fuzzyq_bullet.experiments.report.page import page
    from fuzzyq_bullet.experiments.report.work import make

    wanted = wanted_films(evaluation.success) if videos else {}
    drawn = sorted(FIGURES) if figures else []
    # Films first: they take longest, and the end should not wait for one.
    things: list[Wanted | int] = [*wanted.values(), *drawn]
    with progress_bar("filming", len(things)) as (progress, bar):
        made = make(things, jobs, plugin or [], lambda: progress.advance(bar))
    named = dict(zip([*wanted, *drawn], made, strict=True))
    films = {place: one for place in wanted if isinstance(one := named[place], Film)}
    pictures = {number: one for number in drawn if isinstance(one := named[number], bytes)}
    command = f"fuzzyq report {shlex.quote(str(folder))}"
    command += ("" if videos else " --no-videos") + ("" if figures else " --no-figures")
    shown = page(evaluation, films if videos else None, pictures if figures else None, command)
    write_text(target, shown)
    for sweep in evaluation.sweeps:
        if not sweep.finished:
            say(f"{sweep.folder}: {len(sweep.rows)} of {sweep.settings.total} episodes so far")
    other = sum(one.other for one in films.values())
    if other:
        say(f"{other} of {len(films)} runs came out otherwise than in their rows: see the page")
    shot = sum(one.problem is None for one in films.values())
    say(f"{shot} films, {len(pictures)} figures, {len(shown) / 1e6:.1f} MB")
    typer.echo(target)
