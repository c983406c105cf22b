"""What ``fuzzyq explain`` says: one inference as data for programs and as a page for people."""

from __future__ import annotations

import math
from itertools import chain
from typing import TYPE_CHECKING, Any

from rich import box
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from fuzzyq_bullet.planning.base import STEP_UNIT
from fuzzyq_bullet.planning.settings import RoutineSettings, WeightsSettings

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from fuzzyq_bullet.fuzzy import FuzzyController, Inference
    from fuzzyq_bullet.fuzzy.rules import Rule
    from fuzzyq_bullet.fuzzy.sets import Variable

FIRES = 0.01
"""Gaussians never reach 0, so every rule fires a little; below this a rule does not count."""
WIDE = 80
"""Columns for all of it side by side; with fewer, what stands beside goes below."""
TURN_UNIT: float = RoutineSettings.model_fields["turn_unit"].default
WEIGHTS: tuple[float, float] = WeightsSettings.model_fields["weights"].default


def as_dict(
    controller: FuzzyController,
    rules: str,
    distance: float,
    difference: float,
    inference: Inference,
) -> dict[str, Any]:
    """Return all that happened in an inference, the rules strongest first."""
    base = controller.base
    return {
        "distance": distance,
        "difference": difference,
        "table": rules,
        "samples": controller.method.samples,
        "near": dict(zip(base.row.labels, inference.near, strict=True)),
        "side": dict(zip(base.column.labels, inference.side, strict=True)),
        "rules": [
            {
                base.row.name: rule.row,
                base.column.name: rule.column,
                **dict(zip((output.name for output in base.outputs), rule.then, strict=True)),
                "strength": strength,
            }
            for strength, rule in _firing(controller, inference)
        ],
        "turn": inference.turn,
        "stride": inference.stride,
    }


def as_page(
    controller: FuzzyController,
    rules: str,
    distance: float,
    difference: float,
    inference: Inference,
    width: int,
    *,
    known: bool = False,
) -> RenderableType:
    """Return the inference as a page of ``width`` columns, legible without colour.

    Args:
        controller: What inferred.
        rules: Its table.
        distance: d.
        difference: Df.
        inference: What came out.
        width: Columns of the page.
        known: Whether the weights in force are known, and told elsewhere.
    """
    base = controller.base
    near = _memberships(
        f"d = {distance:g} S_p free ahead", base.row, inference.near, range(len(base.row.sets))
    )
    side = _memberships(
        f"Df = {difference:g} S_p: {_roomier(difference)}",
        base.column,
        inference.side,
        base.column.falling,
    )
    inputs = Table.grid(padding=(0, 5))
    if width >= WIDE:
        inputs.add_row(near, side)
    else:
        inputs.add_row(near)
        inputs.add_row(side)
    return Group(
        title_line("Inputs, and how far they belong to each set"),
        inputs,
        Text(),
        title_line(f"Rules ({rules}): [turn step] and strength, ◀ the strongest"),
        Text(columns_in_words(base.column)),
        _rule_table(controller, inference, folded=width < WIDE),
        title_line("Rules that fire, strongest first"),
        _sentences(controller, inference, width),
        Text(),
        title_line(f"Outputs ({_method_in_words(controller)})"),
        _outputs(base.outputs, inference, folded=width < WIDE),
        Text(),
        title_line("What the robot is asked for, in metres and degrees"),
        _in_units(inference, known=known),
    )


def _firing(controller: FuzzyController, inference: Inference) -> list[tuple[float, Rule]]:
    """Pair the rules with their strengths, strongest first, ties in the order of the table."""
    pairs = zip(chain.from_iterable(inference.rules), controller.base, strict=True)
    return sorted(pairs, key=lambda pair: -pair[0])


def title_line(words: str) -> Text:
    """Return a heading."""
    return Text(words, style="bold underline")


def columns_in_words(variable: Variable) -> str:
    """Say on which side there is more room in the columns of a table."""
    sets = [variable.sets[i] for i in variable.falling]
    left = [one.label for one in sets if one.center > 0.0]
    right = [one.label for one in sets if one.center < 0.0]
    told = [
        f"{' and '.join(labels)}: the {side} is freer"
        for labels, side in ((left, "left"), (right, "right"))
        if labels
    ]
    return f"Columns {'; '.join(told)}."


def _method_in_words(controller: FuzzyController) -> str:
    method = controller.method
    if method.defuzzification == "average":
        return "average of the conclusions' centers, by how strongly the rules fire"
    return f"centroid of {method.samples} points, Eq. 22"


def _roomier(difference: float) -> str:
    if difference == 0:
        return "as much room left as right"
    return "more room on the " + ("left" if difference > 0 else "right")


def _memberships(
    title: str, variable: Variable, degrees: Sequence[float], order: Iterable[int]
) -> Table:
    grid = Table.grid(padding=(0, 1))
    for index in order:
        one, degree = variable.sets[index], degrees[index]
        style = "cyan" if degree >= FIRES else "dim"
        grid.add_row(
            Text(one.label, style="bold" if degree >= FIRES else "dim"),
            Text(one.words, style="" if degree >= FIRES else "dim"),
            _bar(degree, 12, style),
            Text(f"{degree:.2f}", style="" if degree >= FIRES else "dim"),
        )
    framed = Table.grid()
    framed.add_row(Text(title))
    framed.add_row(grid)
    return framed


def _bar(share: float, width: int, style: str) -> Text:
    """Draw ``share`` (0 to 1) as a bar in eighths of a character on a dotted track."""
    eighths = round(share * width * 8)
    full, rest = divmod(eighths, 8)
    bar = "█" * full + (" ▏▎▍▌▋▊▉"[rest] if rest else "")
    return Text.assemble((bar, style), ("·" * (width - len(bar)), "dim"))


