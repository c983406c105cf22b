"""Collision groups: who may touch whom, and what a ray may hit."""

from __future__ import annotations

from enum import IntFlag


class Group(IntFlag):
    """What a body belongs to; masks are made of the same."""

    RAYS = 1  # PyBullet's own: every ray belongs to it and hits only what admits it
    WHEELS = 2
    BODY = 4
    OBSTACLES = 8
    WALLS = 16
    GROUND = 32
    FACES = 64
