"""The view that explains: scene and map, why the robot turned in words, and step by step."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyq_bullet.video.captions import Clock, Story, caption, outcome_card
from fuzzyq_bullet.video.layout import Layout
from fuzzyq_bullet.video.map.map import Map
from fuzzyq_bullet.video.panels import Panels, added_panels
from fuzzyq_bullet.video.scene.scene import Scene
from fuzzyq_bullet.video.views.base import Sensing, Stage, View, known, register_view

if TYPE_CHECKING:
    from collections.abc import Iterator

    from fuzzyq_bullet.recording.trajectory import Trajectory
    from fuzzyq_bullet.video.paint import DirtyRegion
    from fuzzyq_bullet.video.timeline import Moment


@register_view("explain")
class Explain(View):
    """Scene and map are live. The panels and the sentence show one decision, the same one."""

    def __init__(self, trajectory: Trajectory, stage: Stage) -> None:
        self._trajectory = trajectory
        self._layout = layout = Layout.explaining(stage.size, added_panels())
        place, unit = layout.place, layout.unit
        self._map = Map(trajectory, place("map"), unit)
        self._panels = Panels(trajectory, layout)
        self._clock = Clock(stage.speed, place("header"), unit)
        self._story = Story(trajectory, place("story"), unit)
        self._sensing = Sensing(trajectory)
        self._fresh = True
        self._scene = Scene(trajectory, place("scene"), unit)

    def close(self) -> None:
        """Free the scene's renderer."""
        self._scene.close()

    def draw(self, moment: Moment) -> Iterator[DirtyRegion]:
        """Yield what changed since the last moment; all of the frame, the first time."""
        place, unit = self._layout.place, self._layout.unit
        if self._fresh:
            self._fresh = False
            yield caption(self._trajectory, place("header"), unit)
        sensed, hit = self._sensing.at(moment), self._sensing.hit(moment)
        yield from known(
            self._scene.draw(moment, sensed, hit),
            self._map.draw(moment, sensed, hit),
            *self._panels.changes(moment),
            self._clock.draw(moment),
            self._story.draw(moment.shown, over=moment.over),
        )
        if moment.over:
            # Where the run ended must stay in sight.
            low = self._scene.height_of(moment.position) < 0.5
            yield outcome_card(self._trajectory, place("scene"), unit, low=low)
