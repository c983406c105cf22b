"""One frame from all its parts: which of them changed at a moment, and how they look now."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from fuzzyq_bullet.fuzzy.paper import RULES
from fuzzyq_bullet.video.action import Action
from fuzzyq_bullet.video.map import Map
from fuzzyq_bullet.video.meaning import Meaning
from fuzzyq_bullet.video.rules import Rules
from fuzzyq_bullet.video.scene import Scene
from fuzzyq_bullet.video.senses import Senses
from fuzzyq_bullet.video.sensing import Sensed, sensed_at
from fuzzyq_bullet.video.shown import Shown
from fuzzyq_bullet.video.style import SCENE
from fuzzyq_bullet.video.words import Clock, Story, caption, outcome_card

if TYPE_CHECKING:
    from collections.abc import Iterator

    from fuzzyq_bullet.trajectory import Trajectory
    from fuzzyq_bullet.video.film import Patch
    from fuzzyq_bullet.video.timeline import Moment


class Stage:
    """All views of one run. Use as a context: the scene holds a renderer.

    Scene and map are live. The four panels and the sentence show one decision, the same one.

    Args:
        trajectory: The run.
        speed: Seconds of the run in one second of video.
    """

    def __init__(self, trajectory: Trajectory, speed: float = 1.0) -> None:
        self._trajectory = trajectory
        decisions = trajectory.decisions
        settings = trajectory.scenario.planner
        base = RULES.get(getattr(settings, "rules", "corrected"), RULES["corrected"])
        turn_unit = float(getattr(settings, "turn_unit", math.radians(45.0)))
        self._map = Map(trajectory)
        self._senses = Senses(trajectory)
        self._meaning = Meaning(decisions, base.row, base.column)
        self._rules = Rules(decisions, base, turn_unit)
        self._action = Action(trajectory)
        self._clock = Clock(speed)
        self._story = Story(trajectory)
        self._shown = Shown(trajectory, speed)
        self._fresh = True
        self._decision: int | None = None
        self._sensed: Sensed | None = None
        self._over = False
        self._scene = Scene(trajectory)

    def __enter__(self) -> Stage:
        return self

    def __exit__(self, *_: object) -> None:
        self._scene.close()

    def patches(self, moment: Moment) -> Iterator[Patch]:
        """Yield what changed since the last moment; all of the frame, the first time."""
        if self._over and moment.over:
            return
        if self._fresh:
            self._fresh = False
            yield caption(self._trajectory)
        if moment.decision != self._decision:
            self._decision = moment.decision
            self._sensed = sensed_at(self._trajectory, moment.decision)
        sensed, shown = self._sensed, self._shown.at(moment)
        hit = (
            self._trajectory.collision.point if moment.over and self._trajectory.collision else None
        )
        for patch in (
            self._scene.draw(moment, sensed, hit),
            self._map.draw(moment, sensed, hit),
            *self._senses.draw(shown),
            *self._meaning.draw(shown),
            self._rules.draw(shown),
            *self._action.draw(moment, shown),
            self._clock.draw(moment),
            self._story.draw(shown, over=moment.over),
        ):
            if patch is not None:
                yield patch
        if moment.over:
            self._over = True
            # Where the run ended must stay in sight.
            low = self._scene.height_of(moment.position) < SCENE.height / 2
            yield outcome_card(self._trajectory, low=low)


def closing(moment: Moment) -> Moment:
    """Return the last moment as one at which the run has ended."""
    return replace(moment, over=True)
