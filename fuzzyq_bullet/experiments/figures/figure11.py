"""Fig. 11: a large obstacle without and with sustained avoidance.

In (a) ``following: false`` takes the scheme away; (b) is the same obstacle with it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyq_bullet.experiments.figures.panels import Grid, Panel, draw_panels

if TYPE_CHECKING:
    from pathlib import Path

PANELS = (
    Panel("figure-11a", "Without sustained avoidance"),
    Panel("figure-11b", "With sustained avoidance"),
)
GRID = Grid(columns=2, legend=3)


def draw(out: Path) -> list[Path]:
    """Run all panels in physics and draw them into ``out/figure11.png``.

    Raises:
        UserError: If the file cannot be written.
    """
    return draw_panels(out, "figure11", PANELS, GRID)
