"""The view of the scene alone: the 3-D picture fills the frame, with a camera that stands still."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyq_bullet.video.scene.scene import Scene
from fuzzyq_bullet.video.views.base import Picture, register_view

if TYPE_CHECKING:
    from fuzzyq_bullet.recording.trajectory import Trajectory
    from fuzzyq_bullet.video.paint import DirtyRegion
    from fuzzyq_bullet.video.scene.cameras import Camera
    from fuzzyq_bullet.video.timeline import Moment
    from fuzzyq_bullet.video.views.base import Stage


@register_view("scene")
class SceneView(Picture):
    """The scene as the film that explains has it, larger."""

    def __init__(self, trajectory: Trajectory, stage: Stage) -> None:
        super().__init__(trajectory, stage)
        self._scene = Scene(
            trajectory, self._place, self._layout.unit, camera=self._camera(), framed=False
        )

    def close(self) -> None:
        """Free the scene's renderer."""
        self._scene.close()

    def _camera(self) -> Camera | None:
        """Return who films it; None for the usual camera."""
        return None

    def _picture(self, moment: Moment) -> DirtyRegion | None:
        return self._scene.draw(moment, self._sensing.at(moment), self._sensing.hit(moment))

    def _is_high(self, moment: Moment) -> bool:
        return self._scene.height_of(moment.position) < 0.5
