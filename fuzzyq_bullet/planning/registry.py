"""Planners by name: the settings each accepts and how it is built."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias, TypeVar

import numpy as np

from fuzzyq_bullet.planning.base import Planner
from fuzzyq_bullet.planning.settings import PlannerSettings

Factory: TypeAlias = Callable[[Any, np.random.Generator], Planner]
_S = TypeVar("_S", bound=PlannerSettings)

DEFAULT_PLANNER = "fuzzy-q-lambda"
"""The paper's own."""


@dataclass(frozen=True)
class _Entry:
    settings: type[PlannerSettings]
    factory: Factory


_entries: dict[str, _Entry] = {}


def register_planner(
    name: str, settings: type[_S], factory: Callable[[_S, np.random.Generator], Planner]
) -> None:
    """Make a planner known under ``name``, so that scenarios and the command line may ask for it.

    Args:
        name: The name in scenario files, such as ``my-planner``.
        settings: Its parameters: a subclass of ``PlannerSettings`` whose ``name`` defaults to
            ``name``.
        factory: Builds one planner for one episode from its settings and a random generator.

    Raises:
        ValueError: If the name is taken, or the settings could not be built with it.
    """
    if name in _entries:
        raise ValueError(f"a planner named {name!r} is registered already")
    settings.model_validate({"name": name})
    _entries[name] = _Entry(settings, factory)


def planner_names() -> tuple[str, ...]:
    """Return all registered names, in order of registration."""
    return tuple(_entries)


def settings_for(name: str) -> type[PlannerSettings]:
    """Return the settings model of a planner.

    Raises:
        KeyError: If no planner has that name.
    """
    return _entries[name].settings


def make_planner(settings: PlannerSettings, rng: np.random.Generator) -> Planner:
    """Build the planner that the settings name, for one episode."""
    return _entries[settings.name].factory(settings, rng)
