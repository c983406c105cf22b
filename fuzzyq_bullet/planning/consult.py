"""Asking a planner, which may be anybody's: whatever it does wrong becomes one line about it."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from fuzzyq_bullet.blame import blamed
from fuzzyq_bullet.errors import PlannerError, SensorError, UserError
from fuzzyq_bullet.planning import Observation, Planner, PlannerSettings, make_planner
from fuzzyq_bullet.planning.decision import DecisionError


def build_planner(settings: PlannerSettings, rng: np.random.Generator) -> Planner:
    """Build the planner that the settings name, for one episode.

    Raises:
        UserError: If there is no such planner, or its policy cannot be used.
        PlannerError: If building it fails, or what is built cannot decide.
    """
    with _blamed(settings.name, "while it was built"):
        planner: Any = make_planner(settings, rng)
    if not callable(getattr(planner, "decide", None)):
        raise PlannerError(
            f"planner {settings.name}: was built as a {type(planner).__name__}, "
            "which has no method decide"
        )
    built: Planner = planner
    return built


def ask(planner: Planner, observation: Observation, name: str) -> Any:
    """Return what a planner decides, which is still to be checked.

    Args:
        planner: The planner.
        observation: What it may know.
        name: What to call it.

    Raises:
        PlannerError: If it raises or exits; one line that says which planner, what it did, when,
            and where in its file.
    """
    with _blamed(name, _when(observation)):
        return planner.decide(observation)


def refusal(
    planner: Planner, observation: Observation, name: str, error: DecisionError
) -> PlannerError:
    """Return the same line about a decision that cannot be carried out.

    Args:
        planner: The planner.
        observation: What it had decided on.
        name: What to call it.
        error: What is wrong with the decision.
    """
    return PlannerError(f"planner {name}: {error}, {_when(observation)}{_home(planner)}")


@contextmanager
def closing(planner: Planner, name: str) -> Iterator[None]:
    """Close a planner that has a method ``close`` when its episode is over, however that ends.

    Raises:
        PlannerError: If closing it fails.
    """
    try:
        yield
    finally:
        close = getattr(planner, "close", None)
        if callable(close):
            with _blamed(name, "while it was closed"):
                close()


def _when(observation: Observation) -> str:
    return f"after {observation.time:.2f} s"


@contextmanager
def _blamed(name: str, when: str) -> Iterator[None]:
    """Turn whatever a planner raises into one line that blames it; see ``blame``."""
    try:
        with blamed(f"planner {name}", when, PlannerError):
            yield
    except (PlannerError, SensorError):
        raise
    except UserError as error:
        raise type(error)(*(f"planner {name}: {problem}" for problem in error.problems)) from error


def _home(planner: Planner) -> str:
    """Say where a planner's method is written."""
    try:
        method = inspect.unwrap(planner.decide)
        code = getattr(method, "__func__", method).__code__
    except Exception:  # made of something that has no lines
        return ""
    return f" ({code.co_filename}:{code.co_firstlineno}, in {code.co_name})"
