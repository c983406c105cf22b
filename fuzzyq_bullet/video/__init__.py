"""A record in, an explaining video out: scene, map, and the reason for every turn."""

from fuzzyq_bullet.video.panels import Canvas, Panel, register_panel
from fuzzyq_bullet.video.record import VideoInfo, frame, record
from fuzzyq_bullet.video.timeline import Moment

__all__ = ["Canvas", "Moment", "Panel", "VideoInfo", "frame", "record", "register_panel"]
