"""Several runs of one scenario in one film, in step: each in a scene of its own, all on one map."""

from __future__ import annotations

import math
from contextlib import ExitStack
from dataclasses import replace
from typing import TYPE_CHECKING

from PIL import Image

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.filming import VIEWS
from fuzzyq_bullet.video import paint, style
from fuzzyq_bullet.video.captions import SHORT_OUTCOMES, Story, planner_name
from fuzzyq_bullet.video.decision_hold import DecisionHold
from fuzzyq_bullet.video.layout import Layout, usual_size
from fuzzyq_bullet.video.paint import DirtyRegion
from fuzzyq_bullet.video.race_map import COLOURS, RaceMap
from fuzzyq_bullet.video.scene.cameras import Camera, FixedCamera, FollowCamera
from fuzzyq_bullet.video.scene.scene import Scene
from fuzzyq_bullet.video.style import Rect
from fuzzyq_bullet.video.timeline import Moment, Timeline
from fuzzyq_bullet.video.views.base import Sensing, known

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from fuzzyq_bullet.recording.trajectory import Trajectory

_TITLE = 34
"""Height of the line above a scene (points)."""
_ROW = 52
"""Height of what is said of a run below the map (points)."""
_GAP = 8


class Race:
    """The frames of a race. Use as a context: each scene holds a renderer.

    Args:
        trajectories: The runs, two to four, of one scenario.
        speed: Seconds of the runs in one second of video.
        view: One of ``VIEWS``.
        size: Width and height of the frame (pixels); 1280 × 720 by default.
        names: What the runs are called; by default their planners' names.

    Attributes:
        size: Width and height of the frame (pixels).
        start: Time of the first moment (s).
        end: Time at which the last of them ends (s).

    Raises:
        UserError: If they cannot be shown so.
    """

    def __init__(
        self,
        trajectories: Sequence[Trajectory],
        speed: float = 1.0,
        view: str = "explain",
        size: tuple[int, int] | None = None,
        names: Sequence[str] | None = None,
    ) -> None:
        runs = list(trajectories)
        check_race(runs, view)
        names = names or [planner_name(run) for run in runs]
        if len(names) != len(runs):
            raise UserError(f"names: there are {len(runs)} runs, and {len(names)} names")
        self.size = size or usual_size()
        self._layout = layout = _layout(self.size, len(runs), view)
        self._entrants = [
            Entrant(run, name, number, speed)
            for number, (run, name) in enumerate(zip(runs, names, strict=True))
        ]
        self.start = min(one.timeline.start for one in self._entrants)
        self.end = max(one.timeline.end for one in self._entrants)
        self._heading: DirtyRegion | None = _heading(runs[0], len(runs), layout, speed)
        with ExitStack() as stack:
            self._parts: list[_Tile | _Row] = []
            for one in self._entrants:
                if "map" in layout.cards:
                    row = layout.place(f"row {one.number}")
                    self._parts.append(_Row(one, row, layout.unit))
                if "tile 0" in layout.cards:
                    place = layout.place(f"tile {one.number}")
                    following = view == "follow"
                    tile = _Tile(one, place, layout.unit, runs, following=following)
                    stack.callback(tile.close)
                    self._parts.append(tile)
            self._map = (
                RaceMap(runs, layout.place("map"), layout.unit) if "map" in layout.cards else None
            )
            self._open = stack.pop_all()

    def __enter__(self) -> Race:
        return self

    def __exit__(self, *_: object) -> None:
        self._open.close()

    def at(self, time: float) -> Iterator[DirtyRegion]:
        """Yield what changed since the last time (s); all of the frame, the first time."""
        if self._heading is not None:
            yield self._heading
            self._heading = None
        for one in self._entrants:
            one.go_to(time)
        if self._map is not None:
            yield from self._map.draw([one.moment for one in self._entrants])
        for part in self._parts:
            yield from part.draw()


