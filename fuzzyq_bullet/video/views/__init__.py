"""What a film shows, each way in a module of its own: explain, scene, follow, map (``above``)."""

from fuzzyq_bullet.video.views.base import Stage, View, register_view, view_factory, view_names

# Each makes itself known as it is imported, in the order in which messages name them.
from fuzzyq_bullet.video.views import explain, scene, follow, above  # isort: skip

__all__ = [
    "Stage",
    "View",
    "above",
    "explain",
    "follow",
    "register_view",
    "scene",
    "view_factory",
    "view_names",
]
