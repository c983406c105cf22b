"""What the films' camera sees of a robot: where it faces."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

from fuzzyq_bullet.physics.camera import Lens, RobotCamera
from fuzzyq_bullet.robots import RobotModel, robot_model
from fuzzyq_bullet.robots.urdf_checks import robot_from_urdf

ROOT = Path(__file__).resolve().parents[2]
LENS = Lens(
    eye=(0.0, -0.01, 4.0),
    target=(0.0, 0.0, 0.0),
    field_of_view=0.25,
    size=(200, 200),
    near=1.0,
    far=6.0,
)
"""From straight above: up in the picture is north."""
NOWHERE = -1

CART = (ROOT / "examples" / "robots" / "cart.urdf").read_text()


def cart(folder: Path, colour: str) -> RobotModel:
    """Return a robot of one's own: a bare box of a colour."""
    path = folder / "cart.urdf"
    path.write_text(re.sub('rgba="[^"]*"', f'rgba="{colour} 1"', CART))
    return robot_from_urdf(path)


def faces(model: RobotModel, heading: float) -> int:
    """Return which way an arrow on a robot points in the picture, in quarter turns from right.

    What is marked on its lid tapers that way.
    """
    with RobotCamera(LENS, model) as camera:
        picture = camera.shoot((0, 0, *LENS.size), (0.0, 0.0), heading)
    middle = slice(LENS.size[0] // 2 - 22, LENS.size[0] // 2 + 22)
    lid = picture.colour[middle, middle].mean(axis=2)
    marked = np.abs(lid - np.median(lid)) > 60
    if not marked.any():
        return NOWHERE
    tapers = []
    for quarter in range(4):
        turned = np.rot90(marked, -quarter)
        columns = np.flatnonzero(turned.any(axis=0))
        third = (columns[-1] - columns[0]) // 3
        behind = turned[:, columns[0] : columns[0] + third].any(axis=1).sum()
        ahead = turned[:, columns[-1] - third + 1 : columns[-1] + 1].any(axis=1).sum()
        tapers.append(int(behind) - int(ahead))
    return int(np.argmax(tapers))


@pytest.mark.parametrize("colour", ["0.9 0.5 0.1", "0.95 0.95 0.95", "0.05 0.05 0.05"])
def test_a_robot_of_ones_own_has_an_arrow_that_turns_with_it(tmp_path: Path, colour: str) -> None:
    model = cart(tmp_path, colour)
    assert [faces(model, quarter * math.pi / 2) for quarter in range(4)] == [0, 1, 2, 3]


def test_the_default_robot_has_the_same_and_others_keep_their_mark() -> None:
    assert [faces(robot_model("fuzzyq"), quarter * math.pi / 2) for quarter in (0, 1)] == [0, 1]
    with RobotCamera(LENS, robot_model("turtlebot3-burger")) as camera:
        seen = camera.shoot((0, 0, *LENS.size), (0.0, 0.0), 0.0)
    assert set(np.unique(seen.mask)) == {-1, 0}  # the robot alone: nothing was laid on it
