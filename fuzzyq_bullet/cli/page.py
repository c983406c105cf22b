"""``fuzzyq page``: a record, or two, as one HTML file to play, explore and change."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fuzzyq_bullet.cli.options import FOLDER, PluginOption, ReplaceOthersOption, RulesOption
from fuzzyq_bullet.errors import UserError

MOST_RECORDS = 2


def page(
    records: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="[RECORD] [RECORD]",
            help="A record (.npz) written by a run; two are shown side by side.",
        ),
    ] = None,
    *,
    lesson: Annotated[
        bool, typer.Option("--lesson", help="The fuzzy sets, rules and surface, without a record.")
    ] = False,
    rules: RulesOption = None,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Folder to write into; by default that of the first record; out for a lesson.",
            **FOLDER,
        ),
    ] = None,
    plugin: PluginOption = None,
    replace: ReplaceOthersOption = False,
) -> None:
    """Write an interactive page NAME.html: the run plays, and the controller can be changed.

    The page is one file. It needs no network and works on phones and projectors. Two records
    give NAME-and-OTHER.html; --lesson gives lesson.html, and with --rules my.yaml lesson-my.html.

    Raises:
        UserError: If there is nothing to show or too much, a record cannot be read, or the page
            cannot be written.
    """
    given = records or []
    if lesson and given:
        raise UserError(f"--lesson: takes no record; {given[0]} is one")
    if not lesson and not given:
        raise UserError("RECORD: missing; give a record, or two, or --lesson")
    if rules is not None and not lesson:
        raise UserError("--rules: a record has rules of its own; only --lesson takes others")
    if len(given) > MOST_RECORDS:
        raise UserError(f"RECORD: {len(given)} are too many; a page shows one or two")
    from fuzzyq_bullet.cli.rules import rules_given, tell_gaps
    from fuzzyq_bullet.files import refuse_inputs, writable_files, write_text
    from fuzzyq_bullet.outputs import plugin_inputs, refuse_others_file
    from fuzzyq_bullet.page import MARK, lesson_page, record_page
    from fuzzyq_bullet.recording.trajectory import Trajectory

    trajectories = [Trajectory.load(path) for path in given]
    folder = out or (given[0].parent if given else Path("out"))
    own = "" if rules is None else f"-{Path(rules).stem}"
    name = "-and-".join(path.stem for path in given) or f"lesson{own}"
    (path,) = writable_files(folder, [f"{name}.html"])
    read = [*given, *([] if rules is None else [Path(rules)])]
    refuse_inputs([path], [*read, *plugin_inputs(plugin or [])])
    if not replace:
        refuse_others_file(path, MARK)
    if lesson:
        definition = rules_given(rules)
        tell_gaps(definition, rules)
        write_text(path, lesson_page(definition))
    else:
        write_text(path, record_page(trajectories))
    typer.echo(path)
