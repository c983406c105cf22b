"""Panel 3: the rule table, each rule an arrow of its turn and step, lit as strongly as it fires.

Turn and step are weighed, where the weights of the rule are known: the robot's own, or those that
this rule has learned. Where the robot aims at a gap exactly, or gives way, the rules are not asked,
and the table is grey. In the goal no rule is lit.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageDraw

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.planning.controllers import controller_shown
from fuzzyq_bullet.planning.decision import MODES
from fuzzyq_bullet.planning.fuzzy_q_lambda import rule_policy, weights_of
from fuzzyq_bullet.planning.settings import FuzzyQLambdaSettings, WeightsSettings
from fuzzyq_bullet.video import paint, style
from fuzzyq_bullet.video.explanation import is_asked
from fuzzyq_bullet.video.panels.base import Canvas
from fuzzyq_bullet.video.timeline import NO_DECISION, Moment

if TYPE_CHECKING:
    from fuzzyq_bullet.fuzzy.sets import Variable
    from fuzzyq_bullet.recording.trajectory import Trajectory
    from fuzzyq_bullet.video.map.footprints import Floats

_LEFT, _TOP = 86, 48
_WORDS = _LEFT - 12
"""Most width of a row's name."""
_TABLE = (180, 160)
"""Width and height of the table: its cells are as large as their number allows."""
_ROOMY = 22
"""Cells smaller than this (pixels) have no arrow: only how strongly they fire is to be seen."""
_GAP = 2
_LEVELS = 32
"""Steps of brightness; finer ones cannot be told apart."""
_UNLIT: style.Colour = (38, 45, 56)
_GREY: style.Colour = (84, 92, 104)
"""A rule that fires fully, and is not asked."""
_FIRE, _AIMS, _NOT_ASKED = "3  RULES THAT FIRE", "3  AIMS AT A GAP", "3  RULES NOT ASKED"


class Rules:
    """Panel 3 of one run.

    Columns run from "left much freer" to "right much freer", so that rules which turn left stand
    on the left.
    """

    def __init__(self, trajectory: Trajectory, canvas: Canvas) -> None:
        self._canvas, self._image = canvas, canvas.image
        self._decisions, self._outcome = trajectory.decisions, trajectory.outcome
        base = controller_shown(trajectory.scenario.planner).base
        turn_unit = float(getattr(trajectory.scenario.planner, "turn_unit", math.radians(45.0)))
        self._rows, self._columns = len(base.row.sets), len(base.column.sets)
        self._places = {column: place for place, column in enumerate(base.column.falling)}
        self._cell = _TABLE[0] // max(self._columns, 2), _TABLE[1] // max(self._rows, 3)
        weights = rule_weights(trajectory).reshape(self._rows, self._columns, 2)
        self._arrows = [
            [
                _arrow(
                    base.cells[row][column],
                    base.outputs,
                    weights[row, column],
                    turn_unit,
                    self._cell,
                )
                for column in range(self._columns)
            ]
            for row in range(self._rows)
        ]
        right = _LEFT + self._columns * self._cell[0] - _GAP
        if self._columns > 1:
            paint.write(self._image, (_LEFT, 43), "left freer", style.MUTED, 15)
            paint.write(self._image, (right, 43), "right freer", style.MUTED, 15, align="r")
        # Where rows are too low for a word each, every second or third has one.
        every = math.ceil(16 / self._cell[1])
        named = list(enumerate(base.row.sets))[::every]
        size = min(style.fitting(one.meaning, _WORDS, (15, 13))[1] for _, one in named)
        for row, one in named:
            y = _TOP + row * self._cell[1] + self._cell[1] // 2 + 4
            words, _ = style.fitting(one.meaning, _WORDS, (size,))
            paint.write(self._image, (_LEFT - 8, y), words, style.MUTED, size, align="r")
        self._shown: dict[tuple[int, int], tuple[int, bool, bool]] = {}
        self._title = ""
        self._drawn: tuple[int, bool] | None = None

    def draw(self, moment: Moment) -> None:
        """Light the rules as strongly as they fired for the decision shown."""
        decision, arrived = moment.shown, moment.over and self._outcome == "goal"
        if (decision, arrived) == self._drawn:
            return
        self._drawn = decision, arrived
        strengths = np.zeros((self._rows, self._columns))
        asked = not arrived
        at_gap = False
        if decision != NO_DECISION and not arrived:
            asked = is_asked(self._decisions, decision)
            at_gap = self._decisions.mode[decision] != MODES.index("routine")
            strengths = np.clip(np.nan_to_num(self._decisions.rules[decision]), 0.0, 1.0)
        strongest = float(strengths.max())
        changed = []
        title = _FIRE if asked else _AIMS if at_gap else _NOT_ASKED
        if title != self._title:
            self._title = title
            self._canvas.rename(title)
        for row, cells in enumerate(strengths.tolist()):
            for column, strength in enumerate(cells):
                # The root lifts weak rules into sight; the order of brightness stays.
                strong = strength == strongest > 0.0 and asked
                look = (round(math.sqrt(strength) * _LEVELS), strong, asked)
                if self._shown.get((row, column)) != look:
                    self._shown[row, column] = look
                    changed.append(self._draw_cell(row, column, *look))
        box = paint.joined(changed)
        if box is not None:
            self._canvas.changed(box)

    def _draw_cell(
        self, row: int, column: int, level: int, strongest: bool, asked: bool
    ) -> paint.Box:
        width, height = self._cell
        x = _LEFT + self._places[column] * width
        y = _TOP + row * height
        lit = level / _LEVELS
        box = (x, y, x + width - _GAP - 1, y + height - _GAP - 1)
        outline = style.TEXT if strongest else None
        fill = style.mixed(_UNLIT, style.HEAT if asked else _GREY, lit)
        ImageDraw.Draw(self._image).rectangle(box, fill, outline, 2)
        ink = style.PAGE if lit > 0.45 else style.mixed(style.FAINT, style.TEXT, lit)
        if not asked:
            ink = style.FAINT
        if min(self._cell) >= _ROOMY:
            self._image.paste(ink, (x, y), self._arrows[row][column])
        return box[0], box[1], box[2] + 1, box[3] + 1


