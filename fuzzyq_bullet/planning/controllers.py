"""Which controller a planner asks, and what is told of its decisions therefore."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from fuzzyq_bullet.columns import Columns
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.fuzzy import (
    ControllerDefinition,
    FuzzyController,
    load_controller,
    paper_controller,
)
from fuzzyq_bullet.fuzzy.formats import FORMATS
from fuzzyq_bullet.fuzzy.paper import RULE_TABLES
from fuzzyq_bullet.planning.decision import FIELDS
from fuzzyq_bullet.planning.settings import RULE_WORDS, PlannerSettings, RoutineSettings
from fuzzyq_bullet.wording import did_you_mean, shorten


def rules_named(text: str, folder: Path = Path()) -> str | ControllerDefinition:
    """Return the rules that a word or a file stands for.

    Args:
        text: One of ``RULE_WORDS``, or the path of a controller.
        folder: Where a relative path begins.

    Raises:
        UserError: If it is neither, or the file is wrong.
    """
    if text in RULE_WORDS:
        return text
    path = folder / text
    if Path(text).suffix.lower() not in FORMATS:
        raise UserError(
            f"got {shorten(text)}; {did_you_mean(text, RULE_WORDS)}allowed: "
            f"{', '.join(RULE_WORDS)}, or a file that ends in {', '.join(FORMATS)}"
        )
    return load_controller(path)


def controller_of(settings: PlannerSettings) -> FuzzyController | None:
    """Return the controller that a planner asks; None if it asks none."""
    if not isinstance(settings, RoutineSettings):
        return None
    rules = settings.rules
    if isinstance(rules, ControllerDefinition):
        return rules.controller(settings.samples)
    table = next((one for one in RULE_TABLES if one == rules), None)
    return None if table is None else paper_controller(table, settings.samples or 101)


def controller_shown(settings: PlannerSettings) -> FuzzyController:
    """Return the controller by which a run is explained: that of the paper if it had none."""
    return controller_of(settings) or paper_controller()


def fields_of(settings: PlannerSettings) -> Columns:
    """Return what is recorded of the decisions of a planner, with the labels of its sets."""
    base = controller_shown(settings).base
    return fields_with(base.row.labels, base.column.labels)


def fields_with(near: Sequence[str], side: Sequence[str]) -> Columns:
    """Return what is recorded of decisions.

    Args:
        near: Labels of the sets of the distance.
        side: Labels of the sets of the difference.
    """
    rows, columns = tuple(near), tuple(side)
    axes = {"near": (rows,), "side": (columns,), "rules": (rows, columns)}
    return {
        name: replace(column, axes=axes[name]) if name in axes else column
        for name, column in FIELDS.items()
    }
