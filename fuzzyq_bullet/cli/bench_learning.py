"""``fuzzyq bench learning``: what learned weights gain over fixed ones, where none were learned."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fuzzyq_bullet.cli.options import FOLDER, Jobs, Json, SweepSeed
from fuzzyq_bullet.errors import UserError

if TYPE_CHECKING:
    from fuzzyq_bullet.experiments.learning_gain.plan import Comparison, Search
    from fuzzyq_bullet.experiments.sweep.run import Sweep

MOST = 10_000


def learning(
    *,
    environments: Annotated[
        int, typer.Option(min=1, max=MOST, help="Environments to compare on.")
    ] = 200,
    counts: Annotated[
        str, typer.Option(help="Their numbers of scattered obstacles, in turn.")
    ] = "25,50,75,100",
    grid: Annotated[
        int, typer.Option(min=1, max=MOST, help="Training environments to find the best fixed on.")
    ] = 48,
    policy: Annotated[
        Path | None, typer.Option(metavar="FILE", help="What was learned; else what is shipped.")
    ] = None,
    drive: Annotated[str, typer.Option(help="wheels (physics), or kinematic.")] = "wheels",
    seed: SweepSeed = 0,
    jobs: Jobs = None,
    out: Annotated[Path, typer.Option(help="Folder of both sweeps.", **FOLDER)] = Path(
        "out/learning"
    ),
    json: Json = False,
) -> None:
    """Compare learned weights with the best fixed ones, on environments that no training saw.

    First every pair (ω1, ω2) and triple (ω1, ω2, c_f) is tried on the environments of the training,
    then the best of them, 0.5/0.5, 1/1 and the learned planner meet on others. May be ended at any
    moment: the same command goes on where it was. Writes grid/grid.csv, comparison/comparison.csv,
    learning.json and learning.png. Exit code 1 when a target is missed.

    Raises:
        UserError: If an option is wrong, the policy cannot be used, or the folder holds a sweep
            with other settings.
    """
    from fuzzyq_bullet.cli.console import say
    from fuzzyq_bullet.cli.sweep import counts_of, one_drive_of
    from fuzzyq_bullet.experiments.learning_gain.plan import (
        MOST_SEED,
        Comparison,
        Search,
        learned_settings,
        unseen,
    )
    from fuzzyq_bullet.planning.fuzzy_q_lambda import POLICY_SPEC
    from fuzzyq_bullet.planning.policies import policy_of
    from fuzzyq_bullet.training.tasks import FIRST_SEED

    if not 0 <= seed <= MOST_SEED:
        raise UserError(f"--seed: must be from 0 to {MOST_SEED}, got {seed}")
    numbers = counts_of(counts, "--counts")
    if not numbers:
        raise UserError("--counts: none leaves nothing to compare on")
    moved_by = one_drive_of(drive)
    settings = learned_settings(policy)
    learned = policy_of(settings, POLICY_SPEC)

    from fuzzyq_bullet.experiments.learning_gain import candidates
    from fuzzyq_bullet.experiments.learning_gain.choice import best_of
    from fuzzyq_bullet.files import writable_files, write_text

    text, image = writable_files(out, ["learning.json", "learning.png"])
    search = Search(moved_by, learned.seed, grid)
    tried = _swept("grid", search, out, jobs)
    choices = {
        "best pair": best_of(tried.rows, candidates.PAIRS),
        "best triple": best_of(tried.rows, candidates.TRIPLES),
    }
    for role, choice in choices.items():
        say(f"{role} on the training's environments: {candidates.words_of(choice.best)}")

    chosen = [candidates.HALF, candidates.ONE, *(choice.best for choice in choices.values())]
    comparison = Comparison(
        drive=moved_by,
        seed=seed,
        number=environments,
        counts=numbers,
        fixed=tuple(dict.fromkeys(chosen)),
        learned=settings,
        policy=learned,
    )
    least, greatest = unseen(comparison.environments)
    say(
        f"no training saw any of the {environments} environments: their seeds are {least} to "
        f"{greatest}, those of trainings begin at {FIRST_SEED}"
    )
    done = _swept("comparison", comparison, out, jobs)

    import numpy as np

    from fuzzyq_bullet.experiments.learning_gain.picture import draw
    from fuzzyq_bullet.experiments.learning_gain.show import WIDTH, as_json, as_tables
    from fuzzyq_bullet.experiments.learning_gain.table import summary_of, time_ratios

    roles = dict(zip(("0.5/0.5", "1/1", *choices), map(candidates.label_of, chosen), strict=True))
    summary = summary_of(done.rows, roles, "best pair", np.random.default_rng(seed))
    same = search.tasks.digest() == learned.scenario
    about = (
        f"{moved_by}; seed {seed}; {', '.join(map(str, numbers))} obstacles in turn, walled 10 × "
        f"10 m; policy of {learned.episodes} episodes, seed {learned.seed}, {learned.drive}; best "
        f"weights of {len(candidates.TRIPLES)} on {choices['best pair'].feasible} environments "
        f"{'of that training' if same else 'with training seeds, not those it learned on'}."
    )
    shown = as_json(
        summary,
        choices,
        {"search": search.described(), "comparison": comparison.described(), "same_tasks": same},
        {"least": least, "greatest": greatest, "first_of_trainings": FIRST_SEED},
    )
    write_text(text, shown + "\n")
    title = f"What learning gains: {moved_by}, {summary.feasible} environments that no training saw"
    draw(summary, time_ratios(done.rows, roles["best pair"]), title, image)
    if json:
        typer.echo(shown)
    else:
        from rich.console import Console

        # A narrow terminal may break lines, but no figure is cut off.
        width = max(WIDTH, Console().width)
        Console(highlight=False, width=width).print(as_tables(summary, about))
    for path in (tried.table, done.table, text, image):
        say(f"  {path}")
    missed = [str(one) for one in summary.targets if not one.met]
    if missed:
        say("targets missed: " + "; ".join(missed), style="bold")
        raise typer.Exit(1)


def _swept(name: str, plan: Search | Comparison, out: Path, jobs: int | None) -> Sweep:
    """Run one of the two sweeps in a folder of its own, and say how it went."""
    from fuzzyq_bullet.cli.console import say
    from fuzzyq_bullet.cli.sweep import sweep_bar
    from fuzzyq_bullet.experiments.sweep.run import sweep
    from fuzzyq_bullet.experiments.sweep.workers import Pool
    from fuzzyq_bullet.version import __version__

    settings = {"sweep": f"learning {name}", "version": __version__, **plan.described()}
    with sweep_bar() as progress:
        done = sweep(name, plan.jobs(), out / name, settings, pool=Pool(jobs), progress=progress)
    state = done.state
    say(
        f"{name}: {state.ran} episodes in {state.seconds:.1f} s: {state.rate:.2f} episodes/s; "
        f"{state.done - state.ran} were there already"
    )
    return done
