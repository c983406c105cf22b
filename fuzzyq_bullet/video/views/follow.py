"""The view of a camera that follows the robot, from near."""

from __future__ import annotations

from fuzzyq_bullet.video.scene.cameras import FollowCamera
from fuzzyq_bullet.video.views.base import register_view
from fuzzyq_bullet.video.views.scene import SceneView


@register_view("follow")
class FollowView(SceneView):
    """The scene about the robot; robot and lines are as large in a large arena as in a small."""

    def _camera(self) -> FollowCamera:
        return FollowCamera(self._trajectory, self._place.size, self._layout.unit)
