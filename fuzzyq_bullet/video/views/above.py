"""The view of the field from straight above."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyq_bullet.video.map.map import Map
from fuzzyq_bullet.video.views.base import Picture, register_view

if TYPE_CHECKING:
    from fuzzyq_bullet.recording.trajectory import Trajectory
    from fuzzyq_bullet.video.paint import DirtyRegion
    from fuzzyq_bullet.video.timeline import Moment
    from fuzzyq_bullet.video.views.base import Stage


@register_view("map")
class MapView(Picture):
    """The map as the film that explains has it, larger."""

    def __init__(self, trajectory: Trajectory, stage: Stage) -> None:
        super().__init__(trajectory, stage)
        self._map = Map(trajectory, self._place, self._layout.unit)

    def _picture(self, moment: Moment) -> DirtyRegion | None:
        return self._map.draw(moment, self._sensing.at(moment), self._sensing.hit(moment))

    def _is_high(self, moment: Moment) -> bool:
        return bool(self._map.spot([moment.position])[0, 1] < self._place.height / 2)
