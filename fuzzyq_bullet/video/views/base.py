"""What a view is, what it is given, and how one comes to be known."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias, TypeVar

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.video.captions import Clock, caption, outcome_card
from fuzzyq_bullet.video.layout import Layout, usual_size
from fuzzyq_bullet.video.panels.base import Canvas
from fuzzyq_bullet.video.style import Rect
from fuzzyq_bullet.video.timeline import NO_DECISION, Sensed, sensed_at

if TYPE_CHECKING:
    from fuzzyq_bullet.recording.trajectory import Trajectory
    from fuzzyq_bullet.video.paint import DirtyRegion
    from fuzzyq_bullet.video.timeline import Moment


@dataclass(frozen=True)
class Stage:
    """What a film offers a view.

    Attributes:
        size: Width and height of the frame (pixels), both even.
        speed: Seconds of the run in one second of video.
    """

    size: tuple[int, int] = usual_size()
    speed: float = 1.0

    def canvas(self, title: str = "") -> Canvas:
        """Return the whole frame as a card to draw on; see ``Layout.plain`` for its points."""
        layout = Layout.plain(self.size)
        picture = layout.cards["picture"]
        return Canvas(Rect(0, 0, picture.width, picture.bottom), title, Rect(0, 0, *self.size))


class View:
    """Fills the frames of a film; see ``register_view``."""

    def draw(self, moment: Moment) -> Iterable[DirtyRegion]:
        """Return what changed since the last moment; all of the frame, the first time."""
        raise NotImplementedError

    def close(self) -> None:
        """Free what it holds when the film is done."""


class Picture(View):
    """A view of one picture below a line with the scenario's name and the clock."""

    def __init__(self, trajectory: Trajectory, stage: Stage) -> None:
        self._trajectory = trajectory
        self._layout = layout = Layout.plain(stage.size)
        self._header, self._place = layout.place("header"), layout.place("picture")
        self._clock = Clock(stage.speed, self._header, layout.unit)
        self._sensing = Sensing(trajectory)
        self._fresh = True

    def draw(self, moment: Moment) -> Iterable[DirtyRegion]:
        """Return what changed since the last moment."""
        unit = self._layout.unit
        if self._fresh:
            self._fresh = False
            yield caption(self._trajectory, self._header, unit)
        yield from known(self._clock.draw(moment), self._picture(moment))
        if moment.over:
            yield outcome_card(self._trajectory, self._place, unit, low=self._is_high(moment))

    def _picture(self, moment: Moment) -> DirtyRegion | None:
        """Return what changed of the picture."""
        raise NotImplementedError

    def _is_high(self, moment: Moment) -> bool:
        """Whether the robot is in the upper half of the picture, which must stay in sight."""
        raise NotImplementedError


class Sensing:
    """What was sensed at each moment of one run, and what it hit in the end."""

    def __init__(self, trajectory: Trajectory) -> None:
        self._trajectory = trajectory
        self._decision = NO_DECISION
        self._sensed: Sensed | None = None

    def at(self, moment: Moment) -> Sensed | None:
        """Return what the decision in force was made of; the same object while it is in force."""
        if moment.decision != self._decision:
            self._decision = moment.decision
            self._sensed = sensed_at(self._trajectory, moment.decision)
        return self._sensed

    def hit(self, moment: Moment) -> tuple[float, float] | None:
        """Return where the robot collided (m), when that is over."""
        collision = self._trajectory.collision
        return collision.point if moment.over and collision else None


def known(*regions: DirtyRegion | None) -> Iterable[DirtyRegion]:
    """Return the regions among regions and nothing."""
    return [region for region in regions if region is not None]


ViewFactory: TypeAlias = "Callable[[Trajectory, Stage], View]"
_F = TypeVar("_F", bound=ViewFactory)
_factories: dict[str, ViewFactory] = {}


def register_view(name: str) -> Callable[[_F], _F]:
    """Make a view known, so that ``--view NAME`` films it: a decorator of its class.

    The class is called with the trajectory and a ``Stage``, whose ``canvas`` is the whole frame to
    draw on. In every frame its ``draw`` is called with the moment, as that of a panel is
    (``register_panel``), and returns what changed. ::

        from fuzzyq_bullet import Trajectory
        from fuzzyq_bullet.video import Moment, Stage, View, register_view

        @register_view("speed")
        class Speed(View):
            def __init__(self, trajectory: Trajectory, stage: Stage) -> None:
                self._canvas = stage.canvas()

            def draw(self, moment: Moment):
                self._canvas.wipe()
                self._canvas.write((640, 360), f"{moment.speed:.2f} m/s", size=90, align="m")
                return self._canvas.take_changes()

    ``fuzzyq run SCENARIO --plugin FILE --view speed`` loads it from a file of one's own. A view of
    the package itself is a module here that ``video/views/__init__.py`` imports.

    Args:
        name: What it is called: letters, digits, ``-`` and ``_``.

    Raises:
        ValueError: If the name is taken, or could not be part of a file's name.
    """
    if name in _factories:
        raise ValueError(f"a view named {name!r} is registered already")
    if not name.replace("-", "").replace("_", "").isalnum():
        raise ValueError(f"a view cannot be named {name!r}: letters, digits, - and _ only")

    def keep(factory: _F) -> _F:
        _factories[name] = factory
        return factory

    return keep


def view_names() -> list[str]:
    """Return the names of all views that are registered."""
    return list(_factories)


def view_factory(name: str) -> ViewFactory:
    """Return what makes a view.

    Raises:
        UserError: If there is none of that name.
    """
    if name not in _factories:
        raise UserError(f"view: must be one of {', '.join(_factories)}; got {name!r}")
    return _factories[name]