class Entrant:
    """One run of a race, at the moment that is shown.

    Attributes:
        run: The run.
        name: What it is called.
        number: Its number, from 0.
        timeline: Its moments.
        moment: The one that is shown.
    """

    def __init__(self, run: Trajectory, name: str, number: int, speed: float) -> None:
        self.run, self.name, self.number = run, name, number
        self.timeline = Timeline(run)
        self._hold = DecisionHold(run, speed)
        self._goal = run.scenario.goal.position
        self._story = Story(run)
        self.moment: Moment = self.timeline.at(0.0)

    def go_to(self, time: float) -> None:
        """Go to a time (s); after the end of the run it stays there."""
        moment = replace(self.timeline.at(time), over=time > self.timeline.end)
        self.moment = replace(moment, shown=self._hold.at(moment))

    def clock(self) -> str:
        """Return the time, which stands still when the run is over."""
        return f"{self.moment.time:.1f} s"

    def state(self) -> tuple[str, style.Colour]:
        """Return how far the goal is, or how the run ended, and its colour."""
        if self.moment.over:
            return SHORT_OUTCOMES[self.run.outcome]
        return f"{math.dist(self.moment.position, self._goal):.1f} m to go", style.MUTED

    def sentence(self) -> str:
        """Return why it heads where it does, or how it ended."""
        return self._story.sentence(self.moment.shown, over=self.moment.over)


class _Tile:
    """The scene of one run below a line with its name and its clock."""

    def __init__(
        self,
        entrant: Entrant,
        place: Rect,
        unit: float,
        runs: Sequence[Trajectory],
        *,
        following: bool,
    ) -> None:
        title = round(_TITLE * unit / 2) * 2
        self._entrant, self._unit = entrant, unit
        self._place = place._replace(height=title)
        rect = Rect(place.x, place.y + title, place.width, place.height - title)
        camera: Camera = FixedCamera(entrant.run, rect.size, runs)
        if following:
            camera = FollowCamera(entrant.run, rect.size, 0.6 * unit)
        self._scene = Scene(entrant.run, rect, unit, camera=camera)
        self._sensing = Sensing(entrant.run)
        self._shown: object = None

    def close(self) -> None:
        """Free the scene's renderer."""
        self._scene.close()

    def draw(self) -> Iterator[DirtyRegion]:
        """Yield what changed since the last moment."""
        one, moment = self._entrant, self._entrant.moment
        region = self._scene.draw(moment, self._sensing.at(moment), self._sensing.hit(moment))
        yield from known(region)
        state, colour = one.state()
        if not moment.over:
            state = ""
        if (state, one.clock()) != self._shown:
            self._shown = (state, one.clock())
            image = Image.new("RGB", self._place.size, style.PAGE)
            _write_entry(image, one, 24 * self._unit, self._unit, (state, colour))
            yield DirtyRegion(self._place.x, self._place.y, image)


class _Row:
    """What is said of one run below the map: name, clock, the way to go, and the reason."""

    def __init__(self, entrant: Entrant, place: Rect, unit: float) -> None:
        self._entrant, self._place, self._unit = entrant, place, unit
        self._card = paint.card(place, unit=unit)
        self._shown: object = None

    def draw(self) -> Iterator[DirtyRegion]:
        """Yield it if it says something else than last."""
        one, unit = self._entrant, self._unit
        said = (one.clock(), one.state(), one.sentence())
        if said == self._shown:
            return
        self._shown = said
        image = self._card.copy()
        _write_entry(image, one, 21 * unit, unit, one.state())
        room = image.width - 24 * unit
        sizes = style.scaled((16, 15, 14, 13), unit)
        text, size = style.fitting(one.sentence(), room, sizes)
        paint.write(image, (12 * unit, 43 * unit), text, style.TEXT, size)
        yield DirtyRegion(self._place.x, self._place.y, image)


def check_race(runs: Sequence[Trajectory], view: str) -> None:
    """Check that runs can be shown as a race.

    Raises:
        UserError: If they are too few or too many, of different fields, or there is no such view.
    """
    if view not in VIEWS:
        raise UserError(f"view: of a race must be one of {', '.join(VIEWS)}; got {view!r}")
    if not 2 <= len(runs) <= len(COLOURS):
        raise UserError(f"a race has two to {len(COLOURS)} runs; got {len(runs)}")
    first = runs[0].scenario
    for run in runs[1:]:
        other = run.scenario
        for name in ("arena", "obstacles", "goal"):
            if getattr(first, name) != getattr(other, name):
                raise UserError(
                    f"the runs of a race must be of one field: {name} of {other.name} "
                    f"(seed {other.seed}) differs from that of {first.name} (seed {first.seed})"
                )


