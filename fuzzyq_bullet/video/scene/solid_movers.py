"""Moving obstacles in the 3-D view: solid things put into the picture of the still world."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageChops

from fuzzyq_bullet.physics.obstacle_urdf import OBSTACLE_HEIGHT
from fuzzyq_bullet.video import paint, style
from fuzzyq_bullet.video.map.footprints import corners_for
from fuzzyq_bullet.video.movers import Drawn, DrawnMovers
from fuzzyq_bullet.video.scene import meshes
from fuzzyq_bullet.video.scene.still import photograph

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from fuzzyq_bullet.physics.camera import Lens, Mesh
    from fuzzyq_bullet.recording.trajectory import Trajectory
    from fuzzyq_bullet.video.map.footprints import Floats
    from fuzzyq_bullet.video.timeline import Moment

DETAIL = 2
"""How many times larger everything is rendered, to be shrunk to smooth edges."""
_LID = 0.004
"""Height of the arrow on top (m)."""


class Placed(NamedTuple):
    """A moving obstacle in the picture: its outline (m), its surfaces and the part it covers."""

    outline: Floats
    solids: list[Mesh]
    window: paint.Box


class SolidMovers:
    """The moving obstacles of one run, as a lens sees them.

    Args:
        trajectory: The run.
        lens: The camera.
    """

    def __init__(self, trajectory: Trajectory, lens: Lens) -> None:
        self._lens = lens
        away = float(np.linalg.norm(np.subtract(lens.eye, lens.target)))
        scale = lens.pixels_per_radian() / away
        self._movers = DrawnMovers(trajectory, lambda one: corners_for(one.extent() * scale))

    def __len__(self) -> int:
        return len(self._movers)

    def at(self, moment: Moment) -> list[Placed]:
        """Return those in the picture, the farthest first."""
        eye = self._lens.eye[:2]
        drawn = self._movers.at(moment.time, moment.tick)
        drawn.sort(key=lambda one: -float(np.hypot(*(one.outline.mean(axis=0) - eye))))
        return [placed for one in drawn for placed in self._placed(one)]

    def lay(
        self, image: Image.Image, box: paint.Box, movers: list[Placed], depth: NDArray[np.float32]
    ) -> Iterator[tuple[paint.Box, NDArray[np.float32]]]:
        """Put them into a part of the picture, behind whatever stands in front of them.

        Args:
            image: The part of the picture.
            box: Where it lies in the picture.
            movers: Which.
            depth: Depth of the picture, ``DETAIL`` times as large; theirs is put into it.

        Yields:
            The part that each covers, and the depth that was there before.
        """
        for one in movers:
            left, top, right, bottom = (DETAIL * k for k in one.window)
            seen = photograph(one.solids, self._lens, DETAIL, one.window)
            here = depth[top:bottom, left:right]
            before = here.copy()
            visible = (seen.mask >= 0) & (seen.depth < here)
            np.copyto(here, seen.depth, where=visible)
            lay_pixels(image, box, one.window, seen.colour, visible)
            yield one.window, before

    def _placed(self, one: Drawn) -> Iterator[Placed]:
        flat = np.concatenate([one.outline, one.outline])
        heights = np.repeat([0.0, OBSTACLE_HEIGHT + _LID], len(one.outline))
        seen = self._lens.project(np.column_stack([flat, heights]))
        if not np.isfinite(seen).all():
            return
        window = paint.box_around(seen, 1.0, self._lens.size)
        if window is None:
            return
        solids = [body_of(one.pieces), *([] if one.nose is None else [nose_of(one.nose)])]
        yield Placed(one.outline, solids, window)


def body_of(pieces: Sequence[Floats]) -> Mesh:
    """Return the solid over the convex pieces (m) of a moving obstacle."""
    return meshes.prisms(pieces, -0.02, OBSTACLE_HEIGHT, style.MOVER)


def nose_of(arrow: Floats) -> Mesh:
    """Return the arrow (m) on top of a moving obstacle."""
    return meshes.prisms([arrow], OBSTACLE_HEIGHT, OBSTACLE_HEIGHT + _LID, style.GROUND)


def put_back(
    depth: NDArray[np.float32], before: list[tuple[paint.Box, NDArray[np.float32]]]
) -> None:
    """Undo what ``SolidMovers.lay`` did to the depth of the picture."""
    for window, old in reversed(before):
        left, top, right, bottom = (DETAIL * k for k in window)
        depth[top:bottom, left:right] = old


def lay_pixels(
    image: Image.Image,
    box: paint.Box,
    window: paint.Box,
    colour: NDArray[np.uint8],
    visible: NDArray[np.bool_],
) -> None:
    """Put a picture that is ``DETAIL`` times as large into a part of another, where it is visible.

    Args:
        image: The part of the other picture.
        box: Where it lies there (pixels).
        window: Where the new picture lies there.
        colour: The new picture.
        visible: Which of its pixels are laid.
    """
    # Shrinking the coloured and the bare pixels together smooths the edge between the two.
    shown = np.where(visible[..., None], colour, 0).astype(np.uint8)
    small = Image.fromarray(shown).reduce(DETAIL)
    cover = Image.fromarray(np.where(visible, 255, 0).astype(np.uint8)).reduce(DETAIL)
    left, top, right, bottom = window
    at = (left - box[0], top - box[1])
    here = (*at, at[0] + right - left, at[1] + bottom - top)
    bare = image.crop(here)
    bare.paste((0, 0, 0), mask=cover)
    image.paste(ImageChops.add(bare, small), here)
