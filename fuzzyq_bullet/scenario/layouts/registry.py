"""All layouts, by the name that a scenario gives in ``random.layout``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, TypeAlias

from pydantic import BeforeValidator, Field

from fuzzyq_bullet.scenario.layouts.arc import Arc, Semicircle
from fuzzyq_bullet.scenario.layouts.long_wall import LongWall
from fuzzyq_bullet.scenario.layouts.maze import Maze
from fuzzyq_bullet.scenario.layouts.rectangles import Rectangles
from fuzzyq_bullet.scenario.layouts.scatter import Random
from fuzzyq_bullet.scenario.layouts.u_shape import UShape

DEFAULT_LAYOUT = "scatter"


def _with_layout(value: Any) -> Any:
    """Name the default layout where none is named."""
    if isinstance(value, Mapping) and "layout" not in value:
        return {"layout": DEFAULT_LAYOUT, **value}
    return value


AnyLayout: TypeAlias = Annotated[
    Annotated[
        Random | Semicircle | Arc | UShape | LongWall | Rectangles | Maze,
        Field(discriminator="layout"),
    ],
    BeforeValidator(_with_layout),
]
