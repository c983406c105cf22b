"""``fuzzyq explain``: how the fuzzy controller comes from two distances to a turn and a step."""

from __future__ import annotations

from json import dumps
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias

import typer

from fuzzyq_bullet.errors import UserError

if TYPE_CHECKING:
    from fuzzyq_bullet.fuzzy.sets import Variable

RuleTable: TypeAlias = Literal["corrected", "printed"]
"""That of ``fuzzyq_bullet.fuzzy``, which waits until it is needed so that --help is quick."""

CONTEXT_SETTINGS: dict[str, Any] = {"ignore_unknown_options": True}
"""For ``app.command``: without it a negative DIFFERENCE would be taken for an option."""


def explain(
    distance: Annotated[
        float, typer.Argument(metavar="D", help="Free distance ahead, in steps S_p: 0 to 5.")
    ],
    difference: Annotated[
        float,
        typer.Argument(
            metavar="DF",
            help="Free distance on the left less that on the right, in S_p: -5 to 5.",
        ),
    ],
    *,
    rules: Annotated[
        RuleTable,
        typer.Option(help="Table 4 as it must be meant, or as it is printed in the paper."),
    ] = "corrected",
    samples: Annotated[
        int, typer.Option(help="Points of the centroid (n of Eq. 22); the paper takes 5.")
    ] = 101,
    json: Annotated[bool, typer.Option("--json", help="Print JSON on stdout, alone.")] = False,
) -> None:
    """Show which fuzzy rules fire, how strongly, and the turn and step that follow.

    Raises:
        UserError: If an input lies outside its domain or is not a number, or there are too few
            samples.
    """
    from fuzzyq_bullet.fuzzy import paper_controller
    from fuzzyq_bullet.fuzzy.inference import LEAST_SAMPLES

    if samples < LEAST_SAMPLES:
        raise UserError(f"--samples: {samples} is too few; at least {LEAST_SAMPLES}")
    controller = paper_controller(rules, samples)
    _check("D", distance, controller.base.row)
    _check("DF", difference, controller.base.column)
    inference = controller.infer(distance, difference)
    from fuzzyq_bullet.cli.explain_page import as_dict, as_page

    if json:
        answer = as_dict(controller, rules, distance, difference, inference)
        typer.echo(dumps(answer, indent=2))
    else:
        from rich.console import Console

        console = Console(highlight=False)
        console.print(as_page(controller, rules, distance, difference, inference, console.width))


def _check(name: str, value: float, variable: Variable) -> None:
    low, high = variable.domain
    if not low <= value <= high:
        raise UserError(f"{name}: {value:g} is not a number from {low:g} to {high:g}, in S_p")
