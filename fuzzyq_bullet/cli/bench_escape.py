"""``fuzzyq bench escape``: does the planner find a way wherever there is one, touching nothing?"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fuzzyq_bullet.cli.options import FOLDER, Jobs, Json, PluginOption, Runs, SweepSeed
from fuzzyq_bullet.errors import UserError


def escape(
    *,
    runs: Runs = 50,
    counts: Annotated[
        str, typer.Option(help="Numbers of scattered obstacles, or none.")
    ] = "5,25,50,75,100,125",
    traps: Annotated[
        int,
        typer.Option(min=0, max=100_000, help="Semicircles, arcs, U-shapes and walls, in turn."),
    ] = 100,
    rectangles: Annotated[str, typer.Option(help="Numbers of rectangles, or none.")] = "30,40,60",
    drive: Annotated[str, typer.Option(help="wheels (physics), kinematic, or both.")] = "both",
    planner: Annotated[str, typer.Option(help="Planner to ask.")] = "improved-fuzzy",
    weights: Annotated[
        str | None, typer.Option(help="Its weights ω1,ω2; 1,1 where it takes any.")
    ] = None,
    seed: SweepSeed = 0,
    jobs: Jobs = None,
    out: Annotated[Path, typer.Option(help="Folder of the sweep.", **FOLDER)] = Path("out/escape"),
    plugin: PluginOption = None,
    json: Json = False,
) -> None:
    """Run a planner in random fields, traps and rectangles; print how often it finds its way.

    May be ended at any moment: the same command goes on where it was. Writes escape.csv, a row for
    every episode, and in records/ those that failed although there was a way, for fuzzyq replay.
    Exit code 1 when a target is missed.

    Raises:
        UserError: If an option is wrong, or the folder holds a sweep with other settings.
    """
    from fuzzyq_bullet.cli.console import say
    from fuzzyq_bullet.cli.sweep import counts_of, drives_of, planner_of, seed_of, sweep_bar
    from fuzzyq_bullet.experiments.escape.plan import Plan

    seed_of(seed)
    plan = Plan(
        settings=planner_of(planner, weights),
        drives=drives_of(drive),
        runs=runs,
        counts=counts_of(counts, "--counts"),
        traps=traps,
        rectangles=counts_of(rectangles, "--rectangles"),
        seed=seed,
    )
    tasks = plan.jobs()
    if not tasks:
        raise UserError("nothing to run: --counts, --traps and --rectangles all ask for none")

    from fuzzyq_bullet.experiments.escape.show import as_json, as_table
    from fuzzyq_bullet.experiments.escape.table import table_of
    from fuzzyq_bullet.experiments.sweep.run import sweep
    from fuzzyq_bullet.experiments.sweep.workers import Pool
    from fuzzyq_bullet.outputs import plugin_settings
    from fuzzyq_bullet.version import __version__

    settings = {"sweep": "escape", "version": __version__, **plan.described()}
    settings.update(plugin_settings(plugin or []))
    with sweep_bar() as progress:
        done = sweep(
            "escape",
            tasks,
            out,
            settings,
            pool=Pool(jobs, plugins=tuple(plugin or [])),
            progress=progress,
        )
    lines = table_of(done.rows)
    if json:
        typer.echo(as_json(lines, settings, done.state.rate))
    else:
        from rich.console import Console

        given = getattr(plan.settings, "weights", None)
        named = planner if given is None else f"{planner} with weights ({given[0]:g}, {given[1]:g})"
        Console(highlight=False).print(as_table(lines, named, seed))
    state = done.state
    say(
        f"{state.ran} episodes in {state.seconds:.1f} s: {state.rate:.2f} episodes/s; "
        f"{state.done - state.ran} were there already"
    )
    for path in (done.table, *([out / "records"] if any((out / "records").iterdir()) else [])):
        say(f"  {path}")
    errors = sum(one.errors for line in lines for one in line.drives.values())
    if errors:
        say(f"{errors} episodes failed themselves: see the column error", style="bold")
    missed = [
        f"{line.family}{'' if line.count is None else f' {line.count}'}, {target.drive}: "
        f"{target.what} {target.figure:.4g} instead of {target.sense} {target.bound:g}"
        for line in lines
        for target in line.targets
        if not target.met
    ]
    if missed:
        say("targets missed: " + "; ".join(missed), style="bold")
        raise typer.Exit(1)
