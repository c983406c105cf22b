"""Fig. 9: an obstacle at the start, one at the goal, and Algorithm 2, which keeps both clear.

One field, drawn with one seed. In (a) and (b) Algorithm 2 is switched off (``margin: 0``), and an
obstacle stands 4 mm from the robot's disc at the start, or from the goal's; bodies cannot share a
place as they do in the paper. The controller is the same in all three.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyq_bullet.experiments.figures.panels import Grid, Panel, draw_panels

if TYPE_CHECKING:
    from pathlib import Path

PANELS = (
    Panel("figure-9a", "Obstacle at the start"),
    Panel("figure-9b", "Obstacle at the goal"),
    Panel("figure-9c", "Algorithm 2 keeps both clear"),
)
GRID = Grid(columns=3, legend=3, close_up=(1.3, 1.3, 2.4))


def draw(out: Path) -> list[Path]:
    """Run all panels in physics and draw them into ``out/figure9.png``.

    Raises:
        UserError: If the file cannot be written.
    """
    return draw_panels(out, "figure9", PANELS, GRID)
