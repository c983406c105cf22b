"""What a panel of the film is, what it draws on, and how one comes to be known."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import count
from typing import TYPE_CHECKING, Protocol, TypeAlias, TypeVar

from numpy.typing import ArrayLike
from PIL import Image, ImageDraw

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.video import paint, style
from fuzzyq_bullet.video.paint import DirtyRegion
from fuzzyq_bullet.wording import error_in_words

if TYPE_CHECKING:
    from fuzzyq_bullet.recording.trajectory import Trajectory
    from fuzzyq_bullet.video.layout import Layout
    from fuzzyq_bullet.video.style import Colour, Rect
    from fuzzyq_bullet.video.timeline import Moment


class Canvas:
    """The card of one panel. What is drawn stays until something is drawn over it.

    Points are counted to the right and down from the card's upper left corner. In a film of the
    usual size a point is a pixel; in a larger film the card is enlarged.

    Args:
        card: Where in the frame the card lies (points).
        title: What is written at its top; 26 points there are the title's.
        place: The same in pixels; by default a point is a pixel.

    Attributes:
        image: The card, RGB. Whoever draws on it directly calls ``changed``.
        width: Its width (points).
        height: Its height (points).
    """

    def __init__(self, card: Rect, title: str, place: Rect | None = None) -> None:
        self.width, self.height = card.size
        self.image = paint.card(card, title)
        self._place = place or card
        self._blank = self.image.copy()
        self._changed: list[paint.Box] = [(0, 0, *card.size)]

    def rename(self, title: str) -> None:
        """Write another title in place of the one that was given; the rest is left as it is."""
        strip = Image.new("RGB", (self.width - 20, 22), style.CARD)
        paint.write(strip, (2, 16), title, style.MUTED, 16, bold=True)
        self._blank.paste(strip, (10, 4))
        self.paste(strip, (10, 4))

    def blank(self, box: paint.Box | None = None) -> Image.Image:
        """Return a part of the empty card, or all of it, to be drawn on and pasted."""
        return self._blank.crop(box or (0, 0, self.width, self.height))

    def paste(self, image: Image.Image, at: tuple[int, int] = (0, 0)) -> None:
        """Put a picture on the card, its upper left corner at ``at``."""
        self.image.paste(image, at)
        self.changed((*at, at[0] + image.width, at[1] + image.height))

    def wipe(self) -> None:
        """Make the card empty again."""
        self.paste(self._blank)

    def write(
        self,
        at: tuple[float, float],
        text: str,
        colour: Colour = style.TEXT,
        size: int = 17,
        *,
        bold: bool = False,
        align: str = "l",
    ) -> None:
        """Write a line of text; ``at`` is its left end, middle or right end (l, m, r)."""
        paint.write(self.image, at, text, colour, size, bold=bold, align=align)
        self.changed((0, 0, self.width, self.height))

    def line(self, points: ArrayLike, colour: Colour = style.TEXT, width: float = 2.0) -> None:
        """Draw a smooth line through points, shape (N, 2)."""
        self._stamp(points, colour, width, filled=False)

    def fill(self, points: ArrayLike, colour: Colour = style.TEXT) -> None:
        """Fill the polygon with these corners, shape (N, 2)."""
        self._stamp(points, colour, 1.0, filled=True)

    def _stamp(self, points: ArrayLike, colour: Colour, width: float, *, filled: bool) -> None:
        def draw(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
            corners = at(points)
            if not filled:
                paint.polyline(pen, corners, 255, width * at.factor)
            elif len(corners) >= 3:
                pen.polygon(corners, fill=255)

        drawn = paint.layer(points, width, (self.width, self.height), draw)
        if drawn is not None:
            drawn.lay(self.image, (0, 0, self.width, self.height), colour)
            self.changed(drawn.box)

    def changed(self, box: paint.Box) -> None:
        """Say that a part of ``image`` was drawn on."""
        left, top, right, bottom = box
        whole = (left // 2 * 2, top // 2 * 2, (right + 1) // 2 * 2, (bottom + 1) // 2 * 2)
        self._changed.append(whole)

    def take_changes(self) -> list[DirtyRegion]:
        """Return what was drawn on since the last time, as parts of the frame."""
        all_of_it = (0, 0, self.width, self.height)
        boxes = [all_of_it] if all_of_it in self._changed else self._changed
        self._changed = []
        return [paint.region_of(self._place, self.image, box) for box in boxes]


class Panel(Protocol):
    """A card of the film that shows something about a run; see ``register_panel``."""

    def draw(self, moment: Moment, /) -> None:
        """Draw on the canvas what is to be seen at a moment; nothing if nothing changed."""


PanelFactory: TypeAlias = "Callable[[Trajectory, Canvas], Panel]"
_F = TypeVar("_F", bound=PanelFactory)


@dataclass(frozen=True)
class _Entry:
    title: str
    factory: PanelFactory
    place: str | None


_entries: dict[str, _Entry] = {}


def register_panel(
    name: str, *, title: str | None = None, place: str | None = None
) -> Callable[[_F], _F]:
    """Make a panel known, so that every film shows it: a decorator of its class.

    The class is called with the trajectory and the canvas, on which it may draw at once what
    stays. In every frame its ``draw`` is called with the moment: ``time`` (s), ``tick``,
    ``position`` (m), ``heading`` (rad), ``speed`` (m/s), ``clearance`` (m), ``decision`` (the index
    of the decision in force, -1 before the first) and ``shown`` (the decision that all panels
    explain, which is held long enough to be read). ::

        from fuzzyq_bullet import Trajectory
        from fuzzyq_bullet.video import Canvas, Moment, register_panel

        @register_panel("speed", title="SPEED")
        class Speed:
            def __init__(self, trajectory: Trajectory, canvas: Canvas) -> None:
                self._canvas = canvas

            def draw(self, moment: Moment) -> None:
                self._canvas.wipe()
                self._canvas.write((12, 60), f"{moment.speed:.2f} m/s", size=24)

    ``fuzzyq run SCENARIO --plugin FILE`` loads it from a file of one's own. Its card lies in a row
    of its own below the others: the film becomes taller, nothing is covered. Up to four share a
    row, so a panel asks its canvas for the size. A panel of the package itself is a module here
    that ``video/panels/__init__.py`` imports.

    Args:
        name: What it is called in messages.
        title: What stands at the top of its card; by default its name in capitals.
        place: Its card in every ``Layout``; by default it has a place of its own below the others.

    Raises:
        ValueError: If the name is taken.
    """
    if name in _entries:
        raise ValueError(f"a panel named {name!r} is registered already")

    def keep(factory: _F) -> _F:
        _entries[name] = _Entry(name.upper() if title is None else title, factory, place)
        return factory

    return keep


def added_panels() -> int:
    """Return how many panels are registered that have no place among the others."""
    return sum(entry.place is None for entry in _entries.values())


class Panels:
    """All panels of one film.

    Args:
        trajectory: The run.
        layout: Where their cards lie.
    """

    def __init__(self, trajectory: Trajectory, layout: Layout) -> None:
        places = (f"added {number}" for number in count())
        self._panels: list[tuple[str, Panel, Canvas]] = []
        for name, entry in _entries.items():
            place = entry.place or next(places)
            canvas = Canvas(layout.cards[place], entry.title, layout.place(place))
            with named(f"panel {name}"):
                self._panels.append((name, entry.factory(trajectory, canvas), canvas))

    def changes(self, moment: Moment) -> list[DirtyRegion]:
        """Return what changed since the last moment."""
        regions = []
        for name, panel, canvas in self._panels:
            with named(f"panel {name}"):
                panel.draw(moment)
            regions += canvas.take_changes()
        return regions


@contextmanager
def named(what: str) -> Iterator[None]:
    """Turn what a panel or a view raises into one line that names it."""
    try:
        yield
    except (UserError, MemoryError):
        raise
    except Exception as error:
        raise UserError(f"{what}: {error_in_words(error)}") from error
