"""``fuzzyq doctor``: whether a scenario is sound."""

from __future__ import annotations

from json import dumps
from typing import Annotated

import typer

from fuzzyq_bullet.cli.options import Json, PluginOption


def doctor(
    scenarios: Annotated[
        list[str],
        typer.Argument(metavar="SCENARIO...", help="Scenario files, or names of bundled ones."),
    ],
    *,
    plugin: PluginOption = None,
    json: Json = False,
) -> None:
    """Examine scenarios before anybody drives in them; one line for each finding.

    It looks whether the rays see what can be touched, whether the robot can turn in its start,
    whether there is a way to the goal and to each via point, and whether a gap is as wide as the
    robot. Exit code 1 if something is wrong; a note changes no exit code.

    Raises:
        UserError: If a scenario is wrong; nothing is examined then.
    """
    from fuzzyq_bullet.doctor import examine
    from fuzzyq_bullet.reading.problems import Problem
    from fuzzyq_bullet.scenario import load_scenario
    from fuzzyq_bullet.scenario.files import problem_lines

    told, healthy = [], True
    for file, scenario in [(file, load_scenario(file)) for file in scenarios]:
        lines = []
        for one in examine(scenario):
            [text] = problem_lines(file, [Problem(one.loc, one.message)])
            lines.append({"kind": one.kind, "wrong": one.wrong, "text": text})
        sound = not any(line["wrong"] for line in lines)
        healthy &= sound
        told.append({"scenario": scenario.name, "healthy": sound, "findings": lines})
        if not json:
            for line in lines:
                mark = "wrong" if line["wrong"] else "note "
                typer.echo(f"{mark}  {line['kind']:<5}  {line['text']}")
            if sound:
                typer.echo(f"ok     {scenario.name}")
    if json:
        typer.echo(dumps(told, indent=2))
    if not healthy:
        raise typer.Exit(1)
