"""What commands do with ``--rules``: read them, tell of gaps, write them to a file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from fuzzyq_bullet.cli.options import say
from fuzzyq_bullet.errors import UserError

if TYPE_CHECKING:
    from fuzzyq_bullet.fuzzy import ControllerDefinition


def rules_given(text: str | None) -> ControllerDefinition:
    """Return the controller that ``--rules`` names; without it that of the paper.

    Raises:
        UserError: If it names none, or its file is wrong.
    """
    from fuzzyq_bullet.fuzzy import ControllerDefinition, paper_definition
    from fuzzyq_bullet.fuzzy.paper import RULE_TABLES
    from fuzzyq_bullet.planning.controllers import rules_named
    from fuzzyq_bullet.planning.settings import NO_CONTROLLER

    if text is None:
        return paper_definition()
    try:
        rules = rules_named(text)
    except UserError as error:
        raise error.under("--rules") from error
    if isinstance(rules, ControllerDefinition):
        return rules
    if rules == NO_CONTROLLER:
        raise UserError(f"--rules: {NO_CONTROLLER} means no controller; there is nothing to show")
    return paper_definition(next(one for one in RULE_TABLES if one == rules))


def tell_gaps(definition: ControllerDefinition, name: str | None) -> None:
    """Say on stderr where an input belongs to no set."""
    from fuzzyq_bullet.fuzzy.definition_checks import gaps_of
    from fuzzyq_bullet.reading.problems import key_path

    for loc, why in gaps_of(definition):
        say(f"{name}: {key_path(loc)}: {why}", style="bold")


def export_controller(
    definition: ControllerDefinition,
    samples: int | None,
    path: Path,
    source: str | None,
    *,
    replace: bool,
) -> None:
    """Write a controller to a file, and say where it is.

    Args:
        definition: The controller.
        samples: n of Eq. 22 instead of its own.
        path: The file.
        source: What ``--rules`` named.
        replace: Whether a file that is there already may be replaced.

    Raises:
        UserError: If the file is the one that was read, is there, or cannot be written.
    """
    from fuzzyq_bullet.files import refuse_inputs
    from fuzzyq_bullet.fuzzy import definition_of, save_controller
    from fuzzyq_bullet.fuzzy.formats import format_of

    format_of(path)
    refuse_inputs([path], [] if source is None else [Path(source)])
    if not replace and (path.exists() or path.is_symlink()):
        raise UserError(f"{path}: is there already; --replace replaces it")
    if samples is not None:
        definition = definition_of(definition.controller(samples), definition.name)
    save_controller(definition, path)
    say(f"  {path}")
