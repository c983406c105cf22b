"""The words of the frame: caption and clock, mode and reason, and at last the outcome."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageDraw

from fuzzyq_bullet.planning.decision import MODES
from fuzzyq_bullet.recording.fault import at_fault, speeds_in_words
from fuzzyq_bullet.recording.rules_turn import has_rules
from fuzzyq_bullet.video import paint, style
from fuzzyq_bullet.video.explanation import reason, struck
from fuzzyq_bullet.video.paint import DirtyRegion
from fuzzyq_bullet.video.style import HEADER, SCENE, STORY, Rect
from fuzzyq_bullet.video.timeline import NO_DECISION, Moment

if TYPE_CHECKING:
    from fuzzyq_bullet.recording.trajectory import Trajectory

_CLOCK = 240
"""Width of the clock (points)."""
_BADGE = 176
_PILL = (164, 38)
_BADGES = (19, 17, 15, 13)
_CARD = (800, 132)
_FROM_EDGE = 20
"""How far the card of the outcome lies from the upper or lower edge of the scene (points)."""
_MODE_COLOURS = {"routine": style.LINE, "breakout": style.TARGET, "following": style.TARGET}

_OUTCOMES = {
    "goal": ("GOAL reached", style.GOAL),
    "collision": ("COLLISION", style.DANGER),
    "timeout": ("TIME IS UP", style.HEAT),
    "stuck": ("STUCK: no way on", style.HEAT),
}
SHORT_OUTCOMES = {
    "goal": ("GOAL", style.GOAL),
    "collision": ("COLLISION", style.DANGER),
    "timeout": ("TIME IS UP", style.HEAT),
    "stuck": ("STUCK", style.HEAT),
}
"""Each outcome in a word or two, and its colour."""
_ENDINGS = {
    "goal": "In the goal",
    "collision": "Ran into something",
    "timeout": "Time is up before the goal",
    "stuck": "Finds no way on: stops",
}


def planner_name(trajectory: Trajectory) -> str:
    """Return the name of the planner that ran."""
    return str(getattr(trajectory.scenario.planner, "name", None) or "unknown planner")


def routine_name(trajectory: Trajectory) -> str:
    """Return what the mode of a planner is called while it goes its usual way.

    The routine part is the paper's. A planner without fuzzy rules is called by its name.
    """
    return "routine" if has_rules(trajectory.decisions) else planner_name(trajectory)


def caption(trajectory: Trajectory, rect: Rect = HEADER, unit: float = 1.0) -> DirtyRegion:
    """Return the line that says which scenario, planner and seed this is.

    Args:
        trajectory: The run.
        rect: Where it lies in the frame, the clock at its right end included.
        unit: Pixels a point; see ``Layout``.
    """
    scenario = trajectory.scenario
    image = Image.new("RGB", rect.size, style.PAGE)
    details = f"planner {planner_name(trajectory)}   seed {scenario.seed}"
    if scenario.drive == "kinematic":
        details += "   kinematic drive"
    room = rect.width - (_CLOCK + 24) * unit
    details, small = style.fitting(details, room * 0.7, style.scaled((20, 18, 16), unit))
    beside = room - style.text_width(details, small)
    sizes = style.scaled((24, 22, 20), unit)
    name, size = style.fitting(scenario.name, beside, sizes, bold=True)
    paint.write(image, (4 * unit, 28 * unit), name, style.TEXT, size, bold=True)
    x = style.text_width(name, size, True) + 28 * unit
    paint.write(image, (x, 28 * unit), details, style.MUTED, small)
    return DirtyRegion(rect.x, rect.y, image)


class Clock:
    """The time of the run, and how fast it is shown.

    Args:
        speed: Seconds of the run in one second of video.
        rect: The line at whose right end it stands.
        unit: Pixels a point.
    """

    def __init__(self, speed: float, rect: Rect = HEADER, unit: float = 1.0) -> None:
        self._speed = "" if speed == 1.0 else f"{speed:g}× speed"
        width = round(_CLOCK * unit / 2) * 2
        self._rect = Rect(rect.right - width, rect.y, width, rect.height)
        self._unit = unit
        self._shown = ""

    def draw(self, moment: Moment) -> DirtyRegion | None:
        """Return the clock if it shows another time than last."""
        text = f"{moment.time:.1f} s"
        if text == self._shown:
            return None
        self._shown = text
        rect, unit = self._rect, self._unit
        image = Image.new("RGB", rect.size, style.PAGE)
        pen = ImageDraw.Draw(image)
        at, (big, small) = (rect.width - 4 * unit, 28 * unit), style.scaled((24, 18), unit)
        paint.write(image, at, text, style.TEXT, big, bold=True, align="r")
        pen.text((0, 28 * unit), self._speed, style.MUTED, style.font(small), anchor="ls")
        return DirtyRegion(rect.x, rect.y, image)


class Story:
    """The mode of the planner and the reason for its decision, in large letters."""

    def __init__(self, trajectory: Trajectory, rect: Rect = STORY, unit: float = 1.0) -> None:
        self._trajectory, self._rect, self._unit = trajectory, rect, unit
        self._mode = trajectory.decisions.mode
        self._routine = routine_name(trajectory)
        self._card = paint.card(rect, unit=unit)
        self._decision: tuple[int, bool] | None = None
        self._shown: tuple[str, str] | None = None

    def draw(self, decision: int, *, over: bool = False) -> DirtyRegion | None:
        """Return the strip if it says something else than last."""
        if (decision, over) == self._decision:
            return None
        self._decision = (decision, over)
        sentence = self.sentence(decision, over=over)
        mode = "" if decision == NO_DECISION else MODES[int(self._mode[decision])]
        if (mode, sentence) == self._shown:
            return None
        self._shown = (mode, sentence)
        image, unit, rect = self._card.copy(), self._unit, self._rect
        pen = ImageDraw.Draw(image)
        if mode:
            colour = _MODE_COLOURS[mode]
            ink = style.TEXT if colour == style.LINE else style.PAGE
            wide, high = round(_PILL[0] * unit), round(_PILL[1] * unit)
            pill = paint.mask((0, 0, wide, high), paint.rounded((wide, high), 19 * unit))
            image.paste(colour, (round(12 * unit), round(10 * unit)), pill)
            middle = ((12 + _BADGE) / 2 * unit, rect.height / 2 + 7 * unit)
            sizes = style.scaled(_BADGES, unit)
            text, size = style.fitting(self._named(mode).upper(), wide - 20 * unit, sizes, True)
            pen.text(middle, text, ink, style.font(size, True), anchor="ms")
        room = rect.width - (_BADGE + 34) * unit
        sizes = style.scaled((30, 27, 24, 21, 19), unit)
        text, size = style.fitting(sentence, room, sizes, bold=True)
        y = rect.height // 2 + round(size * 0.36)
        paint.write(image, ((_BADGE + 18) * unit, y), text, style.TEXT, size, bold=True)
        return DirtyRegion(rect.x, rect.y, image)

    def _named(self, mode: str) -> str:
        return self._routine if mode == "routine" else mode

    def sentence(self, decision: int, *, over: bool = False) -> str:
        """Return what is said of a decision; at the end, how the run ended."""
        if not over:
            return reason(self._trajectory, decision)
        if self._trajectory.collision is not None:
            hit_by = speeds_in_words(self._trajectory) and not at_fault(self._trajectory)
            return f"{'Was hit by' if hit_by else 'Ran into'} {struck(self._trajectory)}"
        return _ENDINGS[self._trajectory.outcome]


def outcome_lines(trajectory: Trajectory) -> tuple[str, str]:
    """Return how the run ended, as a title and the figures to it."""
    ticks = trajectory.ticks
    title, _ = _OUTCOMES[trajectory.outcome]
    hit = trajectory.collision
    if hit is not None:
        title = f"{title} with {struck(trajectory)}"
    moves = ticks.position[1:] - ticks.position[:-1]
    length = float(np.hypot(moves[:, 0], moves[:, 1]).sum())
    facts = [f"{'at' if hit else 'in'} {float(ticks.time[-1]):.1f} s"]
    if speeds := speeds_in_words(trajectory):
        facts.append(speeds)  # a long line; the path is the less important
    else:
        facts.append(f"path {length:.1f} m")
    closest = float(ticks.clearance.min())
    if closest < float("inf") and hit is None:
        facts.append(f"least clearance {max(closest, 0.0):.2f} m")
    return title, "   ".join(facts)


def outcome_card(
    trajectory: Trajectory, rect: Rect = SCENE, unit: float = 1.0, *, low: bool
) -> DirtyRegion:
    """Return the card that closes the video.

    Args:
        trajectory: The run.
        rect: Where the scene lies, over which it is laid.
        unit: Pixels a point.
        low: Whether it lies in the lower part of it, else in the upper.
    """
    title, figures = outcome_lines(trajectory)
    _, colour = _OUTCOMES[trajectory.outcome]
    unit = min(unit, (rect.width - 40 * unit) / _CARD[0])
    wide, high, edge = (round(part * unit / 2) * 2 for part in (*_CARD, _FROM_EDGE))
    left = rect.x + (rect.width - wide) // 4 * 2
    place = Rect(left, rect.bottom - edge - high if low else rect.y + edge, wide, high)
    image = paint.card(place, unit=unit)
    pen = ImageDraw.Draw(image)
    pen.rectangle((0, 0, wide, 7 * unit), colour)
    pen.rectangle((0, 0, wide - 1, high - 1), outline=colour, width=max(round(2 * unit), 1))
    room = wide - 40 * unit
    sizes = style.scaled((40, 36, 32, 28, 26, 24, 22), unit)
    title, size = style.fitting(title, room, sizes, bold=True)
    paint.write(image, (wide / 2, 64 * unit), title, colour, size, bold=True, align="m")
    figures, size = style.fitting(figures, room, style.scaled((26, 24, 22, 20, 18), unit))
    paint.write(image, (wide / 2, 108 * unit), figures, style.TEXT, size, align="m")
    return DirtyRegion(place.x, place.y, image)
