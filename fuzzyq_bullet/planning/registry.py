"""Planners by name: the settings each accepts and how it is built."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias, TypeVar

import numpy as np

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.planning.base import Planner
from fuzzyq_bullet.planning.settings import PlannerSettings
from fuzzyq_bullet.wording import not_one_of, shorten

Factory: TypeAlias = Callable[[Any, np.random.Generator], Planner]
_S = TypeVar("_S", bound=PlannerSettings)

DEFAULT_PLANNER = "fuzzy-q-lambda"
"""The paper's own."""


@dataclass(frozen=True)
class _Entry:
    settings: type[PlannerSettings]
    factory: Factory


_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,99}")

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
        ValueError: If the name is taken, or could not be part of a file's name, or the settings
            could not be built with it.

    Example:
        In a file that ``--plugin`` names (``examples/extend/planner.py`` is a whole one)::

            from typing import Literal

            from fuzzyq_bullet import Decision, Observation, PlannerSettings, register_planner

            class MySettings(PlannerSettings):
                name: Literal["my-planner"] = "my-planner"
                speed: float = 0.5  # a key of the scenario file: planner: {name: my-planner, ...}

            class MyPlanner:
                def __init__(self, settings: MySettings) -> None:
                    self.step = 0.4 * settings.speed

                def decide(self, observation: Observation, /) -> Decision:
                    [free] = observation.sense([observation.heading])  # m
                    return Decision(heading=observation.heading, step=min(self.step, free))

            register_planner("my-planner", MySettings, lambda settings, rng: MyPlanner(settings))

        A planner of the package itself is a module here, and a call in ``planning/__init__.py``.
    """
    if not _NAME.fullmatch(name):
        raise ValueError(
            f"a planner cannot be named {shorten(name)}; allowed: letters, digits, '.', '-' and "
            "'_', at most 100, beginning with a letter or digit"
        )
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


def no_planner(name: Any) -> str:
    """Say that no planner has this name, which do exist, and how others come to be known."""
    return f"{not_one_of('planner', name, planner_names())}; --plugin FILE adds one of your own"


def make_planner(settings: PlannerSettings, rng: np.random.Generator) -> Planner:
    """Build the planner that the settings name, for one episode.

    Raises:
        UserError: If no such planner is registered here, as with a record from elsewhere.
    """
    if settings.name not in _entries:
        raise UserError(no_planner(settings.name))
    return _entries[settings.name].factory(settings, rng)
