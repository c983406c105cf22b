"""``fuzzyq figure`` and ``report``: one figure of the paper; all sweeps of a folder as one page."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated

import typer

from fuzzyq_bullet.cli.options import (
    FILE,
    FOLDER,
    Jobs,
    PlannerOption,
    PluginOption,
    ReplaceOthersOption,
    RulesOption,
)
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.wording import shorten


def figure(
    name: Annotated[
        str,
        typer.Argument(
            metavar="FIGURE", help="Number of a figure in the paper; weights; or curves."
        ),
    ],
    policies: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="[POLICY]...", help="For weights and curves: what fuzzyq train wrote."
        ),
    ] = None,
    *,
    out: Annotated[Path, typer.Option(help="Folder to write into.", **FOLDER)] = Path("out"),
    planner: PlannerOption = None,
    rules: RulesOption = None,
    plugin: PluginOption = None,
    replace: ReplaceOthersOption = False,
) -> None:
    """Draw a figure of the paper, or a picture of what was learned; print the files written.

    Raises:
        UserError: If there is no such figure, or a planner or policies are named for one that
            shows none; if the file cannot be written, or is there and no figure of this command's.
    """
    from fuzzyq_bullet.figures import (
        FIGURES,
        LEARNED,
        MARK,
        OF_RUNS,
        drawing,
        drawing_learned,
        file_name,
    )
    from fuzzyq_bullet.files import refuse_inputs
    from fuzzyq_bullet.outputs import plugin_inputs, refuse_others_file

    definition = None
    if rules is not None:
        from fuzzyq_bullet.cli.rules import rules_given, tell_gaps

        if name not in ("4", "weights"):
            raise UserError(
                f"--rules: figure {shorten(name)} shows no controller; 4 and weights do"
            )
        definition = rules_given(rules)
        tell_gaps(definition, rules)
    known = {str(number): shows for number, shows in FIGURES.items()} | LEARNED
    if name not in known:
        told = "; ".join(f"{key} ({shows})" for key, shows in known.items())
        raise UserError(f"FIGURE: no figure {shorten(name)}; there are: {told}")
    given = policies or []
    if name in LEARNED:
        if planner is not None:
            raise UserError(f"--planner: {name} shows no run that a planner could drive")
        target, draw = out / file_name(name), drawing_learned(name, given, definition)
    else:
        number = int(name)
        if given:
            raise UserError(f"POLICY: figure {name} shows nothing that was learned")
        if planner is not None and number not in OF_RUNS:
            raise UserError(f"--planner: figure {name} shows no run that a planner could drive")
        variant = planner if rules is None else Path(rules).stem
        target, draw = (
            out / file_name(f"figure{name}", variant),
            drawing(number, planner, definition, variant),
        )
    refuse_inputs(
        [target], [*given, *([] if rules is None else [Path(rules)]), *plugin_inputs(plugin or [])]
    )
    if not replace:
        refuse_others_file(target, MARK)
    for path in draw(out):
        typer.echo(path)


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
    replace: ReplaceOthersOption = False,
) -> None:
    """Make one page of what the studies of fuzzyq bench wrote below DIR.

    It needs no server and no other file. Unfinished sweeps are shown as far as they are. Films are
    of runs made again from their seeds, and held to the digests of their rows.

    Raises:
        UserError: If DIR holds no sweep, one is damaged, or the page cannot be written, or is there
            and no page of this command's.
    """
    from fuzzyq_bullet.cli.options import progress_bar, say
    from fuzzyq_bullet.files import refuse_inputs, writable_files, write_text
    from fuzzyq_bullet.outputs import plugin_inputs, refuse_others_file
    from fuzzyq_bullet.studies.report.found import studies_below
    from fuzzyq_bullet.studies.report.markup import MARK

    found = studies_below(folder)
    target = folder / "report.html" if out is None else out
    (target,) = writable_files(target.parent, [target.name])
    sweeps = [(stage, swept) for one in found for stage, swept in one.results.items()]
    sources = [
        swept.folder / name
        for stage, swept in sweeps
        for name in ("settings.json", "journal.jsonl", f"{stage}.csv")
    ]
    refuse_inputs([target], [*sources, *plugin_inputs(plugin or [])])
    if not replace:
        refuse_others_file(target, MARK)

    from fuzzyq_bullet.figures import FIGURES
    from fuzzyq_bullet.studies.report.films import Film, Wanted, make, wanted_films
    from fuzzyq_bullet.studies.report.page import page

    wanted = wanted_films(found) if videos else {}
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
    command += "".join(f" --plugin {shlex.quote(name)}" for name in plugin or [])
    shown = page(
        folder,
        found,
        films if videos else None,
        pictures if figures else None,
        command,
        plugin or [],
    )
    write_text(target, shown)
    for _, swept in sweeps:
        if not swept.finished:
            say(f"{swept.folder}: {len(swept.rows)} of {swept.plan.total} episodes so far")
    other = sum(one.other for one in films.values())
    if other:
        say(f"{other} of {len(films)} runs came out otherwise than in their rows: see the page")
    shot = sum(one.problem is None for one in films.values())
    say(f"{shot} films, {len(pictures)} figures, {len(shown) / 1e6:.1f} MB")
    typer.echo(target)
