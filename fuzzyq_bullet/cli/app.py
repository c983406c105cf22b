"""All commands of ``fuzzyq`` in one place, and what every mistake of a user becomes."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import typer

from fuzzyq_bullet.cli import (
    bench,
    check,
    doctor,
    explain,
    export,
    page,
    race,
    report,
    robots,
    run,
    scenarios,
    train,
    watch,
)
from fuzzyq_bullet.cli.options import help_of
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.version import __version__

app = typer.Typer(
    name="fuzzyq",
    help="A robot finds its way among obstacles it has never seen, and shows why it turned.",
    epilog="Exit codes: 0 all well; 1 it ran and the verdict is bad; 2 the input is wrong; "
    "130 interrupted (143 by SIGTERM).",
    add_completion=False,
    rich_markup_mode="markdown",  # the lines of a paragraph flow
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _add(name: str, command: Callable[..., None], **settings: Any) -> None:
    app.command(name, help=help_of(command), **settings)(command)


_add("run", run.run)
_add("replay", run.replay)
_add("watch", watch.watch)
_add("page", page.page)
_add("race", race.race)
_add("export", export.export)
_add("check", check.check)
_add("doctor", doctor.doctor)
_add("import", scenarios.import_map)
_add("validate", scenarios.validate)
_add("schema", scenarios.schema)
_add("list", scenarios.list_scenarios)
_add("robots", robots.robots)
_add("train", train.train)
_add("explain", explain.explain, context_settings=explain.CONTEXT_SETTINGS)
_add("figure", report.figure)
_add("report", report.report)
app.add_typer(bench.app, name="bench")


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(__version__)
        raise typer.Exit


@app.callback()
def _global_options(
    version: bool = typer.Option(
        False, "--version", callback=_show_version, is_eager=True, help="Print the version."
    ),
) -> None:
    pass


def call() -> int:
    """Do what ``sys.argv`` asks for and return the exit code.

    Raises:
        UserError: If what was asked for is wrong.
    """
    try:
        status = app(sys.argv[1:], prog_name="fuzzyq", standalone_mode=False)
    except typer.TyperException as error:  # an unknown option, a missing argument, ...
        if isinstance(error, typer.BadParameter):
            error.message = _in_words(error)
        message = " ".join(error.format_message().split())
        if not message:  # a command that only has others below it has shown its help
            return 0
        context = getattr(error, "ctx", None)
        help_at = context.command_path if context is not None else "fuzzyq"
        raise UserError(f"{message.rstrip('.')} (see {help_at} --help)") from error
    except OSError as error:  # a temporary folder that is full, a file that went away, ...
        what = f"{error.filename}: " if error.filename else ""
        raise UserError(f"{what}{error.strerror or error}") from error
    return status if isinstance(status, int) else 0


def _in_words(error: typer.BadParameter) -> str:
    """Return what is wrong with the value of an option, in the words that files' mistakes have."""
    from pydantic import ValidationError

    from fuzzyq_bullet.reading.problems import problem_of

    cause = error.__cause__
    if not isinstance(cause, ValidationError):
        return error.message
    first: dict[str, Any] = dict(cause.errors(include_url=False)[0])
    if {"ge", "gt", "le", "lt"} & first.get("ctx", {}).keys():  # a number, though given as text
        number = float(first["input"])
        first["input"] = int(number) if number.is_integer() else number
    return problem_of(first, (), ()).message
