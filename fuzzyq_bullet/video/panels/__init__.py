"""The panels below the scene, each a card that explains one step of a decision."""

from fuzzyq_bullet.video.panels import action, curves, fuzzification, rules, sensors
from fuzzyq_bullet.video.panels.base import Canvas, Panel, Panels, added_panels, register_panel

__all__ = [
    "Canvas",
    "Panel",
    "Panels",
    "action",
    "added_panels",
    "curves",
    "fuzzification",
    "register_panel",
    "rules",
    "sensors",
]
