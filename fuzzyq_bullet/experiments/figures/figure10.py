"""Fig. 10: the deadlock in a semicircle of obstacles, and three ways out.

In (a) ``breakout: false`` takes the scheme away; (b) is the same trap with it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyq_bullet.experiments.figures.panels import Grid, Panel, draw_panels

if TYPE_CHECKING:
    from pathlib import Path

PANELS = (
    Panel("figure-10a", "Without breakout"),
    Panel("figure-10b", "With breakout, goal horizontal"),
    Panel("figure-10c", "With breakout, goal vertical"),
    Panel("figure-10d", "With breakout, goal oblique"),
)
GRID = Grid(columns=2)


def draw(out: Path) -> list[Path]:
    """Run all panels in physics and draw them into ``out/figure10.png``.

    Raises:
        UserError: If the file cannot be written.
    """
    return draw_panels(out, "figure10", PANELS, GRID)
