"""``fuzzyq explain``: how the fuzzy controller comes from two distances to a turn and a step."""

from __future__ import annotations

from json import dumps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fuzzyq_bullet.cli.options import FILE, ReplaceOthersOption, RulesOption
from fuzzyq_bullet.errors import UserError

if TYPE_CHECKING:
    from rich.console import RenderableType

    from fuzzyq_bullet.fuzzy import ControllerDefinition
    from fuzzyq_bullet.fuzzy.sets import Variable
    from fuzzyq_bullet.learning import Policy

CONTEXT_SETTINGS: dict[str, Any] = {"ignore_unknown_options": True}
"""For ``app.command``: without it a negative DIFFERENCE would be taken for an option."""


def explain(
    distance: Annotated[
        float | None, typer.Argument(metavar="D", help="Free distance ahead, in steps S_p: 0 to 5.")
    ] = None,
    difference: Annotated[
        float | None,
        typer.Argument(
            metavar="DF",
            help="Free distance on the left less that on the right, in S_p: -5 to 5.",
        ),
    ] = None,
    *,
    rules: RulesOption = None,
    samples: Annotated[
        int | None,
        typer.Option(
            help="Points of the centroid (n of Eq. 22); the paper takes 5.",
            show_default="as the rules say; 101 for Table 4",
        ),
    ] = None,
    policy: Annotated[
        str | None,
        typer.Option(
            metavar="FILE",
            help="A policy of fuzzy-q-lambda, or the word shipped: show the weights of each rule.",
        ),
    ] = None,
    export: Annotated[
        Path | None,
        typer.Option(help="Write the controller instead, as .yaml, .fll or .fis.", **FILE),
    ] = None,
    replace: ReplaceOthersOption = False,
    json: Annotated[bool, typer.Option("--json", help="Print JSON on stdout, alone.")] = False,
) -> None:
    """Show which fuzzy rules fire, how strongly, and the turn and step that follow.

    With --policy also what each rule has learned; then D and DF may be left out. With --export
    write the controller to a file, to be changed and driven with (docs/how-to/rules.md).

    Raises:
        UserError: If an input lies outside its domain, is missing or is not a number, there are
            too few samples, the rules or the policy cannot be used, or a file cannot be written.
    """
    from fuzzyq_bullet.cli.rules import export_controller, rules_given, tell_gaps
    from fuzzyq_bullet.fuzzy.definition import MOST_SAMPLES
    from fuzzyq_bullet.fuzzy.definition_checks import too_few
    from fuzzyq_bullet.fuzzy.inference import LEAST_SAMPLES

    if samples is not None and not LEAST_SAMPLES <= samples <= MOST_SAMPLES:
        bounds = f"from {LEAST_SAMPLES} to {MOST_SAMPLES}"
        raise UserError(f"--samples: must be {bounds}, got {samples}")
    definition = rules_given(rules)
    why = "" if samples is None else too_few(definition, samples)
    if why:
        raise UserError(f"--samples: {why}")
    tell_gaps(definition, rules)
    if export is not None:
        export_controller(definition, samples, export, rules, replace=replace)
        return
    if difference is None and (distance is not None or policy is None):
        missing = "D" if distance is None else "DF"
        raise UserError(f"{missing}: missing; give D and DF, or neither and --policy")
    controller = definition.controller(samples)
    title = definition.name or rules or ""
    learned = None if policy is None else _learned(policy, definition)
    inference = None
    if distance is not None and difference is not None:
        _check("D", distance, controller.base.row)
        _check("DF", difference, controller.base.column)
        inference = controller.infer(distance, difference)
    from rich.console import Console, Group

    from fuzzyq_bullet.cli.explain_page import as_dict, as_page
    from fuzzyq_bullet.cli.explain_weights import weights_as_dict, weights_as_page

    console = Console(highlight=False)
    answer: dict[str, Any] = {}
    parts: list[RenderableType] = []
    if inference is not None and distance is not None and difference is not None:
        answer |= as_dict(controller, rules or "corrected", distance, difference, inference)
        page = as_page(
            controller, title, distance, difference, inference, console.width,
            known=learned is not None,
        )  # fmt: skip
        parts.append(page)
    if learned is not None:
        answer |= weights_as_dict(learned, controller.base, inference)
        parts.append(weights_as_page(learned, controller.base, inference))
    if json:
        typer.echo(dumps(answer, indent=2))
    else:
        console.print(Group(*parts))


def _learned(name: str, rules: ControllerDefinition) -> Policy:
    from fuzzyq_bullet.planning.fuzzy_q_lambda import learned_policy

    return learned_policy(None if name == "shipped" else name, rules)


def _check(name: str, value: float, variable: Variable) -> None:
    low, high = variable.domain
    if not low <= value <= high:
        raise UserError(f"{name}: {value:g} is not a number from {low:g} to {high:g}, in S_p")
