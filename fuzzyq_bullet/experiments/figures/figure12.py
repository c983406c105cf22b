"""Fig. 12: nine environments, each crossed from start to goal.

All obstacles are drawn from the scenarios' seeds.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyq_bullet.experiments.figures.panels import Grid, Panel, draw_panels

if TYPE_CHECKING:
    from pathlib import Path

PANELS = (
    Panel("figure-12a", "80 obstacles"),
    Panel("figure-12b", "80 obstacles, another field"),
    Panel("figure-12c", "80 obstacles, other start and goal"),
    Panel("figure-12d", "120 obstacles"),
    Panel("figure-12e", "120 obstacles, another field"),
    Panel("figure-12f", "30 rectangles"),
    Panel("figure-12g", "30 rectangles, other start and goal"),
    Panel("figure-12h", "60 rectangles"),
    Panel("figure-12i", "60 rectangles, other start and goal"),
)
GRID = Grid(columns=3, legend=7, targets=False)


def draw(out: Path) -> list[Path]:
    """Run all panels in physics and draw them into ``out/figure12.png``.

    Raises:
        UserError: If the file cannot be written.
    """
    return draw_panels(out, "figure12", PANELS, GRID)
