"""Figs. 9 to 12: runs from the paper's environments, seen from above, panel by panel.

Each panel is a bundled scenario, run in physics and drawn from its record.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from fuzzyq_bullet.episode import run
from fuzzyq_bullet.figures import MARK, file_name
from fuzzyq_bullet.figures.style import INK, save_png
from fuzzyq_bullet.figures.topdown import LEGEND, draw_run
from fuzzyq_bullet.files import writable_folder
from fuzzyq_bullet.platforms import data_folder
from fuzzyq_bullet.recording.metrics import result_of
from fuzzyq_bullet.recording.trajectory import Trajectory
from fuzzyq_bullet.scenario import Scenario, load_scenario, with_options

ENDS = {
    "goal": "goal reached: {time:.1f} s, {way}{shortest}",
    "stuck": "stuck: {way}, given up at {time:.1f} s",
    "timeout": "out of time: {time:.1f} s, {way}",
    "collision": "collision: {time:.1f} s, {way}",
}
"""What the title of a panel says of each outcome."""

_DPI = 120
_GAP = 0.16
"""Between panels, and around the figure (inches)."""
_TITLE = 0.52
"""Height of a panel's two lines of title (inches)."""


class Panel(NamedTuple):
    """One panel of a figure: the bundled scenario that is run, and what it shows."""

    scenario: str
    words: str


class Grid(NamedTuple):
    """How the panels of a figure are laid out.

    Attributes:
        columns: Panels in a row.
        side: Width of a panel (inches).
        legend: Entries in a row of the legend.
        targets: Whether the temporary goals of breakouts are shown.
        close_up: Middle (x, y) and side (m) of what is drawn once more, larger, below each panel.
    """

    columns: int
    side: float = 4.4
    legend: int = 4
    targets: bool = True
    close_up: tuple[float, float, float] | None = None


class RunsFigure(NamedTuple):
    """A figure made of runs: name of its file, scenarios that are run, and their arrangement."""

    name: str
    panels: tuple[Panel, ...]
    grid: Grid

    def draw(self, out: Path, planner: str | None = None) -> list[Path]:
        """Run all panels and draw them into ``out/NAME.png``.

        Args:
            out: The folder.
            planner: Planner that drives instead, with the same settings as far as it has them; its
                name becomes part of the file's.

        Raises:
            UserError: If the file cannot be written, or there is no such planner.
        """
        scenarios = [with_options(scenario_of(panel), planner=planner) for panel in self.panels]
        path = writable_folder(out) / file_name(self.name, planner)
        runs = [run(scenario) for scenario in scenarios]
        figure = picture(self.panels, runs, self.grid)
        told = {"Software": MARK}
        save_png(figure, path, bbox_inches="tight", pad_inches=_GAP, metadata=told)
        return [path]


FIGURES = {
    # One field, drawn with one seed. In (a) and (b) Algorithm 2 is off (``margin: 0``), and an
    # obstacle stands 4 mm from the robot's disc at the start, or from the goal's; bodies cannot
    # share a place as they do in the paper. The controller is the same in all three.
    9: RunsFigure(
        "figure9",
        (
            Panel("figure-9a", "Obstacle at the start"),
            Panel("figure-9b", "Obstacle at the goal"),
            Panel("figure-9c", "Algorithm 2 keeps both clear"),
        ),
        Grid(columns=3, legend=3, close_up=(1.3, 1.3, 2.4)),
    ),
    # In (a) ``breakout: false`` takes the scheme away; (b) is the same trap with it.
    10: RunsFigure(
        "figure10",
        (
            Panel("figure-10a", "Without breakout"),
            Panel("figure-10b", "With breakout, goal horizontal"),
            Panel("figure-10c", "With breakout, goal vertical"),
            Panel("figure-10d", "With breakout, goal oblique"),
        ),
        Grid(columns=2),
    ),
    # In (a) ``following: false`` takes the scheme away; (b) is the same obstacle with it.
    11: RunsFigure(
        "figure11",
        (
            Panel("figure-11a", "Without sustained avoidance"),
            Panel("figure-11b", "With sustained avoidance"),
        ),
        Grid(columns=2, legend=3),
    ),
    # All obstacles are drawn from their seeds.
    12: RunsFigure(
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
    ),
}
"""By number."""