def rule_weights(trajectory: Trajectory) -> Floats:
    """Return (ω1, ω2) of each rule, shape (R, 2), row by row; 1 where they are not known.

    A policy's are known if it is still the one that the run was driven with.
    """
    planner, decisions = trajectory.scenario.planner, trajectory.decisions
    count = math.prod(decisions.rules.shape[1:])
    unknown = np.ones((count, 2))
    if isinstance(planner, WeightsSettings):
        return np.tile(planner.weights, (count, 1))
    if not isinstance(planner, FuzzyQLambdaSettings):
        return unknown
    try:
        weights = weights_of(rule_policy(planner))
    except UserError:
        return unknown
    fired = decisions.rules.reshape(-1, count)
    total = fired.sum(axis=1, keepdims=True)
    used = (fired / np.where(total > 0.0, total, 1.0)) @ weights
    return weights if np.allclose(used, decisions.weights) else unknown


def _arrow(
    cell: tuple[str, ...],
    outputs: tuple[Variable, ...],
    weights: Floats,
    turn_unit: float,
    room: tuple[int, int],
) -> Image.Image:
    """Return an arrow that points where the rule turns and is as long as it steps, weighed."""
    turn_label, step_label = cell
    turn, step = outputs
    angle = turn.set_of(turn_label).center * turn_unit * weights[1]
    part = step.set_of(step_label).center / step.domain[1] * weights[0]
    size = (room[0] - _GAP, room[1] - _GAP)
    shortest, longest = max(10.0, min(size) / 3.0), 0.8 * min(size)
    length = shortest + (longest - shortest) * min(max(part, 0.0), 1.0)
    # A head as long as its arrow would hide where it points.
    point = min(8.0, 0.6 * length)
    way = np.array((-math.sin(angle), -math.cos(angle)))
    aside = np.array((way[1], -way[0]))
    middle = np.array(size) / 2
    tip, tail = middle + way * length / 2, middle - way * length / 2
    foot = tip - way * point
    head = np.stack([tip, foot + aside * 0.6 * point, foot - aside * 0.6 * point])

    def draw(pen: ImageDraw.ImageDraw, at: paint.Scaled) -> None:
        pen.line(at(np.stack([tail, tip - way * 0.75 * point])), 255, 3 * at.factor)
        pen.polygon(at(head), fill=255)

    return paint.mask((0, 0, *size), draw)
