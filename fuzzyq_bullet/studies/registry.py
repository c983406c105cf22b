"""Studies by name: those of the package, imported when they are asked for, and a user's own."""

from __future__ import annotations

import re
from importlib import import_module
from typing import TypeVar

from fuzzyq_bullet.studies.study import Study
from fuzzyq_bullet.wording import shorten

_BUNDLED = {
    "success": "fuzzyq_bullet.studies.success.study",
    "steps": "fuzzyq_bullet.studies.steps.study",
    "learning": "fuzzyq_bullet.studies.learning.study",
    "escape": "fuzzyq_bullet.studies.escape.study",
    "familiar": "fuzzyq_bullet.studies.familiar.study",
    "robust": "fuzzyq_bullet.studies.robust.study",
    "field": "fuzzyq_bullet.studies.field.study",
}
"""The modules of the package's own, in the order of a report."""
_NAME = re.compile(r"[a-z][a-z0-9-]{0,49}")
_TAKEN = ("speed",)
"""Other words after ``fuzzyq bench``."""
_S = TypeVar("_S", bound=type[Study])
_studies: dict[str, type[Study]] = {}


def register_study(study: _S) -> _S:
    """Make a study known, so that ``fuzzyq bench NAME`` runs it; a decorator of its class.

    In a file of one's own that ``--plugin`` loads::

        from pydantic import Field

        from fuzzyq_bullet.studies import (
            FieldsPlan, Findings, Study, Table, described, planners_of, register_study
        )

        @register_study
        class Sparse(Study):
            \"\"\"Ask two planners for their way through sparse fields.\"\"\"

            name = "sparse"
            runs: int = Field(10, ge=1, description="Fields.")

            def planner_set(self):
                return planners_of("fuzzy,improved-fuzzy")

            def plan(self):
                told = described(self.planner_set())
                return FieldsPlan(sweep=self.name, planners=told, counts=(5,), runs=self.runs)

            def findings(self, results):
                rows = results[self.name].rows
                cells = [[row.planner, row.outcome] for row in rows]
                return Findings((Table("How runs ended.", ("planner", "outcome"), cells),), {})

    A study of the package itself is a module or a folder here, and a line in ``_BUNDLED``.

    Raises:
        ValueError: If its name is taken, or cannot be one.
    """
    if not _NAME.fullmatch(study.name) or study.name in _TAKEN:
        raise ValueError(
            f"a study cannot be named {shorten(study.name)}; allowed: small letters, digits and "
            f"'-', at most 50, beginning with a letter, and not {', '.join(_TAKEN)}"
        )
    bundled = _BUNDLED.get(study.name, study.__module__)
    if study.name in _studies or bundled != study.__module__:
        raise ValueError(f"a study named {study.name!r} is registered already")
    _studies[study.name] = study
    return study


def study_names() -> list[str]:
    """Return the names of all studies that are known, the package's own first."""
    return list(dict.fromkeys([*_BUNDLED, *_studies]))


def study_of(name: str) -> type[Study]:
    """Return a study.

    Raises:
        KeyError: If none has this name.
    """
    if name in _BUNDLED and name not in _studies:
        import_module(_BUNDLED[name])
    return _studies[name]