def _write_entry(
    image: Image.Image, one: Entrant, y: float, unit: float, state: tuple[str, style.Colour]
) -> None:
    """Write the number, name, state and clock of a run on one line, whose baseline is ``y``."""
    box = (0, 0, *image.size)
    colour, (small, middle, big) = COLOURS[one.number], style.scaled((14, 17, 20), unit)
    at, radius = (20 * unit, y - 6 * unit), 11 * unit
    paint.stamp(
        image, box, [at], radius + 1, colour, lambda pen, s: pen.ellipse(s.disc(at, radius), 255)
    )
    number = str(one.number + 1)
    paint.write(image, (at[0], y - unit), number, style.PAGE, small, bold=True, align="m")
    clock = image.width - 10 * unit
    paint.write(image, (clock, y), one.clock(), style.TEXT, big, bold=True, align="r")
    text, tint = state
    right = clock - 84 * unit
    paint.write(image, (right, y), text, tint, middle, bold=tint != style.MUTED, align="r")
    left = 38 * unit
    room = right - style.text_width(text, middle, tint != style.MUTED) - 12 * unit - left
    name, size = style.fitting(
        one.name, room, style.scaled((20, 18, 16, 14, 12, 11), unit), bold=True
    )
    paint.write(image, (left, y), name, style.TEXT, size, bold=True)


def _heading(run: Trajectory, count: int, layout: Layout, speed: float) -> DirtyRegion:
    """Return the line that says which scenario it is."""
    place, unit = layout.place("header"), layout.unit
    image = Image.new("RGB", place.size, style.PAGE)
    big, small = style.scaled((24, 20), unit)
    detail = f"{count} runs in step   seed {run.scenario.seed}"
    if speed != 1.0:
        detail += f"   {speed:g}× speed"
    room = place.width - style.text_width(detail, small) - 32 * unit
    name, size = style.fitting(run.scenario.name, room, (big, small), bold=True)
    paint.write(image, (4 * unit, 28 * unit), name, style.TEXT, size, bold=True)
    x = style.text_width(name, size, True) + 28 * unit
    paint.write(image, (x, 28 * unit), detail, style.MUTED, small)
    return DirtyRegion(place.x, place.y, image)


def _layout(size: tuple[int, int], count: int, view: str) -> Layout:
    """Return where scenes, map and words lie."""
    plain = Layout.plain(size)
    across, bottom = plain.cards["picture"].width, plain.cards["picture"].bottom
    room = Rect(10, 40, across - 20, bottom - 50)
    wide = room.width >= 1.3 * room.height
    cards = {"header": plain.cards["header"]}
    tiles = aside = room
    if view == "explain":
        if wide:
            part = {2: 0.476, 3: 0.39, 4: 0.635}[count]
            tiles = room._replace(width=int(room.width * part) // 2 * 2)
            left = tiles.right + _GAP
            aside = Rect(left, room.y, room.right - left, room.height)
        else:
            tiles = room._replace(height=int(room.height * (0.45 if count < 4 else 0.5)))
            top = tiles.bottom + _GAP
            aside = Rect(room.x, top, room.width, room.bottom - top)
    if view != "map":
        upright = tiles.width < tiles.height
        columns = 2 if count == 4 else (1 if upright else count)
        cards |= _grid("tile", tiles, count, columns)
    if view in ("explain", "map"):
        rows = count * (_ROW + _GAP)
        if view == "map" and wide:
            beside = Rect(aside.right - 400, aside.y, 400, rows)
            cards["map"] = aside._replace(width=aside.width - 400 - _GAP)
        else:
            beside = Rect(aside.x, aside.bottom - rows + _GAP, aside.width, rows)
            cards["map"] = aside._replace(height=aside.height - rows)
        for number in range(count):
            top = beside.y + number * (_ROW + _GAP)
            cards[f"row {number}"] = Rect(beside.x, top, beside.width, _ROW)
    return Layout(size, plain.unit, cards)


def _grid(name: str, room: Rect, count: int, columns: int) -> dict[str, Rect]:
    """Return equal cards that fill a rectangle in columns."""
    lines = math.ceil(count / columns)
    width = (room.width - (columns - 1) * _GAP) // columns // 2 * 2
    height = (room.height - (lines - 1) * _GAP) // lines // 2 * 2
    return {
        f"{name} {number}": Rect(
            room.x + number % columns * (width + _GAP),
            room.y + number // columns * (height + _GAP),
            width,
            height,
        )
        for number in range(count)
    }
