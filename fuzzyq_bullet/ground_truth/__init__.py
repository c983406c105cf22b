"""The truth about a scenario that no planner may see: whether there is a way, and the shortest.

Exact, by the tangent graph: seen by the centre of a disc, cylinders are larger discs and boxes
are rounded rectangles, and a shortest path is made of straight lines that touch such discs and of
arcs around them. No grid, so no gap is too narrow to be found. The one tolerance is ``GRAZE``, and
it errs on one side: a gap too narrow by no more than 2 nm counts as open, so that rounding never
makes a feasible world infeasible, and lengths are never too long by more than rounding.

The path ends where a run may end: at the first point of the goal disc. What a robot drives from
start to goal is therefore never shorter, and SPL is at most 1.

Nothing that drives or plans may import this package.
"""

from __future__ import annotations

import math
from functools import lru_cache, partial
from typing import NamedTuple

from fuzzyq_bullet.geometry import Field
from fuzzyq_bullet.ground_truth.configuration_space import ConfigurationSpace
from fuzzyq_bullet.ground_truth.search import is_connected, shortest_route
from fuzzyq_bullet.ground_truth.tangent_graph import Route
from fuzzyq_bullet.ground_truth.tour import Disc, tour
from fuzzyq_bullet.quantities import Point
from fuzzyq_bullet.scenario.models import Scenario
from fuzzyq_bullet.scenario.places import Arena
from fuzzyq_bullet.shapes import GRAZE, Obstacle

_REMEMBERED = 128
"""Worlds whose answers are kept: a sweep asks for each world once for every planner."""


class _Question(NamedTuple):
    """All that an answer depends on."""

    obstacles: tuple[Obstacle, ...]
    arena: Arena
    start: Point
    discs: tuple[Disc, ...]
    radius: float

    @classmethod
    def of(cls, scenario: Scenario, radius: float | None) -> _Question:
        radius = scenario.robot.radius if radius is None else radius
        if scenario.random is not None:
            raise ValueError(
                f"{scenario.name}: obstacles are still to be drawn; use realise() first"
            )
        if not (math.isfinite(radius) and radius > 2 * GRAZE):
            raise ValueError(f"the radius must be positive and finite, got {radius}")
        discs = tuple((one.position, one.radius) for one in scenario.targets)
        return cls(scenario.standing, scenario.arena, scenario.start.position, discs, radius)

    def space(self) -> ConfigurationSpace:
        return ConfigurationSpace(Field.of(self.obstacles, self.arena), self.radius)


def shortest_path(scenario: Scenario, radius: float | None = None) -> Route | None:
    """Return the shortest way of a disc from the start to the goal disc; None if there is none.

    With via points it leads through their discs, in their order (``ground_truth.tour``); it is then
    the shortest way among its neighbours, not proven to be the shortest of all.

    Answers are remembered by geometry alone: planner, seed, drive and names make no difference.

    Args:
        scenario: A realised scenario (``scenario.realise``): every obstacle listed.
        radius: Radius of the disc (m), more than 0; by default the robot's.

    Returns:
        The route of the disc's centre. It has length 0 when the start is within the goal already.
        None too when the disc does not fit at the start.

    Raises:
        ValueError: If obstacles are still to be drawn, or ``radius`` is not positive and finite.
    """
    return _route(_Question.of(scenario, radius))


def feasible(scenario: Scenario, radius: float | None = None) -> bool:
    """Return whether there is any way of a disc from the start to the goal disc.

    With via points, whether there is one to the disc of each, and on from its centre.

    Cheaper than ``shortest_path`` where there is one: it stops at the first way it finds.

    Args:
        scenario: A realised scenario.
        radius: Radius of the disc (m), more than 0; by default the robot's.

    Raises:
        ValueError: As ``shortest_path``.
    """
    return _is_feasible(_Question.of(scenario, radius))


def spl(success: bool, shortest: float, driven: float) -> float:
    """Return success weighted by path length (Anderson et al. 2018, arXiv:1807.06757), 0 to 1.

    Args:
        success: Whether the run reached the goal.
        shortest: Length of the shortest path (m), at least 0.
        driven: Length of the driven path (m), at least 0.

    Returns:
        ``success · shortest / max(driven, shortest)``; 1 for a success without any way to go.
    """
    if not success:
        return 0.0
    longest = max(driven, shortest)
    return shortest / longest if longest > 0.0 else 1.0


@lru_cache(maxsize=_REMEMBERED)
def _route(asked: _Question) -> Route | None:
    space = asked.space()
    return tour(partial(shortest_route, space), asked.start, asked.discs)


@lru_cache(maxsize=_REMEMBERED)
def _is_feasible(asked: _Question) -> bool:
    space = asked.space()
    begins = (asked.start, *(centre for centre, _ in asked.discs))
    legs = zip(begins, asked.discs, strict=False)
    return all(is_connected(space, begin, centre, radius) for begin, (centre, radius) in legs)


__all__ = ["GRAZE", "Route", "feasible", "shortest_path", "spl"]
