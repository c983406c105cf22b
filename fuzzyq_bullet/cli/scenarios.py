"""``fuzzyq validate``, ``schema`` and ``list``: scenario files without running them."""

from __future__ import annotations

from json import dumps
from typing import Annotated

import typer

from fuzzyq_bullet.errors import UserError


def validate(
    files: Annotated[
        list[str],
        typer.Argument(metavar="FILE...", help="Scenario files, or names of bundled ones."),
    ],
) -> None:
    """Check scenario files; name every mistake with its file, line and key.

    Raises:
        UserError: If any of them is wrong; one line a mistake.
    """
    from fuzzyq_bullet.cli.console import say

    problems: list[str] = []
    for file in files:
        found = _problems_of(file)
        if not found:
            say(f"{file}: ok")
        problems += found
    if problems:
        raise UserError(*problems)


def _problems_of(file: str) -> tuple[str, ...]:
    from fuzzyq_bullet.scenario import load_scenario, realise

    try:
        realise(load_scenario(file))
    except UserError as error:
        return error.problems
    return ()


def schema() -> None:
    """Print the JSON Schema of scenario files."""
    from fuzzyq_bullet.scenario import scenario_schema

    typer.echo(dumps(scenario_schema(), indent=2))


def list_scenarios(
    *, json: Annotated[bool, typer.Option("--json", help="As JSON on stdout, alone.")] = False
) -> None:
    """List the bundled scenarios."""
    from fuzzyq_bullet.scenario import bundled_scenarios

    bundled = bundled_scenarios()
    if json:
        typer.echo(dumps(bundled, indent=2))
        return
    width = max(map(len, bundled), default=0)
    for name, description in bundled.items():
        typer.echo(f"{name:<{width}}  {' '.join(description.split())}".rstrip())
