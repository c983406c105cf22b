"""``fuzzyq validate``, ``import``, ``schema`` and ``list``: scenario files without running them."""

from __future__ import annotations

from json import dumps
from pathlib import Path
from typing import Annotated

import typer

from fuzzyq_bullet.cli.options import FILE, Json, PluginOption
from fuzzyq_bullet.errors import UserError

ProcessOption = Annotated[
    bool,
    typer.Option("--process", help="Of what the planner process and its program say, instead."),
]


def validate(
    files: Annotated[
        list[str],
        typer.Argument(metavar="FILE...", help="Scenario files, or names of bundled ones."),
    ],
    *,
    plugin: PluginOption = None,
) -> None:
    """Check scenario files; name every mistake with its file, line and key.

    What is allowed and yet hardly meant is told as a warning, which changes no exit code.

    Raises:
        UserError: If any of them is wrong; one line a mistake.
    """
    from fuzzyq_bullet.cli.options import say

    problems: list[str] = []
    for file in files:
        found, warnings = _look_at(file)
        if not found:
            say(f"{file}: ok")
        for warning in warnings:
            say(f"warning: {warning}")
        problems += found
    if problems:
        raise UserError(*problems)


def _look_at(file: str) -> tuple[tuple[str, ...], list[str]]:
    """Return what is wrong with a file, and what is allowed and yet hardly meant."""
    from fuzzyq_bullet.early_warnings import early_warnings
    from fuzzyq_bullet.scenario import load_scenario, realise

    try:
        scenario = load_scenario(file)
        return (), early_warnings(file, scenario, realise(scenario))
    except UserError as error:
        return error.problems, []


def import_map(
    file: Annotated[
        Path,
        typer.Argument(metavar="FILE", help="A map; suffix and content choose the importer."),
    ],
    *,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Scenario file to write; by default FILE as .yaml (of YAML: .scenario.yaml).",
            **FILE,
        ),
    ] = None,
    resolution: Annotated[
        float | None, typer.Option(metavar="M", help="Size of a pixel or cell (m).")
    ] = None,
    start: Annotated[
        str | None,
        typer.Option(metavar="X,Y[,HEADING]", help="Where the robot starts (m), and faces (rad)."),
    ] = None,
    goal: Annotated[
        str | None, typer.Option(metavar="X,Y", help="Where the robot must stop (m).")
    ] = None,
    crop: Annotated[
        str | None,
        typer.Option(metavar="X0,Y0,X1,Y1", help="Keep this part of the map alone (m)."),
    ] = None,
    unknown: Annotated[
        str, typer.Option(help="What unknown cells of a ROS map are: blocked, or free.")
    ] = "blocked",
    number: Annotated[
        int, typer.Option(min=1, help="Which task of a .scen file, counted from 1.")
    ] = 1,
    robot: Annotated[
        str | None, typer.Option(metavar="MODEL", help="The robot's model: a name, or a URDF file.")
    ] = None,
    left_wheel: Annotated[
        str | None,
        typer.Option(metavar="JOINT", help="The left wheel's joint in that URDF."),
    ] = None,
    right_wheel: Annotated[
        str | None,
        typer.Option(metavar="JOINT", help="The right wheel's joint in that URDF."),
    ] = None,
    plugin: PluginOption = None,
    replace: Annotated[
        bool, typer.Option("--replace", help="Replace a file that is there already.")
    ] = False,
) -> None:
    """Make a scenario file from a map, and print its path.

    Reads ROS maps, Gazebo worlds, pictures, MovingAI maps and tasks, and worlds of ir-sim
    (docs/how-to/maps.md). What the scenario cannot hold, or has otherwise, is named on stderr and
    at the head of the file.

    Raises:
        UserError: If there is no importer for the map, it is wrong, or the file cannot be written.
    """
    from fuzzyq_bullet.cli.options import say
    from fuzzyq_bullet.errors import printable
    from fuzzyq_bullet.files import refuse_inputs, writable_files, write_text
    from fuzzyq_bullet.outputs import plugin_inputs
    from fuzzyq_bullet.scenario import dump_scenario
    from fuzzyq_bullet.scenario.importers import ImportOptions, import_map, options_of
    from fuzzyq_bullet.scenario.robot import URDF

    target = out or Path(f"{file.stem}.yaml")
    if out is None and target.resolve() == file.resolve():  # a map that is YAML, and lies here
        target = target.with_suffix(".scenario.yaml")
    writable_files(target.parent, [target.name])
    urdf = [Path(robot)] if robot is not None and robot.endswith(URDF) else []
    refuse_inputs([target], [file, *urdf, *plugin_inputs(plugin or [])])
    if target.exists() and not replace:
        raise UserError(f"{target}: is there already; --replace replaces it, --out names another")
    options: ImportOptions = options_of(
        resolution=resolution,
        start=start,
        goal=goal,
        crop=crop,
        unknown=unknown,
        number=number,
        robot=robot,
        left_wheel=left_wheel,
        right_wheel=right_wheel,
    )
    imported = import_map(file, options)
    notes = [printable(line) for line in imported.notes()]
    head = [f"Imported from {printable(file.name)}.", *notes]
    lines = "".join(f"# {line}\n" for line in head) if notes else ""
    text = dump_scenario(imported.scenario, defaults=False, folder=target.parent)
    write_text(target, lines + text)
    for note in notes:
        say(note)
    typer.echo(target)


def schema(
    *,
    markdown: Annotated[
        bool, typer.Option("--markdown", help="As a page that explains every key instead.")
    ] = False,
    process: ProcessOption = False,
    plugin: PluginOption = None,
) -> None:
    """Print the JSON Schema of scenario files, with what plugins add to them."""
    if process:
        from fuzzyq_bullet.planning.process.messages import process_schema

        typer.echo(dumps(process_schema(), indent=2))
        return
    from fuzzyq_bullet.scenario import scenario_schema
    from fuzzyq_bullet.scenario.reference import scenario_reference

    typer.echo(scenario_reference() if markdown else dumps(scenario_schema(), indent=2))


def list_scenarios(*, json: Json = False) -> None:
    """List the bundled scenarios."""
    from fuzzyq_bullet.scenario import bundled_scenarios

    bundled = bundled_scenarios()
    if json:
        typer.echo(dumps(bundled, indent=2))
        return
    width = max(map(len, bundled), default=0)
    for name, description in bundled.items():
        typer.echo(f"{name:<{width}}  {' '.join(description.split())}".rstrip())
