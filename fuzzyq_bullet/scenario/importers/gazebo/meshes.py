"""Meshes of Gazebo models, read by trimesh (the extra ``maps``)."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import read_bytes
from fuzzyq_bullet.reading.xml_tree import read_xml
from fuzzyq_bullet.scenario.importers.gazebo.solids import Floats
from fuzzyq_bullet.wording import shorten

_MAX_BYTES = 50_000_000
_MAX_FACES = 1_000_000
_SUFFIXES = (".stl", ".obj", ".dae")
_AS_IT_IS = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
_UP = {
    "X_UP": ((0, -1, 0), (0, 0, -1), (1, 0, 0)),
    "Y_UP": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "Z_UP": _AS_IT_IS,
}
"""Right, inwards and up of a COLLADA file turned to x, y and z."""


def read_mesh(path: Path, where: str) -> tuple[Floats, NDArray[np.intp]]:
    """Return the corners (m), shape (N, 3), and the triangles, shape (M, 3), of a mesh.

    Args:
        path: A mesh in STL, OBJ or COLLADA (DAE).
        where: File, line and key that name it, for messages.

    Raises:
        UserError: If trimesh is missing, or the file cannot be read, is too large or no mesh.
    """
    suffix = path.suffix.lower()
    if suffix not in _SUFFIXES:
        allowed = ", ".join(_SUFFIXES)
        raise UserError(f"{where}: no mesh format {shorten(suffix)}; allowed: {allowed}")
    try:
        import trimesh
    except ImportError as error:
        raise UserError(
            f"{where}: meshes are read by trimesh, which is not installed: "
            "pip install 'fuzzyq_bullet[maps]'"
        ) from error
    content = read_bytes(path, what="a mesh", most=_MAX_BYTES)
    turned, unit = _conventions(path) if suffix == ".dae" else (_AS_IT_IS, 1.0)
    try:
        mesh: Any = trimesh.load(
            io.BytesIO(content), file_type=suffix[1:], force="mesh", skip_materials=True
        )
        points = np.asarray(mesh.vertices, dtype=np.float64)
        triangles = np.asarray(mesh.faces, dtype=np.intp).reshape(-1, 3)
    except ImportError as error:
        raise UserError(
            f"{where}: COLLADA files are read by pycollada, which is not installed: "
            "pip install 'fuzzyq_bullet[maps]'"
        ) from error
    except Exception as error:  # a damaged file makes trimesh raise ten kinds
        raise UserError(f"{path}: is no mesh ({suffix[1:].upper()}) that can be read") from error
    if not len(triangles) or not np.isfinite(points).all() or np.abs(points).max() > 1e6:
        raise UserError(f"{path}: is a mesh without triangles, or with corners that are nowhere")
    if len(triangles) > _MAX_FACES:
        raise UserError(f"{path}: {len(triangles)} triangles; at most {_MAX_FACES} are read")
    return points @ np.array(turned).T * unit, triangles


def bodies(points: Floats, triangles: NDArray[np.intp]) -> list[NDArray[np.intp]]:
    """Return the triangles of each part of a mesh that hangs together."""
    _, same = np.unique(np.round(points, 6), axis=0, return_inverse=True)
    corners = same.reshape(-1)[triangles]
    pairs = np.concatenate([corners[:, :2], corners[:, 1:]])
    count = int(corners.max()) + 1
    links = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    _, part = connected_components(links, directed=False)
    of_triangle = part[corners[:, 0]]
    order = np.argsort(of_triangle, kind="stable")
    borders = np.flatnonzero(np.diff(of_triangle[order])) + 1
    return [triangles[chosen] for chosen in np.split(order, borders)]


def _conventions(path: Path) -> tuple[Any, float]:
    """Return the axes and the unit (m) of a COLLADA file, which is safe to read after this."""
    asset = read_xml(path, "a mesh (COLLADA)").first("asset")
    up = asset.first("up_axis") if asset else None
    unit = asset.first("unit") if asset else None
    try:
        metre = float(unit.attributes.get("meter", "1")) if unit else 1.0
    except ValueError:
        metre = 1.0
    return _UP.get(up.text.strip() if up else "Y_UP", _UP["Z_UP"]), metre
