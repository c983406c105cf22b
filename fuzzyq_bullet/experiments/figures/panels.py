"""Figures made of panels: each a bundled scenario, run in physics and drawn from its record."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from fuzzyq_bullet.episode import run
from fuzzyq_bullet.experiments.figures import MARK
from fuzzyq_bullet.experiments.figures.topdown import LEGEND, draw_run
from fuzzyq_bullet.files import writable_folder, written_beside
from fuzzyq_bullet.metrics import result_of
from fuzzyq_bullet.resources import data_folder
from fuzzyq_bullet.scenario import load_scenario

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

    from fuzzyq_bullet.scenario import Scenario
    from fuzzyq_bullet.trajectory import Trajectory

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
    """One panel of a figure.

    Attributes:
        scenario: Name of the bundled scenario that is run.
        words: What it shows, in a few words.
    """

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


def draw_panels(out: Path, name: str, panels: Sequence[Panel], grid: Grid) -> list[Path]:
    """Run the scenario of every panel and draw all of them into ``out/NAME.png``.

    Raises:
        UserError: If the file cannot be written.
    """
    path = writable_folder(out) / f"{name}.png"
    figure = picture(panels, [run(scenario_of(panel)) for panel in panels], grid)
    with written_beside(path) as part:
        told = {"Software": MARK}
        figure.savefig(part, format="png", bbox_inches="tight", pad_inches=_GAP, metadata=told)
    return [path]


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
    FigureCanvasAgg(figure)

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
    """Say how large all this is."""
    sizes = {run.scenario.arena.size for run in runs}
    parts = [f"arena {width:g} × {depth:g} m" for width, depth in sorted(sizes)]
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
        Rectangle(corner, side, side, fc="none", ec="#222222", lw=1.0, ls=(0, (5, 3)), zorder=9)
    )
