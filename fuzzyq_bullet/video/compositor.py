"""One frame from all its parts: which of them changed at a moment, and how they look now."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from fuzzyq_bullet.video.captions import Clock, Story, caption, outcome_card
from fuzzyq_bullet.video.decision_hold import DecisionHold
from fuzzyq_bullet.video.map import Map
from fuzzyq_bullet.video.panels import Panels
from fuzzyq_bullet.video.scene import Scene
from fuzzyq_bullet.video.style import SCENE
from fuzzyq_bullet.video.timeline import Sensed, sensed_at

if TYPE_CHECKING:
    from collections.abc import Iterator

    from fuzzyq_bullet.trajectory import Trajectory
    from fuzzyq_bullet.video.paint import DirtyRegion
    from fuzzyq_bullet.video.timeline import Moment


class Compositor:
    """All views of one run. Use as a context: the scene holds a renderer.

    Scene and map are live. The panels and the sentence show one decision, the same one.

    Args:
        trajectory: The run.
        speed: Seconds of the run in one second of video.
    """

    def __init__(self, trajectory: Trajectory, speed: float = 1.0) -> None:
        self._trajectory = trajectory
        self._map = Map(trajectory)
        self._panels = Panels(trajectory)
        self._clock = Clock(speed)
        self._story = Story(trajectory)
        self._hold = DecisionHold(trajectory, speed)
        self._fresh = True
        self._decision: int | None = None
        self._sensed: Sensed | None = None
        self._over = False
        self._scene = Scene(trajectory)

    def __enter__(self) -> Compositor:
        return self

    def __exit__(self, *_: object) -> None:
        self._scene.close()

    def changes(self, moment: Moment) -> Iterator[DirtyRegion]:
        """Yield what changed since the last moment; all of the frame, the first time."""
        if self._over and moment.over:
            return
        if self._fresh:
            self._fresh = False
            yield caption(self._trajectory)
        if moment.decision != self._decision:
            self._decision = moment.decision
            self._sensed = sensed_at(self._trajectory, moment.decision)
        moment = replace(moment, shown=self._hold.at(moment))
        sensed = self._sensed
        hit = (
            self._trajectory.collision.point if moment.over and self._trajectory.collision else None
        )
        for region in (
            self._scene.draw(moment, sensed, hit),
            self._map.draw(moment, sensed, hit),
            *self._panels.changes(moment),
            self._clock.draw(moment),
            self._story.draw(moment.shown, over=moment.over),
        ):
            if region is not None:
                yield region
        if moment.over:
            self._over = True
            # Where the run ended must stay in sight.
            low = self._scene.height_of(moment.position) < SCENE.height / 2
            yield outcome_card(self._trajectory, low=low)


def closing(moment: Moment) -> Moment:
    """Return the last moment as one at which the run has ended."""
    return replace(moment, over=True)
