"""Fig. 4: step and turn of the fuzzy controller as surfaces over its two inputs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from fuzzyq_bullet.figures import MARK
from fuzzyq_bullet.figures.style import save_png
from fuzzyq_bullet.files import writable_folder
from fuzzyq_bullet.fuzzy import ControllerDefinition, FuzzyController, paper_controller
from fuzzyq_bullet.fuzzy.memberships import Floats
from fuzzyq_bullet.fuzzy.sets import Variable

POINTS = 61
"""Points along each input: enough for a smooth surface, few enough to draw at once."""


def draw(
    out: Path, rules: ControllerDefinition | None = None, name: str = "figure4.png"
) -> list[Path]:
    """Draw both surfaces side by side into one file.

    Args:
        out: Folder.
        rules: Whose surfaces; by default those of the paper's controller.
        name: What the file is called.

    Raises:
        UserError: If the file cannot be written.
    """
    path = writable_folder(out) / name
    save_png(
        picture(paper_controller() if rules is None else rules.controller()),
        path,
        metadata={"Software": MARK},
    )
    return [path]


def surfaces(
    controller: FuzzyController, points: int = POINTS
) -> tuple[Floats, Floats, Floats, Floats]:
    """Return d, Df, N_s and N_a on a grid, each of shape (points, points), a row for each Df."""
    base = controller.base
    distance, difference = np.meshgrid(
        np.linspace(*base.row.domain, points), np.linspace(*base.column.domain, points)
    )
    found = [
        controller.infer(d, df)
        for d, df in zip(distance.ravel().tolist(), difference.ravel().tolist(), strict=True)
    ]
    stride = np.array([one.stride for one in found]).reshape(distance.shape)
    turn = np.array([one.turn for one in found]).reshape(distance.shape)
    return distance, difference, stride, turn


def picture(controller: FuzzyController) -> Figure:
    """Return the figure: (a) the step N_s and (b) the turn N_a, as the paper orders them."""
    figure = Figure(figsize=(13, 6.4), dpi=120)
    distance, difference, stride, turn = surfaces(controller)
    turn_variable, step_variable = controller.base.outputs
    _panel(
        figure,
        1,
        "(a) Step",
        (distance, difference, stride),
        ("step $N_s$  (in $S_p$)", step_variable),
    )
    _panel(
        figure,
        2,
        "(b) Turn, positive to the left",
        (distance, difference, turn),
        ("turn $N_a$  (in $A_p$)", turn_variable),
    )
    figure.subplots_adjust(left=0.03, right=0.97, bottom=0.06, top=0.94, wspace=0.06)
    return figure


def _panel(
    figure: Figure,
    place: int,
    title: str,
    surface: tuple[Floats, Floats, Floats],
    output: tuple[str, Variable],
) -> None:
    # Any: matplotlib ships no types for its three-dimensional axes.
    axes: Any = figure.add_subplot(1, 2, place, projection="3d")
    label, variable = output
    low, high = variable.domain
    # viridis rises in lightness, so it reads in grey and with every kind of colour vision.
    axes.plot_surface(
        *surface, cmap="viridis", vmin=low, vmax=high, rcount=POINTS, ccount=POINTS,
        linewidth=0.2, edgecolor=(0, 0, 0, 0.25), antialiased=True,
    )  # fmt: skip
    axes.set_title(title, fontsize=16, y=1.0)
    axes.set_xlabel("free distance ahead $d$  (in $S_p$)", fontsize=12, labelpad=10)
    axes.set_ylabel("left less right $Df$  (in $S_p$)", fontsize=12, labelpad=10)
    axes.zaxis.set_rotate_label(False)
    axes.set_zlabel(label, fontsize=12, labelpad=10, rotation=90)
    axes.set_zlim(low, high)
    axes.set_zticks(np.linspace(low, high, 5))
    axes.view_init(elev=28, azim=-125)
    axes.set_box_aspect((1, 1, 0.75), zoom=1.0)
