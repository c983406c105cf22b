"""``fuzzyq bench``: measurements of the project, of its speed and of what it achieves."""

from __future__ import annotations

from typing import Annotated

import typer

from fuzzyq_bullet.cli.bench_escape import escape
from fuzzyq_bullet.cli.bench_learning import learning
from fuzzyq_bullet.cli.bench_steps import steps
from fuzzyq_bullet.cli.bench_success import success
from fuzzyq_bullet.cli.options import Json, help_of

app = typer.Typer(help="Measure the project itself.", no_args_is_help=True)


@app.callback()
def _bench() -> None:
    pass


@app.command("speed")
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
    from fuzzyq_bullet.cli.console import progress_bar, say
    from fuzzyq_bullet.errors import UserError
    from fuzzyq_bullet.experiments.speed import MEASUREMENTS, as_json, as_table

    if not 1 <= rate <= 80 or 240 % rate:
        raise UserError(f"--rate: must divide 240 and be from 1 to 80, got {rate}")

    rows = []
    with progress_bar("measuring", len(MEASUREMENTS)) as (progress, bar):
        for measurement in MEASUREMENTS:
            progress.update(bar, note=measurement.name)
            rows += measurement.rows(rounds, rate)
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


app.command("escape", help=help_of(escape))(escape)
app.command("learning", help=help_of(learning))(learning)
app.command("success", help=help_of(success))(success)
app.command("steps", help=help_of(steps))(steps)
