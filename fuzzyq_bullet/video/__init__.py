"""A record in, an explaining video out: scene, map, and the reason for every turn."""

from fuzzyq_bullet.video.record import VideoInfo, frame, record

__all__ = ["VideoInfo", "frame", "record"]
