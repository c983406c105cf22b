"""Importers: foreign maps made into scenarios, chosen by the suffix of the file.

An importer of your own is one function with ``register_importer`` in a file that ``--plugin``
names; ``examples/extend/importer.py`` is one. The simplest member reads the project's own scenario
files.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

from pydantic import ValidationError

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.problems import key_path
from fuzzyq_bullet.scenario.checks import check
from fuzzyq_bullet.scenario.files import load_scenario
from fuzzyq_bullet.scenario.models import Scenario
from fuzzyq_bullet.scenario.problems import problems_of
from fuzzyq_bullet.wording import error_in_words, not_one_of

Importer: TypeAlias = Callable[[Path], Scenario]

_importers: dict[str, Importer] = {}


def register_importer(*suffixes: str) -> Callable[[Importer], Importer]:
    """Make an importer known: a decorator for a function from a path to a scenario.

    The function reads the file and returns a ``Scenario`` (metres, radians, the arena's lower left
    corner the origin; start and goal are its choice where the map has none). It raises
    ``UserError`` for a file that is wrong: one line with file, line and what is allowed. In a file
    that ``--plugin`` names::

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

    Raises:
        ValueError: If a suffix is none, or is taken.
    """

    def register(importer: Importer) -> Importer:
        for suffix in suffixes:
            if not suffix.startswith(".") or suffix != suffix.lower():
                raise ValueError(f"a suffix is written like '.csv', got {suffix!r}")
            if suffix in _importers:
                raise ValueError(f"an importer for {suffix!r} is registered already")
            _importers[suffix] = importer
        return importer

    return register


def import_map(path: Path) -> Scenario:
    """Return the scenario that a map stands for, checked that it can be run.

    Raises:
        UserError: If no importer is registered for its suffix, or the file is wrong.
    """
    suffix = path.suffix.lower()
    if suffix not in _importers:
        known = not_one_of("importer for the suffix", suffix, tuple(_importers))
        raise UserError(f"{path}: {known}; --plugin FILE adds one of your own")
    try:
        scenario = _importers[suffix](path)
        if not isinstance(scenario, Scenario):
            raise TypeError(f"the importer returned a {type(scenario).__name__}, no Scenario")
    except UserError:
        raise
    except ValidationError as error:
        problems = problems_of(error, {})
        raise UserError(*(f"{path}: {key_path(p.loc)}: {p.message}" for p in problems)) from error
    except Exception as error:  # whatever a user's importer raises
        raise UserError(f"{path}: cannot be imported: {error_in_words(error)}") from error
    check(scenario)
    return scenario


@register_importer(".yaml", ".yml")
def own_scenario(path: Path) -> Scenario:
    """Read the project's own scenario file; what it leaves out is written out."""
    return load_scenario(path, policies=False)
