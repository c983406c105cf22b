"""``fuzzyq bench steps``: how many steps each planner takes to the goal (Table 5)."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fuzzyq_bullet.cli.options import (
    FOLDER,
    Backend,
    Jobs,
    Json,
    PluginOption,
    Scheduler,
    SweepSeed,
)
from fuzzyq_bullet.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fuzzyq_bullet.experiments.sweep.jobs import Job
    from fuzzyq_bullet.experiments.sweep.rows import Row
    from fuzzyq_bullet.experiments.sweep.workers import Pool
    from fuzzyq_bullet.planning.fuzzy_q_lambda import Weights
    from fuzzyq_bullet.scenario import Drive


def steps(
    *,
    runs: Annotated[int, typer.Option(min=1, max=100_000, help="Environments.")] = 20,
    count: Annotated[int, typer.Option(min=0, max=10_000, help="Obstacles in each.")] = 50,
    pair: Annotated[
        str | None,
        typer.Option(help="The best fixed pair ω1,ω2; by default it is searched for."),
    ] = None,
    grid: Annotated[
        int, typer.Option(min=1, max=10_000, help="Training environments to search it on.")
    ] = 48,
    drive: Annotated[
        str, typer.Option(help="wheels (physics), or kinematic (the paper's steps).")
    ] = "kinematic",
    seed: SweepSeed = 0,
    jobs: Jobs = None,
    backend: Backend = "loky",
    scheduler: Scheduler = None,
    out: Annotated[Path, typer.Option(help="Folder of the sweeps.", **FOLDER)] = Path("out/steps"),
    plugin: PluginOption = None,
    json: Json = False,
) -> None:
    """Print the mean number of steps to the goal beside the paper's, and what failures do to it.

    The paper's five planners, and the improved fuzzy one with fixed weights: 1/1, and the best pair
    on environments of the training. May be ended at any moment: the same command goes on where it
    was. Writes table/steps.csv, a row for every episode, and steps.json.

    Raises:
        UserError: If an option is wrong, the folder holds a sweep with other settings, or the
            scheduler cannot be used.
    """
    from fuzzyq_bullet.cli.sweep import one_drive_of, pool_of, seed_of

    seed_of(seed)
    moved_by = one_drive_of(drive)
    given = None if pair is None else _pair_of(pair)

    from fuzzyq_bullet.files import writable_files, write_text
    from fuzzyq_bullet.outputs import plugin_settings

    plugins = plugin_settings(plugin or [])
    with pool_of(backend, scheduler, jobs, plugin or []) as pool:
        (text,) = writable_files(out, ["steps.json"])
        best, searched = (given, None) if given else _search(moved_by, grid, out, plugins, pool)

        from fuzzyq_bullet.experiments.steps.plan import contenders, roles
        from fuzzyq_bullet.experiments.success.plan import M_S, Plan

        plan = Plan(contenders(best), moved_by, (count,), runs, seed)
        rows = _swept("steps", plan.jobs(), plan.described() | plugins, out / "table", pool)

    import numpy as np

    from fuzzyq_bullet.experiments.steps.show import WIDTH, as_json, as_tables
    from fuzzyq_bullet.experiments.steps.table import summary_of

    kinematic = moved_by == "kinematic"
    summary = summary_of(rows, roles(best), M_S if kinematic else None, np.random.default_rng(seed))
    how = "given" if searched is None else f"best on {grid} environments of the training"
    settings = {"search": searched, "table": plan.described()}
    shown = as_json(summary, settings, M_S)
    write_text(text, shown + "\n")
    if json:
        typer.echo(shown)
    else:
        from rich.console import Console

        about = (
            f"{moved_by}; seed {seed}; {count} obstacles, walled 10 × 10 m; improved-fuzzy has "
            f"weights 0.5/0.5; the pair {best.step:g}/{best.turn:g} was {how}."
        )
        width = max(WIDTH, Console().width)
        Console(highlight=False, width=width).print(as_tables(summary, about, M_S, kinematic))
    from fuzzyq_bullet.cli.console import say

    for path in (out / "table" / "steps.csv", text):
        say(f"  {path}")
    errors = sum(row.outcome == "error" for row in rows)
    if errors:
        say(f"{errors} episodes failed themselves: see the column error", style="bold")
        raise typer.Exit(1)


def _pair_of(text: str) -> Weights:
    """Return the weights that ``--pair`` gives, with the usual c_f."""
    from fuzzyq_bullet.cli.sweep import planner_of
    from fuzzyq_bullet.experiments.learning_gain.candidates import USUAL_BREAKOUT
    from fuzzyq_bullet.planning import ImprovedFuzzySettings
    from fuzzyq_bullet.planning.fuzzy_q_lambda import Weights

    try:
        settings = planner_of("improved-fuzzy", text)
    except UserError as error:
        told = (problem.replace("--weights", "--pair") for problem in error.problems)
        raise UserError(*told) from error
    assert isinstance(settings, ImprovedFuzzySettings)
    return Weights(*settings.weights, USUAL_BREAKOUT)


def _search(
    drive: Drive, grid: int, out: Path, plugins: dict[str, Any], pool: Pool
) -> tuple[Weights, dict[str, Any]]:
    """Find the best fixed pair on environments of the training, never on those of the table."""
    from fuzzyq_bullet.cli.console import say
    from fuzzyq_bullet.experiments.learning_gain.candidates import PAIRS, words_of
    from fuzzyq_bullet.experiments.learning_gain.choice import best_of
    from fuzzyq_bullet.experiments.learning_gain.plan import Search, learned_settings
    from fuzzyq_bullet.planning.fuzzy_q_lambda import POLICY_SPEC
    from fuzzyq_bullet.planning.policies import policy_of

    learned = policy_of(learned_settings(None), POLICY_SPEC)
    search = Search(drive, learned.seed, grid, PAIRS)
    rows = _swept("grid", search.jobs(), search.described() | plugins, out / "grid", pool)
    best = best_of(rows, PAIRS).best
    say(f"best pair on the training's environments: {words_of(best)}")
    return best, search.described()


def _swept(
    name: str, jobs: Sequence[Job], described: dict[str, Any], out: Path, pool: Pool
) -> tuple[Row, ...]:
    """Run one of the two sweeps in a folder of its own, and say how it went."""
    from fuzzyq_bullet.cli.console import say
    from fuzzyq_bullet.cli.sweep import sweep_bar
    from fuzzyq_bullet.experiments.success.episode import run_row
    from fuzzyq_bullet.experiments.sweep.run import sweep
    from fuzzyq_bullet.version import __version__

    settings = {"sweep": f"steps {name}", "version": __version__, **described}
    with sweep_bar() as progress:
        done = sweep(name, jobs, out, settings, pool=pool, work=run_row, progress=progress)
    state = done.state
    say(
        f"{name}: {state.ran} episodes in {state.seconds:.1f} s: {state.rate:.2f} episodes/s; "
        f"{state.done - state.ran} were there already"
    )
    return done.rows