def scenario_of(panel: Panel) -> Scenario:
    """Return the bundled scenario, whatever files of its name lie about."""
    return load_scenario(data_folder("scenarios") / f"{panel.scenario}.yaml")


def picture(panels: Sequence[Panel], runs: Sequence[Trajectory], grid: Grid) -> Figure:
    """Return the figure: a panel for each run, lettered from (a), and one legend for all."""
    parts = 1 if grid.close_up is None else 2
    columns, rows = grid.columns, -(-len(panels) // grid.columns)
    cell = _TITLE + parts * (grid.side + _GAP)
    size = (columns * (grid.side + _GAP) - _GAP, rows * cell - _GAP)
    figure = Figure(figsize=size, dpi=_DPI)

    shown: dict[str, Artist] = {}
    for index, (panel, trajectory) in enumerate(zip(panels, runs, strict=True)):
        left = index % columns * (grid.side + _GAP)
        top = index // columns * cell + _TITLE
        axes = _axes(figure, left, top, grid.side)
        shown |= draw_run(axes, trajectory, targets=grid.targets)
        _entitle(axes, index, panel, trajectory)
        if grid.close_up is not None:
            below = _axes(figure, left, top + grid.side + _GAP, grid.side)
            draw_run(below, trajectory, targets=grid.targets)
            _enlarge(axes, below, grid.close_up)
    words = [entry for entry in LEGEND if entry in shown]
    figure.legend(
        [shown[entry] for entry in words], words, loc="upper center", bbox_to_anchor=(0.5, 0.0),
        ncols=grid.legend, frameon=False, fontsize=11, columnspacing=1.8, handlelength=1.6,
        title=_scale(runs, grid), title_fontsize=11,
    )  # fmt: skip
    return figure


def _axes(figure: Figure, left: float, top: float, side: float) -> Axes:
    """Return square axes at a place measured from the figure's upper left corner (inches)."""
    width, height = figure.get_size_inches()
    axes = figure.add_axes((left / width, 1 - (top + side) / height, side / width, side / height))
    axes.tick_params(bottom=False, left=False, labelbottom=False, labelleft=False)
    return axes


def _entitle(axes: Axes, index: int, panel: Panel, trajectory: Trajectory) -> None:
    result = result_of(trajectory)
    way = result.path_length_m
    driven = f"{way:.1f} m" if way >= 1.0 else f"{1000 * way:.0f} mm"
    best = result.shortest_path_m
    shortest = "" if best is None else f" (shortest: {best:.1f} m)"
    end = ENDS[result.outcome].format(time=result.time_s, way=driven, shortest=shortest)
    axes.set_title(f"({chr(ord('a') + index)}) {panel.words}", fontsize=12, weight="bold", pad=23)
    axes.annotate(
        end, (0.5, 1.0), (0, 6), xycoords="axes fraction", textcoords="offset points",
        ha="center", va="bottom", fontsize=11,
    )  # fmt: skip


def _scale(runs: Sequence[Trajectory], grid: Grid) -> str:
    """Say who drove, and how large all this is."""
    sizes = {run.scenario.arena.size for run in runs}
    planners = {run.scenario.planner.name for run in runs}
    parts = [f"planner {', '.join(sorted(planners))}"]
    parts += [f"arena {width:g} × {depth:g} m" for width, depth in sorted(sizes)]
    if grid.close_up is not None:
        parts.append("below: {0:g} × {0:g} m of it".format(grid.close_up[2]))
    return "; ".join(parts)


def _enlarge(axes: Axes, below: Axes, close_up: tuple[float, float, float]) -> None:
    """Show a part of the arena alone, and where it lies in the whole."""
    x, y, side = close_up
    below.set_xlim(x - side / 2, x + side / 2)
    below.set_ylim(y - side / 2, y + side / 2)
    for spine in below.spines.values():
        spine.set(linewidth=1.0, linestyle=(0, (5, 3)))
    corner = (x - side / 2, y - side / 2)
    axes.add_patch(
        Rectangle(corner, side, side, fc="none", ec=INK, lw=1.0, ls=(0, (5, 3)), zorder=9)
    )
