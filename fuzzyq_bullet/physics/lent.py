"""Lists for PyBullet, which never lets go of the lists that a mesh was given as.

A mesh leaks its list of corners, the list of each corner, and the list of its triangles. So the
same lists are lent again for every mesh: what leaks is counters, not memory.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

_SPARE: list[list[float]] = []
"""Lists of corners that are not in use. It grows to as many as one mesh has corners."""


@contextmanager
def lent(
    vertices: Sequence[Sequence[float]], triangles: Sequence[int]
) -> Iterator[tuple[list[list[float]], list[int]]]:
    """Lend lists of a mesh's corners (m) and of its triangles' indices for one call."""
    corners, indices = [_a_spare_list() for _ in vertices], list(triangles)
    for corner, vertex in zip(corners, vertices, strict=True):
        corner[:] = vertex
    try:
        yield corners, indices
    finally:
        _SPARE.extend(corners)
        corners.clear()
        indices.clear()


def _a_spare_list() -> list[float]:
    try:
        return _SPARE.pop()
    except IndexError:  # of another thread, perhaps: asking first would not help
        return []
