"""How the pictures for print look: dark on white, in Okabe and Ito's palette.

The colour-blind tell these colours apart. Whatever a colour says is also said by a shape, a width
or a place, so that a picture can be read in grey.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fuzzyq_bullet.files import written_beside

INK = "#222222"
GREY = "#7C828C"
GRID = "#D9DCE1"
BLUE = "#0072B2"
SKY = "#56B4E9"
GREEN = "#009E73"
ORANGE = "#E69F00"
RED = "#D55E00"
PURPLE = "#A0478A"
BROWN = "#7A4B10"


def new_figure(width: float, height: float, *, dpi: int = 120) -> Figure:
    """Return an empty figure (inches) that lays itself out."""
    return Figure(figsize=(width, height), dpi=dpi, layout="constrained")


def tidy(axes: Axes, grid: Literal["x", "y", "both"]) -> None:
    """Leave of the frame two sides, and lay a grid of lines below all that is drawn."""
    axes.grid(axis=grid, color=GRID, lw=0.8)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def plain(words: str) -> str:
    """Return somebody's words so that matplotlib writes them as they are.

    It would read ``$`` as the beginning of a formula, leave out what begins with ``_``, and has no
    signs for many letters.
    """
    shown = words.encode("ascii", "backslashreplace").decode().replace("$", r"\$")
    return f" {shown}" if shown.startswith("_") else shown


def save_png(figure: Figure, path: Path, **options: Any) -> None:
    """Write a figure as a PNG, whole or not at all.

    Args:
        figure: It.
        path: The file.
        options: For ``Figure.savefig``.

    Raises:
        UserError: If the file cannot be written.
    """
    with written_beside(path) as part:
        figure.savefig(part, format="png", **options)
