"""All robots side by side on the ground, seen from ahead and above."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.physics.camera import NOTHING, Lens, shoot
from fuzzyq_bullet.physics.engine import Engine
from fuzzyq_bullet.physics.robot import VisibleRobot
from fuzzyq_bullet.robots import RobotModel

_SIZE = (1200, 360)
_GAP = 0.2
_PAPER = 246


def portrait(models: Sequence[RobotModel]) -> NDArray[np.uint8]:
    """Return a picture of robots in one scale, the first on the left, shape (h, w, 3)."""
    at, middles = 0.0, []
    for model in models:
        middles.append(at + model.radius)
        at += 2 * model.radius + _GAP
    length = at - _GAP
    lens = Lens(
        eye=(2.2 * length, length / 2, 1.1 * length),
        target=(0.0, length / 2, 0.1),
        field_of_view=0.145,
        size=_SIZE,
        near=0.5,
        far=5 * length,
    )
    with Engine() as engine:
        for model, middle in zip(models, middles, strict=True):
            VisibleRobot(engine, model).place((0.0, middle), 0.6)
        picture = shoot(engine, lens, (0, 0, *_SIZE), 2)
    colour = picture.colour.astype(float)
    colour[picture.mask == NOTHING] = _PAPER
    # Each pixel is the mean of the four that were taken of it.
    small = colour.reshape(_SIZE[1], 2, _SIZE[0], 2, 3).mean(axis=(1, 3))
    return np.rint(small).astype(np.uint8)
