"""The words of the frame: caption and clock, mode and reason, and at last the outcome."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageDraw

from fuzzyq_bullet.planning.decision import MODES
from fuzzyq_bullet.rules_turn import has_rules
from fuzzyq_bullet.video import paint, style
from fuzzyq_bullet.video.explanation import reason, struck
from fuzzyq_bullet.video.paint import DirtyRegion
from fuzzyq_bullet.video.style import HEADER, SCENE, STORY, Rect
from fuzzyq_bullet.video.timeline import NO_DECISION, Moment

if TYPE_CHECKING:
    from fuzzyq_bullet.trajectory import Trajectory

_CLOCK = Rect(HEADER.right - 240, HEADER.y, 240, HEADER.height)
_BADGE = 176
_PILL = (164, 38)
_BADGES = (19, 17, 15, 13)
_CARD = Rect(SCENE.x + 40, SCENE.y + 20, 800, 132)
_LOWER = SCENE.bottom - 20 - _CARD.height
_MODE_COLOURS = {"routine": style.LINE, "breakout": style.TARGET, "following": style.TARGET}

_OUTCOMES = {
    "goal": ("GOAL reached", style.GOAL),
    "collision": ("COLLISION", style.DANGER),
    "timeout": ("TIME IS UP", style.HEAT),
    "stuck": ("STUCK: no way on", style.HEAT),
}
_ENDINGS = {
    "goal": "In the goal",
    "collision": "Ran into something",
    "timeout": "Time is up before the goal",
    "stuck": "Finds no way on: stops",
}


def planner_name(trajectory: Trajectory) -> str:
    """Return the name of the planner that ran."""
    return str(getattr(trajectory.scenario.planner, "name", None) or "unknown planner")


def caption(trajectory: Trajectory) -> DirtyRegion:
    """Return the line that says which scenario, planner and seed this is."""
    scenario = trajectory.scenario
    image = Image.new("RGB", HEADER.size, style.PAGE)
    details = f"planner {planner_name(trajectory)}   seed {scenario.seed}"
    if scenario.drive == "kinematic":
        details += "   kinematic drive"
    room = HEADER.width - _CLOCK.width - 24
    details, small = style.fitting(details, room * 0.7, (20, 18, 16))
    beside = room - style.text_width(details, small)
    name, size = style.fitting(scenario.name, beside, (24, 22, 20), bold=True)
    paint.write(image, (4, 28), name, style.TEXT, size, bold=True)
    x = 4 + style.text_width(name, size, True) + 24
    paint.write(image, (x, 28), details, style.MUTED, small)
    return DirtyRegion(HEADER.x, HEADER.y, image)


class Clock:
    """The time of the run, and how fast it is shown."""

    def __init__(self, speed: float) -> None:
        self._speed = "" if speed == 1.0 else f"{speed:g}× speed"
        self._shown = ""

    def draw(self, moment: Moment) -> DirtyRegion | None:
        """Return the clock if it shows another time than last."""
        text = f"{moment.time:.1f} s"
        if text == self._shown:
            return None
        self._shown = text
        image = Image.new("RGB", _CLOCK.size, style.PAGE)
        pen = ImageDraw.Draw(image)
        paint.write(image, (_CLOCK.width - 4, 28), text, style.TEXT, 24, bold=True, align="r")
        pen.text((0, 28), self._speed, style.MUTED, style.font(18), anchor="ls")
        return DirtyRegion(_CLOCK.x, _CLOCK.y, image)


class Story:
    """The mode of the planner and the reason for its decision, in large letters."""

    def __init__(self, trajectory: Trajectory) -> None:
        self._trajectory = trajectory
        self._mode = trajectory.decisions.mode
        # The modes are the paper's. A planner without them is called by its name.
        plain = not (self._mode.any() or has_rules(trajectory.decisions))
        self._badge = planner_name(trajectory).upper() if plain else ""
        self._card = paint.card(STORY)
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
        image = self._card.copy()
        pen = ImageDraw.Draw(image)
        if mode:
            colour = _MODE_COLOURS[mode]
            ink = style.TEXT if colour == style.LINE else style.PAGE
            pill = paint.mask((0, 0, *_PILL), paint.rounded(_PILL, 19))
            image.paste(colour, (12, 10), pill)
            middle = ((12 + _BADGE) / 2, STORY.height / 2 + 7)
            text, size = style.fitting(self._badge or mode.upper(), _PILL[0] - 20, _BADGES, True)
            pen.text(middle, text, ink, style.font(size, True), anchor="ms")
        room = STORY.width - _BADGE - 34
        text, size = style.fitting(sentence, room, (30, 27, 24, 21, 19), bold=True)
        y = STORY.height // 2 + round(size * 0.36)
        paint.write(image, (_BADGE + 18, y), text, style.TEXT, size, bold=True)
        return DirtyRegion(STORY.x, STORY.y, image)

    def sentence(self, decision: int, *, over: bool = False) -> str:
        """Return what is said of a decision; at the end, how the run ended."""
        if not over:
            return reason(self._trajectory, decision)
        if self._trajectory.collision is not None:
            return f"Ran into {struck(self._trajectory)}"
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
    facts = [f"{'at' if hit else 'in'} {float(ticks.time[-1]):.1f} s", f"path {length:.1f} m"]
    closest = float(ticks.clearance.min())
    if closest < float("inf") and hit is None:
        facts.append(f"least clearance {max(closest, 0.0):.2f} m")
    return title, "   ".join(facts)


def outcome_card(trajectory: Trajectory, *, low: bool) -> DirtyRegion:
    """Return the card that closes the video, to be laid over the scene, high or low in it."""
    title, figures = outcome_lines(trajectory)
    _, colour = _OUTCOMES[trajectory.outcome]
    image = paint.card(_CARD)
    pen = ImageDraw.Draw(image)
    pen.rectangle((0, 0, _CARD.width, 7), colour)
    pen.rectangle((0, 0, _CARD.width - 1, _CARD.height - 1), outline=colour, width=2)
    room = _CARD.width - 40
    title, size = style.fitting(title, room, (40, 36, 32, 28, 26, 24, 22), bold=True)
    paint.write(image, (_CARD.width / 2, 64), title, colour, size, bold=True, align="m")
    figures, size = style.fitting(figures, room, (26, 24, 22, 20))
    paint.write(image, (_CARD.width / 2, 108), figures, style.TEXT, size, align="m")
    return DirtyRegion(_CARD.x, _LOWER if low else _CARD.y, image)
