"""A record in, an explaining video out: scene, map, and the reason for every turn."""

from fuzzyq_bullet.video.paint import DirtyRegion
from fuzzyq_bullet.video.panels import Canvas, Panel, register_panel
from fuzzyq_bullet.video.record import VideoInfo, frame, record, write_still
from fuzzyq_bullet.video.timeline import Moment
from fuzzyq_bullet.video.views import Stage, View, register_view

__all__ = [
    "Canvas",
    "DirtyRegion",
    "Moment",
    "Panel",
    "Stage",
    "VideoInfo",
    "View",
    "frame",
    "record",
    "register_panel",
    "register_view",
    "write_still",
]
