"""``fuzzyq bench success``: how often each planner reaches the goal, by obstacles (Fig. 13)."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fuzzyq_bullet.cli.options import (
    FOLDER,
    Backend,
    Jobs,
    Json,
    PluginOption,
    Runs,
    Scheduler,
    SweepSeed,
)
from fuzzyq_bullet.errors import UserError

COUNTS = ",".join(map(str, range(5, 130, 5)))


def success(
    *,
    planners: Annotated[
        str, typer.Option(help="Planners to compare, with commas between.")
    ] = "fuzzy,improved-fuzzy,q-learning,q-lambda,fuzzy-q-lambda",
    counts: Annotated[
        str, typer.Option(help="Numbers of scattered obstacles; by default 5, 10, … 125.")
    ] = COUNTS,
    runs: Runs = 50,
    drive: Annotated[
        str, typer.Option(help="wheels (physics), or kinematic (the paper's point robot).")
    ] = "kinematic",
    seed: SweepSeed = 0,
    jobs: Jobs = None,
    backend: Backend = "loky",
    scheduler: Scheduler = None,
    out: Annotated[Path, typer.Option(help="Folder of the sweep.", **FOLDER)] = Path("out/success"),
    plugin: PluginOption = None,
    json: Json = False,
) -> None:
    """Run the planners in the same random fields; print how often each reaches the goal.

    May be ended at any moment: the same command goes on where it was. Writes success.csv, a row for
    every episode, success.json and success.png. Fixed weights are the paper's 0.5/0.5.

    Raises:
        UserError: If an option is wrong, the folder holds a sweep with other settings, or the
            scheduler cannot be used.
    """
    from fuzzyq_bullet.cli.console import say
    from fuzzyq_bullet.cli.sweep import (
        counts_of,
        one_drive_of,
        planners_of,
        pool_of,
        seed_of,
        sweep_bar,
    )
    from fuzzyq_bullet.experiments.success.plan import M_S, Plan

    seed_of(seed)
    numbers = counts_of(counts, "--counts")
    if not numbers:
        raise UserError("--counts: none leaves nothing to run")
    plan = Plan(planners_of(planners), one_drive_of(drive), numbers, runs, seed)
    described = plan.described()

    from fuzzyq_bullet.experiments.success.episode import run_row
    from fuzzyq_bullet.experiments.sweep.run import sweep
    from fuzzyq_bullet.files import writable_files, write_text
    from fuzzyq_bullet.outputs import plugin_settings
    from fuzzyq_bullet.version import __version__

    settings = {"sweep": "success", "version": __version__, **described}
    settings.update(plugin_settings(plugin or []))
    with pool_of(backend, scheduler, jobs, plugin or []) as pool:
        text, image = writable_files(out, ["success.json", "success.png"])
        with sweep_bar() as progress:
            done = sweep(
                "success", plan.jobs(), out, settings, pool=pool, work=run_row, progress=progress
            )

    from fuzzyq_bullet.experiments.success.picture import draw
    from fuzzyq_bullet.experiments.success.show import WIDTH, as_json, as_tables
    from fuzzyq_bullet.experiments.success.table import summary_of

    summary = summary_of(done.rows)
    shown = as_json(summary, settings)
    write_text(text, shown + "\n")
    about = f"{plan.drive}; seed {seed}; walled 10 × 10 m"
    draw(summary, f"Success by planner: {about}, {runs} environments each", image)
    if json:
        typer.echo(shown)
    else:
        from rich.console import Console

        # A narrow terminal may break lines, but no figure is cut off.
        width = max(WIDTH, Console().width)
        Console(highlight=False, width=width).print(as_tables(summary, f"{about}.", M_S))
    state = done.state
    say(
        f"{state.ran} episodes in {state.seconds:.1f} s: {state.rate:.2f} episodes/s; "
        f"{state.done - state.ran} were there already"
    )
    for path in (done.table, text, image):
        say(f"  {path}")
    errors = sum(row.outcome == "error" for row in done.rows)
    if errors:
        say(f"{errors} episodes failed themselves: see the column error", style="bold")
        raise typer.Exit(1)
