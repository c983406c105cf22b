"""One frame after the other: which parts of a view changed at a moment, and how they look now."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from fuzzyq_bullet.video.decision_hold import DecisionHold
from fuzzyq_bullet.video.layout import usual_size
from fuzzyq_bullet.video.panels import added_panels
from fuzzyq_bullet.video.panels.base import named
from fuzzyq_bullet.video.timeline import Timeline
from fuzzyq_bullet.video.views import Stage, view_factory

if TYPE_CHECKING:
    from collections.abc import Iterable

    from fuzzyq_bullet.recording.trajectory import Trajectory
    from fuzzyq_bullet.video.paint import DirtyRegion
    from fuzzyq_bullet.video.timeline import Moment


class Compositor:
    """The frames of one run. Use as a context: a view may hold a renderer.

    Args:
        trajectory: The run.
        speed: Seconds of the run in one second of video.
        view: The name of what is shown.
        size: Width and height of the frame (pixels); by default the view's usual size.

    Attributes:
        size: Width and height of the frame (pixels).
        start: Time of the first moment (s).
        end: Time of the last (s).

    Raises:
        UserError: If there is no such view.
    """

    def __init__(
        self,
        trajectory: Trajectory,
        speed: float = 1.0,
        view: str = "explain",
        size: tuple[int, int] | None = None,
    ) -> None:
        factory = view_factory(view)
        self.size = size or usual_size(added_panels() if view == "explain" else 0)
        self._timeline = Timeline(trajectory)
        self.start, self.end = self._timeline.start, self._timeline.end
        self._hold = DecisionHold(trajectory, speed)
        self._over = False
        self._name = f"view {view}"
        with named(self._name):
            self._view = factory(trajectory, Stage(self.size, speed))

    def __enter__(self) -> Compositor:
        return self

    def __exit__(self, *_: object) -> None:
        self._view.close()

    def at(self, time: float) -> Iterable[DirtyRegion]:
        """Return what changed since the last time (s); after the end, how the run ended."""
        moment = self._timeline.at(time)
        return self.changes(closing(moment) if time > self.end else moment)

    def changes(self, moment: Moment) -> Iterable[DirtyRegion]:
        """Return what changed since the last moment; all of the frame, the first time."""
        if self._over and moment.over:
            return []
        self._over = moment.over
        with named(self._name):
            return list(self._view.draw(replace(moment, shown=self._hold.at(moment))))


def closing(moment: Moment) -> Moment:
    """Return the last moment as one at which the run has ended."""
    return replace(moment, over=True)
