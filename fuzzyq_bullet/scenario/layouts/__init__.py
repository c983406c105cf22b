"""Layouts: what a scenario asks to be drawn, made into obstacles.

A layout is a model of its parameters that can draw, made known by ``register_layout``; one of your
own comes from a file that ``--plugin`` names (``examples/extend/layout.py``).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fuzzyq_bullet.blame import blamed
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.quantities import MAX_OBSTACLES
from fuzzyq_bullet.scenario.layouts.base import LAYOUTS, AnyLayout, Layout, register_layout
from fuzzyq_bullet.scenario.layouts.scatter import Random  # the default comes first
from fuzzyq_bullet.scenario.layouts.wanderers import Wanderers
from fuzzyq_bullet.shapes import Shape

from fuzzyq_bullet.scenario.layouts.traps import Arc, LongWall, Semicircle, UShape  # isort: skip
from fuzzyq_bullet.scenario.layouts.rectangles import Rectangles  # isort: skip
from fuzzyq_bullet.scenario.layouts.maze import Maze  # isort: skip
from fuzzyq_bullet.scenario.layouts.cellular import Cellular  # isort: skip

if TYPE_CHECKING:
    from fuzzyq_bullet.scenario.models import Scenario


def realise(scenario: Scenario, seed: int | None = None) -> Scenario:
    """Return the scenario with its ``random`` part replaced by the obstacles it stands for.

    The result is what is run, recorded and saved: it has no ``random`` part, its obstacles are the
    listed ones followed by the drawn ones, those that wander last, and ``seed`` is the one they
    were drawn with. The same scenario and seed give the same obstacles; what stands is the same
    whether anything wanders or not. Coordinates are rounded to 0.1 mm.

    Args:
        scenario: A scenario that ``check`` finds nothing wrong with.
        seed: Overrides ``scenario.seed``.

    Raises:
        UserError: If the obstacles asked for cannot be placed.
    """
    seed = scenario.seed if seed is None else seed
    if scenario.random is None:
        return scenario.model_copy(update={"seed": seed})
    drawn = _drawn(scenario, scenario.random, np.random.default_rng(seed))
    obstacles = (*scenario.obstacles, *drawn)
    if scenario.random.movers is not None:
        obstacles += scenario.random.movers.draw(scenario, obstacles, seed)
    return scenario.model_copy(update={"obstacles": obstacles, "random": None, "seed": seed})


def _drawn(scenario: Scenario, layout: Layout, rng: np.random.Generator) -> tuple[Shape, ...]:
    """Return what a layout draws in a scenario, whose arena may be anywhere.

    Raises:
        UserError: If it cannot place what is asked for, raises, or draws what is no obstacle.
    """
    x, y = scenario.arena.origin
    who = f"{scenario.name}: random: layout {layout.layout}"
    with blamed(who, "as it drew"):
        if x == y == 0.0:
            drawn = tuple(layout.draw(scenario, rng))
        else:
            there = scenario.moved(-x, -y)
            assert there.random is not None
            drawn = tuple(there.random.draw(there, rng))
    if not all(isinstance(one, Shape) for one in drawn):
        raise UserError(f"{who}: draw must return obstacles")
    room = MAX_OBSTACLES - len(scenario.obstacles)
    if len(drawn) > room:
        raise UserError(f"{who}: drew {len(drawn)} obstacles; at most {room} have room")
    return drawn if x == y == 0.0 else tuple(one.moved(x, y, 0.0) for one in drawn)


__all__ = [
    "LAYOUTS",
    "AnyLayout",
    "Arc",
    "Cellular",
    "Layout",
    "LongWall",
    "Maze",
    "Random",
    "Rectangles",
    "Semicircle",
    "UShape",
    "Wanderers",
    "realise",
    "register_layout",
]
