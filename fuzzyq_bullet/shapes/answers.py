"""What a shape of the user's own must answer: asked once, when a scenario has such an obstacle."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.blame import blamed
from fuzzyq_bullet.errors import UserError

if TYPE_CHECKING:
    from fuzzyq_bullet.shapes.base import Shape

_FARTHEST = 1e6
"""Nothing of an obstacle is farther away than this (m)."""
_STRAIGHT = 1e-9
"""A corner that turns the wrong way by less than this (m²) is of rounding."""


def check_answers(shape: Shape) -> None:
    """Ask a shape for all that is asked of it later.

    Raises:
        UserError: If it raises, or answers what cannot be.
    """
    who = f"shape {shape.shape}"
    with blamed(who, "in outline"):
        _check_polygon(f"{who}: outline", shape.outline())
    with blamed(who, "in pieces"):
        for piece in shape.pieces():
            _check_polygon(f"{who}: pieces", piece, convex=True)
    with blamed(who, "in faces"):
        _check_polygon(f"{who}: faces", shape.faces())
    with blamed(who, "in corners"):
        points, radius = shape.corners()
        _check_points(f"{who}: corners", points, least=1)
        _check_length(f"{who}: the radius of corners", radius)
    with blamed(who, "in extent"):
        _check_length(f"{who}: extent", shape.extent())
    with blamed(who, "in thickness"):
        _check_length(f"{who}: thickness", shape.thickness())
    with blamed(who, "in collisions"):
        if not shape.collisions(1.0):
            raise UserError(f"{who}: collisions must return one solid at least")
    with blamed(who, f"in {shape.group.__name__}"):
        group, (x, y) = shape.group.of([shape]), shape.position
        told = group.distances(np.array([[x]]), np.array([[y]]))
        if told.shape != (1, 1) or not np.isfinite(told).all():
            raise UserError(f"{who}: distances must return a number for each point and obstacle")
        group.free_distances(x, y, np.array([[1.0]]), np.array([[0.0]]), 0.1)


def _check_length(what: str, told: Any) -> None:
    if not 0.0 <= told < _FARTHEST:
        raise UserError(f"{what} must be a length (m), not {told}")


def _check_points(what: str, told: Any, least: int) -> NDArray[np.float64]:
    points = np.asarray(told, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < least:
        raise UserError(f"{what} must be at least {least} points x, y (m)")
    if not (np.abs(points) < _FARTHEST).all():
        raise UserError(f"{what} must be finite numbers (m)")
    return points


def _check_polygon(what: str, told: Any, *, convex: bool = False) -> None:
    points = _check_points(what, told, least=3)
    side = np.roll(points, -1, axis=0) - points
    x, y = (points - points[0]).T
    if not float(np.sum(x * side[:, 1] - y * side[:, 0])) > 0.0:
        raise UserError(f"{what} must go anticlockwise around an area")
    after = np.roll(side, -1, axis=0)
    if convex and (side[:, 0] * after[:, 1] - side[:, 1] * after[:, 0] < -_STRAIGHT).any():
        raise UserError(f"{what} must be convex: each corner turns left")
