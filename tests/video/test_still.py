"""The picture of what stands still is the one that the robot's renderer would make."""

from __future__ import annotations

import numpy as np
import pytest

from fuzzyq_bullet.physics.camera import NOTHING, Lens, Mesh, add_mesh, shoot
from fuzzyq_bullet.physics.engine import Engine
from fuzzyq_bullet.video.scene.meshes import prisms
from fuzzyq_bullet.video.scene.still import photograph

_LENS = Lens(
    eye=(0.3, -6.0, 6.0),
    target=(0.0, 0.0, 0.0),
    field_of_view=0.6,
    size=(160, 120),
    near=1.0,
    far=30.0,
)
_SQUARE = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])


@pytest.fixture
def solids() -> list[Mesh]:
    """Ground, and two blocks of which one stands in front of the other and runs into it."""
    turned = _SQUARE @ np.array([(0.8, 0.6), (-0.6, 0.8)])
    return [
        prisms([1.5 * _SQUARE], -0.05, 0.0, (200, 200, 210)),
        prisms([0.5 * _SQUARE + (0.2, 0.3)], 0.0, 0.6, (180, 90, 40)),
        prisms([0.4 * turned - (0.1, 0.4)], 0.0, 0.4, (40, 160, 90)),
    ]


def test_it_shows_what_the_renderer_of_the_robot_shows(solids: list[Mesh]) -> None:
    picture = photograph(solids, _LENS, oversampling=2)
    with Engine() as engine:
        bodies = [add_mesh(engine, mesh) for mesh in solids]
        rendered = shoot(engine, _LENS, (0, 0, 160, 120), oversampling=2)
    for index, body in enumerate(bodies):
        assert np.mean((picture.mask == index) != (rendered.mask == body)) < 1e-4
    both = (picture.mask != NOTHING) & (rendered.mask >= 0)
    assert set(np.unique(picture.mask)) == {NOTHING, 0, 1, 2}
    difference = np.abs(picture.colour.astype(int) - rendered.colour.astype(int)).max(axis=-1)
    assert np.mean(difference[both] > 1) < 1e-3
    assert np.quantile(np.abs(picture.depth - rendered.depth)[both], 0.999) < 1e-5


def test_a_surface_is_seen_from_outside_alone() -> None:
    up = prisms([_SQUARE], 0.0, 0.1, (9, 9, 9))
    inside_out = Mesh(up.vertices, up.normals, up.triangles[:, ::-1], up.colour)
    lid = Mesh(up.vertices, up.normals, inside_out.triangles[-2:], up.colour)
    assert (photograph([lid], _LENS).mask == NOTHING).all()


def test_what_is_behind_the_camera_is_not_seen() -> None:
    behind = prisms([_SQUARE - (0.0, 30.0)], 0.0, 20.0, (9, 9, 9))
    assert (photograph([behind], _LENS).mask == NOTHING).all()