def _rule_table(controller: FuzzyController, inference: Inference, *, folded: bool) -> Table:
    base = controller.base
    strongest = max(map(max, inference.rules))
    widest = max(len(" ".join(cell)) for row in base.cells for cell in row)
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1))
    table.add_column("d \\ Df", style="bold", overflow="fold")
    for column in base.column.falling:
        table.add_column(base.column.labels[column], overflow="fold")
    for label, cells, strengths in zip(base.row.labels, base.cells, inference.rules, strict=True):
        table.add_row(
            label,
            *(
                _cell(" ".join(cells[i]).ljust(widest), strengths[i], strongest, folded=folded)
                for i in base.column.falling
            ),
        )
    return table


def _cell(names: str, strength: float, strongest: float, *, folded: bool) -> Text:
    """Write one rule so that weak, firing and strongest differ in shape, not only in colour."""
    names += "\n" if folded else " "
    if strength < FIRES:
        return Text(f"{names}  ·  ", style="dim")
    if strength == strongest:
        return Text(f"{names}{strength:.2f}◀", style="bold reverse cyan")
    return Text.assemble(names, (f"{strength:.2f} ", "bold cyan"))


def _sentences(controller: FuzzyController, inference: Inference, width: int) -> Table:
    pairs = _firing(controller, inference)
    firing = [pair for pair in pairs if pair[0] >= FIRES]
    halves = [_sentence(controller, inference, rule) for _, rule in firing]
    # A line that must be broken is broken before its "then", and then all are.
    room = width - len("0.00 ")
    joint = " " if all(len(" ".join(pair)) <= room for pair in halves) else "\n   "
    grid = Table.grid(padding=(0, 1))
    for (strength, _), pair in zip(firing, halves, strict=True):
        grid.add_row(Text(f"{strength:.2f}", style="bold cyan"), Text(joint.join(pair)))
    silent = len(pairs) - len(firing)
    grid.add_row("", Text(f"The other {silent} rules stay below {FIRES}.", style="dim"))
    return grid


def _sentence(controller: FuzzyController, inference: Inference, rule: Rule) -> tuple[str, str]:
    """Return the rule in words, in two halves, with the memberships that it fires by."""
    base = controller.base
    near = inference.near[base.row.labels.index(rule.row)]
    side = inference.side[base.column.labels.index(rule.column)]
    then = ", ".join(
        f"{output.name} {output.set_of(label).words}"
        for output, label in zip(base.outputs, rule.then, strict=True)
    )
    return (
        f"if {base.row.name} is {base.row.set_of(rule.row).words} ({near:.2f}) "
        f"and {base.column.name} is {base.column.set_of(rule.column).words} ({side:.2f})",
        f"then {then}",
    )


def _outputs(variables: tuple[Variable, ...], inference: Inference, *, folded: bool) -> Table:
    turn, step = variables
    # Rounded first, so that a turn shown as 0.00 is not said to go anywhere.
    scale = round(inference.turn, 2)
    way = "left" if scale > 0 else "right"
    rows = (
        (
            Text(f"N_a = {scale:+.2f}" if scale else "N_a =  0.00", style="bold"),
            # Left is positive, and drawn on the left.
            _gauge(-scale, (-turn.domain[1], -turn.domain[0]), ("left", "right")),
            f"turn to the {way} by {abs(scale):.2f}·ω2·A_p" if scale else "no turn",
        ),
        (
            Text(f"N_s =  {inference.stride:.2f}", style="bold"),
            _gauge(inference.stride, step.domain, ("short", "long")),
            f"a step of {inference.stride:.2f}·ω1·S_p",
        ),
    )
    grid = Table.grid(padding=(0, 2))
    for name, gauge, words in rows:
        if folded:
            grid.add_row(name, gauge)
            grid.add_row("", words)
        else:
            grid.add_row(name, gauge, words)
    return grid


def _in_units(inference: Inference, *, known: bool) -> Group:
    """Say what the outputs come to with the weights that count most: 1, and the default."""
    w1, w2 = WEIGHTS
    lines = [
        f"S_p = {STEP_UNIT:g} m; A_p = {math.degrees(TURN_UNIT):.0f}° unless turn_unit is set.",
        f"ω1, ω2 = 1, 1: {turn_and_step(inference, 1.0, 1.0)}",
    ]
    if not known:
        lines.append(
            f"ω1, ω2 = {w1:g}, {w2:g}: {turn_and_step(inference, w1, w2)} "
            "(default of improved-fuzzy)"
        )
    lines.append("With the safety filter it drives no farther than is known free.")
    return Group(*lines)


def turn_and_step(inference: Inference, w1: float, w2: float) -> str:
    """Say what an inference asks for with weights ω1 and ω2, in the film's words."""
    degrees = round(math.degrees(w2 * inference.turn * TURN_UNIT), 1)
    way = f"{abs(degrees):.1f}° to the {'left' if degrees > 0 else 'right'}" if degrees else "0°"
    return f"turn asked {way}, step asked {w1 * inference.stride * STEP_UNIT:.3f} m"


def _gauge(value: float, domain: tuple[float, float], ends: tuple[str, str]) -> Text:
    """Draw ``value`` as a mark on a ruler, with what its two ends mean."""
    low, high = domain
    width = 19
    ruler = ["─"] * width
    ruler[width // 2] = "┼"
    mark = round((value - low) / (high - low) * (width - 1))
    return Text.assemble(
        (f"{ends[0]:>5} ├", "dim"),
        ("".join(ruler[:mark]), "dim"),
        ("●", "bold cyan"),
        ("".join(ruler[mark + 1 :]), "dim"),
        (f"┤ {ends[1]:<5}", "dim"),
    )
