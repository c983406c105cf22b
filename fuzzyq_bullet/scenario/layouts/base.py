"""What every layout is: parameters that a scenario gives, and how to draw from them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, TypeAlias, TypeVar

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer

from fuzzyq_bullet.quantities import MAX_OBSTACLES, Model, ModelRegistry
from fuzzyq_bullet.scenario.layouts.wanderers import Wanderers
from fuzzyq_bullet.shapes import Obstacle

if TYPE_CHECKING:
    import numpy as np
    from typing_extensions import Self

    from fuzzyq_bullet.scenario.models import Scenario

Conflict: TypeAlias = tuple[tuple[str, ...], str]
"""The keys below ``random`` that lead to what cannot be right, and what is wrong with it."""


class Layout(Model):
    """The ``random`` part of a scenario. Subclasses narrow ``layout`` to their own name."""

    layout: str
    movers: Wanderers | None = Field(
        default=None, description="Obstacles that wander among those that are drawn."
    )

    @model_serializer(mode="wrap")
    def _without_movers(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Leave out that nothing wanders."""
        told: dict[str, Any] = handler(self)
        if self.movers is None:
            told.pop("movers", None)
        return told

    def draw(self, scenario: Scenario, rng: np.random.Generator) -> tuple[Obstacle, ...]:
        """Return the obstacles, beside those that the scenario lists.

        The arena's lower left corner is at (0, 0) here: ``realise`` moves the scenario there, and
        the obstacles back.

        The same scenario and generator give the same obstacles; none of them overlaps the start or
        the goal disc; coordinates are rounded to 0.1 mm.

        Raises:
            UserError: If they cannot be placed.
        """
        raise NotImplementedError

    def moved(self, x: float, y: float) -> Self:
        """Return it with the places that it names moved (m); it may name none."""
        return self

    def conflicts(self, scenario: Scenario) -> list[Conflict]:
        """Return what can be known to be impossible without drawing."""
        return []


LAYOUTS: ModelRegistry[Layout] = ModelRegistry("layout", default="scatter")
"""All layouts, by the name that a scenario gives in ``random.layout``."""
AnyLayout: TypeAlias = Annotated[Layout, LAYOUTS]
_L = TypeVar("_L", bound=type[Layout])


def register_layout(layout: _L) -> _L:
    """Make a layout known to scenario files: a decorator for subclasses of ``Layout``.

    The subclass narrows ``layout`` to its own name, has its parameters as fields, and implements
    ``draw``; ``scenario.layouts.placing`` tells whether what is drawn may stay. In a file that
    ``--plugin`` names::

        from typing import Literal

        from fuzzyq_bullet.quantities import Count
        from fuzzyq_bullet.scenario.layouts import Layout, register_layout
        from fuzzyq_bullet.scenario.layouts.placing import is_clear
        from fuzzyq_bullet.shapes import Cylinder

        @register_layout
        class Row(Layout):
            layout: Literal["row"]
            count: Count

            def draw(self, scenario, rng):
                x, depth = scenario.arena.size[0] / 2, scenario.arena.size[1]
                ys = rng.uniform(0.0, depth, self.count).round(4).tolist()
                drawn = [Cylinder(shape="cylinder", position=(x, y), radius=0.2) for y in ys]
                return tuple(one for one in drawn if is_clear(scenario, [one], 0.1))

    A scenario file then has ``random: {layout: row, count: 4}``. A layout of the package itself is
    a module here that ``scenario/layouts/__init__.py`` imports.

    Raises:
        ValueError: If the name is taken.
    """
    LAYOUTS.add(layout)
    return layout


def too_many(scenario: Scenario, count: int, key: str = "count") -> list[Conflict]:
    """Return the conflict of more obstacles than a scenario may have, if it is one."""
    room = MAX_OBSTACLES - len(scenario.obstacles)
    if count <= room:
        return []
    return [((key,), f"must be at most {room} beside the listed obstacles, got {count}")]
