"""What ``fuzzyq explain --policy`` adds: the weights that each rule has learned."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rich import box
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from fuzzyq_bullet.cli.explain_page import FIRES, columns_in_words, title_line, turn_and_step
from fuzzyq_bullet.errors import printable
from fuzzyq_bullet.planning.fuzzy_q_lambda import firing, rule_names, weighed, weights_of

if TYPE_CHECKING:
    from fuzzyq_bullet.fuzzy import Inference
    from fuzzyq_bullet.fuzzy.rules import RuleBase
    from fuzzyq_bullet.learning import Policy


def weights_as_dict(policy: Policy, base: RuleBase, inference: Inference | None) -> dict[str, Any]:
    """Return the weights of every rule, and those in force where something is sensed."""
    learned = {
        "weights": [
            {"rule": rule, "step": step, "turn": turn}
            for rule, (step, turn) in zip(
                rule_names(base), weights_of(policy).tolist(), strict=True
            )
        ]
    }
    if inference is None:
        return learned
    return learned | {"weights_in_force": list(weighed(firing(inference), weights_of(policy)))}


def weights_as_page(policy: Policy, base: RuleBase, inference: Inference | None) -> RenderableType:
    """Return the table of weights, in which the rules that fire stand out."""
    parts: list[RenderableType] = [
        title_line("What each rule has learned: ω1 of its step, ω2 of its turn"),
        Text(f"{printable(policy.command)}  ({policy.episodes} episodes)", style="dim"),
        Text(columns_in_words(base.column) + ("" if inference is None else " ◀ fires here.")),
        _table(policy, base, inference),
    ]
    if inference is not None:
        w1, w2 = weighed(firing(inference), weights_of(policy))
        told = f"ω1, ω2 = {w1:.3g}, {w2:.3g}: {turn_and_step(inference, w1, w2)}"
        parts += [Text("In force here, each by how strongly its rule fires:"), Text(told)]
        parts = [Text(), *parts]
    return Group(*parts)


def _table(policy: Policy, base: RuleBase, inference: Inference | None) -> Table:
    weights = weights_of(policy).reshape(len(base.row.sets), len(base.column.sets), 2)
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1))
    table.add_column("d \\ Df", style="bold")
    for column in base.column.falling:
        table.add_column(base.column.labels[column])
    for row, label in enumerate(base.row.labels):
        cells = []
        for column in base.column.falling:
            step, turn = weights[row, column]
            strength = 1.0 if inference is None else inference.rules[row][column]
            words = f"{step:g} {turn:g}"
            mark = "" if inference is None else " ◀" if strength >= FIRES else "  "
            cells.append(Text(words + mark, style="" if strength >= FIRES else "dim"))
        table.add_row(label, *cells)
    return table
