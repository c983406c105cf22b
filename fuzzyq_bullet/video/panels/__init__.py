"""The panels below the scene, each a card that explains one step of a decision."""

from fuzzyq_bullet.video.panels import action, curves, fuzzification, rules, sensors
from fuzzyq_bullet.video.panels.base import Canvas, Panel, Panels, frame_size, register_panel

__all__ = [
    "Canvas",
    "Panel",
    "Panels",
    "action",
    "curves",
    "frame_size",
    "fuzzification",
    "register_panel",
    "rules",
    "sensors",
]
