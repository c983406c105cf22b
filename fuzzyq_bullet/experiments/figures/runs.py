"""Figs. 9 to 12: runs from the paper's environments, seen from above, panel by panel."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from fuzzyq_bullet.experiments.figures.panels import Grid, Panel, draw_panels

if TYPE_CHECKING:
    from pathlib import Path


class RunsFigure(NamedTuple):
    """A figure made of runs.

    Attributes:
        name: Of its file.
        panels: The scenarios that are run, in physics.
        grid: How they are arranged.
    """

    name: str
    panels: tuple[Panel, ...]
    grid: Grid

    def draw(self, out: Path) -> list[Path]:
        """Run all panels and draw them into ``out/NAME.png``.

        Raises:
            UserError: If the file cannot be written.
        """
        return draw_panels(out, self.name, self.panels, self.grid)


FIGURE_9 = RunsFigure(
    "figure9",
    (
        Panel("figure-9a", "Obstacle at the start"),
        Panel("figure-9b", "Obstacle at the goal"),
        Panel("figure-9c", "Algorithm 2 keeps both clear"),
    ),
    Grid(columns=3, legend=3, close_up=(1.3, 1.3, 2.4)),
)
"""An obstacle at the start, one at the goal, and Algorithm 2, which keeps both clear.

One field, drawn with one seed. In (a) and (b) Algorithm 2 is switched off (``margin: 0``), and an
obstacle stands 4 mm from the robot's disc at the start, or from the goal's; bodies cannot share a
place as they do in the paper. The controller is the same in all three.
"""
FIGURE_10 = RunsFigure(
    "figure10",
    (
        Panel("figure-10a", "Without breakout"),
        Panel("figure-10b", "With breakout, goal horizontal"),
        Panel("figure-10c", "With breakout, goal vertical"),
        Panel("figure-10d", "With breakout, goal oblique"),
    ),
    Grid(columns=2),
)
"""The deadlock in a semicircle of obstacles, and three ways out.

In (a) ``breakout: false`` takes the scheme away; (b) is the same trap with it.
"""
FIGURE_11 = RunsFigure(
    "figure11",
    (
        Panel("figure-11a", "Without sustained avoidance"),
        Panel("figure-11b", "With sustained avoidance"),
    ),
    Grid(columns=2, legend=3),
)
"""A large obstacle without and with sustained avoidance.

In (a) ``following: false`` takes the scheme away; (b) is the same obstacle with it.
"""
FIGURE_12 = RunsFigure(
    "figure12",
    (
        Panel("figure-12a", "80 obstacles"),
        Panel("figure-12b", "80 obstacles, another field"),
        Panel("figure-12c", "80 obstacles, other start and goal"),
        Panel("figure-12d", "120 obstacles"),
        Panel("figure-12e", "120 obstacles, another field"),
        Panel("figure-12f", "30 rectangles"),
        Panel("figure-12g", "30 rectangles, other start and goal"),
        Panel("figure-12h", "60 rectangles"),
        Panel("figure-12i", "60 rectangles, other start and goal"),
    ),
    Grid(columns=3, legend=7, targets=False),
)
"""Nine environments, each crossed from start to goal; all obstacles are drawn from their seeds."""
FIGURES = {9: FIGURE_9, 10: FIGURE_10, 11: FIGURE_11, 12: FIGURE_12}
