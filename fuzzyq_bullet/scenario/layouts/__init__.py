"""Layouts: the parts of a scenario that say how obstacles are to be drawn, made into obstacles.

A layout is a key of the scenario and a generator for it: one new file here and one line in
``GENERATORS``.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fuzzyq_bullet.scenario.layouts.scatter import scatter
from fuzzyq_bullet.scenario.models import Obstacle, Scenario

Generator = Callable[[Scenario, np.random.Generator], tuple[Obstacle, ...]]

GENERATORS: dict[str, Generator] = {"random": scatter}
"""Generators by the scenario's key that asks for them, in the order in which they draw."""


def realise(scenario: Scenario, seed: int | None = None) -> Scenario:
    """Return the scenario with every drawn part replaced by the obstacles it stands for.

    The result is what is run, recorded and saved: it has no ``random`` part, its obstacles are the
    listed ones followed by the drawn ones, and ``seed`` is the one they were drawn with. The same
    scenario and seed give the same obstacles. Coordinates are rounded to 0.1 mm.

    Args:
        scenario: A scenario that ``check`` finds nothing wrong with.
        seed: Overrides ``scenario.seed``.

    Raises:
        UserError: If the obstacles asked for cannot be placed.
    """
    seed = scenario.seed if seed is None else seed
    rng = np.random.default_rng(seed)
    for key, generate in GENERATORS.items():
        if getattr(scenario, key) is not None:
            drawn = generate(scenario, rng)
            update = {"obstacles": scenario.obstacles + drawn, key: None}
            scenario = scenario.model_copy(update=update)
    return scenario.model_copy(update={"seed": seed})


__all__ = ["GENERATORS", "Generator", "realise"]
