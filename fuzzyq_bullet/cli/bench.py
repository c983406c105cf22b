"""``fuzzyq bench``: measurements of the project, of its speed and of what it achieves.

Every study that is registered has a command here, made from its fields (``studies.study``).
"""

from __future__ import annotations

import inspect
from itertools import pairwise
from pathlib import Path
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from fuzzyq_bullet.cli.options import (
    FOLDER,
    Backend,
    Jobs,
    Json,
    PluginOption,
    ReplaceOthersOption,
    Scheduler,
    help_of,
    progress_bar,
    say,
)
from fuzzyq_bullet.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from fuzzyq_bullet.studies.study import Study


class _Studies(TyperGroup):
    """The studies as commands; none is imported before somebody asks for it."""

    def list_commands(self, ctx: Any) -> list[str]:
        from fuzzyq_bullet.studies.registry import study_names

        return [*super().list_commands(ctx), *study_names()]

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        from fuzzyq_bullet.studies.registry import study_names, study_of

        if cmd_name not in study_names():
            return super().get_command(ctx, cmd_name)
        holder = typer.Typer(add_completion=False, rich_markup_mode="markdown")
        command = _command_of(study_of(cmd_name))
        holder.command(cmd_name, help=help_of(command))(command)
        return typer.main.get_command(holder)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        if self.get_command(ctx, args[0]) is None:  # perhaps one of a plugin's
            from fuzzyq_bullet.plugins import load_plugins

            load_plugins(_plugins_in(args))
            from fuzzyq_bullet.studies.registry import study_names

            for name in study_names():  # among which a misspelt one is looked for
                self.commands.setdefault(name, self.get_command(ctx, name))
        return super().resolve_command(ctx, args)


app = typer.Typer(cls=_Studies, help="Measure the project itself.", no_args_is_help=True)


@app.callback()
def _bench() -> None:
    pass


def speed(
    *,
    rounds: Annotated[int, typer.Option(min=1, max=100, help="Interleaved rounds.")] = 7,
    rate: Annotated[
        int, typer.Option(help="Decisions a simulated second: a divisor of 240, at most 80.")
    ] = 20,
    json: Json = False,
) -> None:
    """Measure the speed of episodes, films and the controller against what they should reach.

    Exit code 1 when an aim is missed.

    Raises:
        UserError: If the rate is not allowed.
    """
    from fuzzyq_bullet.studies.speed import MEASUREMENTS, as_json, as_table

    if not 1 <= rate <= 80 or 240 % rate:
        raise UserError(f"--rate: must divide 240 and be from 1 to 80, got {rate}")

    rows = []
    with progress_bar("measuring", len(MEASUREMENTS)) as (progress, bar):
        for name, measure in MEASUREMENTS.items():
            progress.update(bar, note=name)
            rows += resolve_name(measure)(rounds, rate)
            progress.advance(bar)
    if json:
        typer.echo(as_json(rows))
    else:
        from rich.console import Console

        Console(highlight=False).print(as_table(rows))
    missed = [row for row in rows if not row.met]
    if missed:
        say("aims missed: " + "; ".join(row.what for row in missed), style="bold")
        raise typer.Exit(1)


app.command("speed", help=help_of(speed))(speed)


def _plugins_in(args: Sequence[str]) -> list[str]:
    """Return what ``--plugin`` names in words of a command line that nobody has parsed yet."""
    named = [after for word, after in pairwise(args) if word == "--plugin"]
    return named + [word.partition("=")[2] for word in args if word.startswith("--plugin=")]


def _command_of(study: type[Study]) -> Callable[..., None]:
    """Return the command of a study: its fields are options, beside those that all have."""

    def command(
        *,
        jobs: Jobs = None,
        backend: Backend = "loky",
        scheduler: Scheduler = None,
        out: Annotated[Path, typer.Option(help="Folder of the study.", **FOLDER)] = Path(),
        plugin: PluginOption = None,
        replace: ReplaceOthersOption = False,
        json: Json = False,
        **given: Any,
    ) -> None:
        from fuzzyq_bullet.cli.study import run_study

        asked, where = _asked(study, given), (backend, scheduler, jobs)
        run_study(asked, out, where, plugin or [], replace=replace, json=json)

    fields = sorted(study.model_fields.items(), key=lambda one: one[0] == "seed")
    options = [
        inspect.Parameter(
            name,
            inspect.Parameter.KEYWORD_ONLY,
            default=field.default,
            annotation=Annotated[field.annotation, _option_of(name, field)],
        )
        for name, field in fields
    ]
    hints = inspect.signature(command, eval_str=True).parameters
    common = [one for one in hints.values() if one.kind is not inspect.Parameter.VAR_KEYWORD]
    common = [
        one.replace(default=Path("out") / study.name) if one.name == "out" else one
        for one in common
    ]
    command.__doc__ = study.__doc__
    command.__signature__ = inspect.Signature([*options, *common])  # type: ignore[attr-defined]
    command.__annotations__ = {one.name: one.annotation for one in (*options, *common)}
    return command


def _asked(study: type[Study], given: dict[str, Any]) -> Study:
    """Return the study with what was given.

    Raises:
        UserError: If an option is wrong.
    """
    from pydantic import ValidationError

    from fuzzyq_bullet.reading.problems import problem_of

    least, most = (_bounds(study.model_fields["seed"])[name] for name in ("min", "max"))
    if not least <= given["seed"] <= most:
        raise UserError(f"--seed: must be from {least} to {most}, got {given['seed']}")
    try:
        return study(**given)
    except ValidationError as error:
        first: dict[str, Any] = dict(error.errors(include_url=False)[0])
        name = str(first["loc"][0]).replace("_", "-") if first["loc"] else study.name
        told = problem_of(first, tuple(first["loc"]), ()).message
        raise UserError(f"--{name}: {told}") from error


def _bounds(field: Any) -> dict[str, Any]:
    return {
        name: getattr(one, key)
        for one in field.metadata
        for key, name in (("ge", "min"), ("le", "max"))
        if hasattr(one, key)
    }


def _option_of(name: str, field: Any) -> Any:
    """Return what the command line has to know of a field."""
    bounds = {} if name == "seed" else _bounds(field)  # whose bounds are longer than the help
    usual = "FILE" if field.annotation == Path | None else None
    metavar = (field.json_schema_extra or {}).get("metavar", usual)
    # A list is shown with spaces, at which its lines break; without them it would be cut off.
    shown = field.default.replace(",", ", ") if "," in str(field.default) else True
    return typer.Option(help=field.description, metavar=metavar, show_default=shown, **bounds)
