"""Which importer reads a file, and the scenario that comes of it."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

from pydantic import ValidationError

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.reading.problems import key_path
from fuzzyq_bullet.scenario.importers.building import asked_for, scenario_of
from fuzzyq_bullet.scenario.importers.foreign import ForeignMap, ImportOptions
from fuzzyq_bullet.scenario.importers.refusals import refuse_conflicts
from fuzzyq_bullet.scenario.models import Scenario
from fuzzyq_bullet.scenario.problems import problems_of
from fuzzyq_bullet.wording import error_in_words, not_one_of

Importer: TypeAlias = Callable[..., "Scenario | ForeignMap"]
"""A function of a path, or of a path and ``ImportOptions``."""


class Imported(NamedTuple):
    """What came of a map.

    Attributes:
        scenario: The scenario, checked that it can be run.
        left_out: What of the map it has not, a line each.
        changed: What of the map it has otherwise, a line each.
    """

    scenario: Scenario
    left_out: tuple[str, ...] = ()
    changed: tuple[str, ...] = ()

    def notes(self) -> list[str]:
        """Return what the scenario has not, and what it has otherwise, in words."""
        left_out = [f"left out: {line}" for line in self.left_out]
        return [*left_out, *(f"changed: {line}" for line in self.changed)]


class _Entry(NamedTuple):
    importer: Importer
    claims: Callable[[Path], bool] | None


_importers: dict[str, list[_Entry]] = {}


def register_importer(
    *suffixes: str, claims: Callable[[Path], bool] | None = None
) -> Callable[[Importer], Importer]:
    """Make an importer known: a decorator for a function from a path to a scenario.

    The function reads the file and returns a ``Scenario`` (metres, radians; start and goal are its
    choice where the map has none). If it takes a second parameter, that is the ``ImportOptions``.
    Instead of a scenario it may return a ``ForeignMap``: then the options are seen to here, and
    what the map has and the scenario has not is told. It raises ``UserError`` for a file that is
    wrong: one line with file, line and what is allowed. In a file that ``--plugin`` names::

        from pathlib import Path

        import numpy as np
        from fuzzyq_bullet import Scenario
        from fuzzyq_bullet.scenario.importers import register_importer

        @register_importer(".csv")
        def circles(path: Path) -> Scenario:
            rows = np.loadtxt(path, delimiter=",")
            return Scenario(name=path.stem, obstacles=..., start=..., goal=...)

    Then ``fuzzyq import forest.csv --plugin FILE`` writes ``forest.yaml``. An importer of the
    package itself is a module here that ``scenario/importers/__init__.py`` imports.

    Args:
        suffixes: What the files end with, such as ``.csv``; small letters.
        claims: Looks into a file and says whether it is one for this importer, where several
            share a suffix. An importer without it takes the files that no other one claims.

    Raises:
        ValueError: If a suffix is none, or is taken.
    """

    def register(importer: Importer) -> Importer:
        for suffix in suffixes:
            if not suffix.startswith(".") or suffix != suffix.lower():
                raise ValueError(f"a suffix is written like '.csv', got {suffix!r}")
            known = _importers.setdefault(suffix, [])
            if claims is None and any(entry.claims is None for entry in known):
                raise ValueError(f"an importer for {suffix!r} is registered already")
            known.append(_Entry(importer, claims))
        return importer

    return register


def importable() -> tuple[str, ...]:
    """Return the suffixes that there is an importer for."""
    return tuple(_importers)


def import_map(path: Path, options: ImportOptions | None = None) -> Imported:
    """Return the scenario that a map stands for, checked that it can be run.

    Raises:
        UserError: If no importer is registered for its suffix, the file is wrong, or the map does
            not say where to start and to go, and the options do not either.
    """
    options = options or ImportOptions()
    options.robot_model()
    try:
        made = _call(_importer_of(path), path, options)
        if isinstance(made, ForeignMap):
            scenario = scenario_of(path, made, options)
            imported = Imported(scenario, tuple(made.left_out), tuple(made.changed))
        elif isinstance(made, Scenario):
            imported = Imported(asked_for(path, made, options))
        else:
            kinds = "neither Scenario nor ForeignMap"
            raise TypeError(f"the importer returned a {type(made).__name__}, {kinds}")
    except UserError:
        raise
    except ValidationError as error:
        problems = problems_of(error, {})
        raise UserError(*(f"{path}: {key_path(p.loc)}: {p.message}" for p in problems)) from error
    except Exception as error:  # whatever a user's importer raises
        raise UserError(f"{path}: cannot be imported: {error_in_words(error)}") from error
    refuse_conflicts(path, imported.scenario, options)
    return imported


def _importer_of(path: Path) -> Importer:
    suffix = path.suffix.lower()
    if suffix not in _importers:
        known = not_one_of("importer for the suffix", suffix, tuple(_importers))
        raise UserError(f"{path}: {known}; --plugin FILE adds one of your own")
    entries = _importers[suffix]
    for entry in entries:
        if entry.claims is not None and entry.claims(path):
            return entry.importer
    for entry in entries:
        if entry.claims is None:
            return entry.importer
    raise UserError(f"{path}: none of the importers for {suffix!r} knows what it is")


def _call(importer: Importer, path: Path, options: ImportOptions) -> Any:
    places = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    kinds = [one.kind for one in inspect.signature(importer).parameters.values()]
    return importer(path, options) if sum(k in places for k in kinds) > 1 else importer(path)
