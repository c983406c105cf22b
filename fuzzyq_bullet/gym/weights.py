"""``fuzzyq_bullet/Weights-v0``: a policy sets ω1 and ω2 of the fuzzy planner, every 0.3 s."""

from __future__ import annotations

from fuzzyq_bullet.episode import Episode
from fuzzyq_bullet.gym.env import HOLD, EpisodeEnv, goal_seen, motion_seen
from fuzzyq_bullet.gym.tasks import DEFAULT_COUNT, Count, Source, TaskSource
from fuzzyq_bullet.planning import MODES, Decision
from fuzzyq_bullet.planning.base import LONGEST_STRIDE
from fuzzyq_bullet.planning.improved_fuzzy import ImprovedFuzzyBase
from fuzzyq_bullet.planning.settings import ImprovedFuzzySettings
from fuzzyq_bullet.scenario import Scenario, with_options

_LEAST = {
    "left": 0.0,
    "middle": 0.0,
    "right": 0.0,
    "distance": 0.0,
    "difference": -1.0,
    "turn": -1.0,
    "stride": 0.0,
    "goal_ahead": -1.0,
    "goal_left": -1.0,
    "goal_distance": 0.0,
    "speed": -1.0,
    "turn_rate": -1.0,
    "routine": 0.0,
    "breakout": 0.0,
    "following": 0.0,
}
_PLANNER = "improved-fuzzy"


class WeightsEnv(EpisodeEnv):
    """The paper's learning problem: the fuzzy planner drives, its two weights are learned.

    Action, shape (2,), each from −1 to 1:
        0. ω1 − 1, the weight of the step (Eq. 17): −1 stands, 1 doubles the step.
        1. ω2 − 1, the weight of the turn: −1 goes straight for the aim, 1 doubles the turn.

    Both weights are 1 where the action is 0. The escape from dead ends and the safety filter work
    as in ``improved-fuzzy``: the weights act towards temporary goals too.

    Observation, float32, shape (15,):
        0. to 2. ``left``, ``middle``, ``right``: free lengths of the detection lines, 0 to 1, the
           range of 1 m.
        3. ``distance``: d, the controller's first input, 0 to 1, the range.
        4. ``difference``: Df, its second input (Eq. 14), −1 to 1, over the range.
        5. ``turn``: N_a that it proposes, over 2, −1 to 1, positive to the left.
        6. ``stride``: N_s that it proposes, over 2, 0 to 1.
        7. ``goal_ahead``: cosine of the angle from where the robot faces to the goal, −1 to 1.
        8. ``goal_left``: sine of that angle, −1 to 1, positive to the left.
        9. ``goal_distance``: d / (d + 5 m), 0 to 1, d the distance to the goal's centre.
        10. ``speed``: forward, over the greatest speed, −1 to 1; 0 in the kinematic drive.
        11. ``turn_rate``: over the greatest, −1 to 1; 0 in the kinematic drive.
        12. to 14. ``routine``, ``breakout``, ``following``: 1 for the mode of the latest decision,
            0 for the others; at the start ``routine``.

    Args:
        scenario: A scenario, its file, or the name of a bundled one: every episode is about it, and
            what it asks to be ``random`` is drawn anew. What it sets for its planner stays, as far
            as ``improved-fuzzy`` has it. By default every episode is a random task that has a way.
        count: Obstacles of a random task, 0 to 150, or the least and the most as a pair.
        drive: ``wheels`` or ``kinematic``, whatever the scenario says. An action lasts 0.3 s on
            wheels, which are six decisions, and one step of the point robot otherwise.
        render_mode: ``rgb_array``, or None for no pictures.

    Raises:
        UserError: If one of them is not allowed.
    """

    def __init__(
        self,
        *,
        scenario: Source = None,
        count: Count = DEFAULT_COUNT,
        drive: str = "wheels",
        render_mode: str | None = None,
    ) -> None:
        tasks = TaskSource(scenario=scenario, count=count, drive=drive)
        super().__init__(tasks, _LEAST, render_mode=render_mode)

    def _begin(self, scenario: Scenario) -> None:
        self._robot = scenario.robot
        settings = with_options(scenario, planner=_PLANNER).planner
        assert isinstance(settings, ImprovedFuzzySettings)
        self._planner = ImprovedFuzzyBase(settings)

    def _see(self, episode: Episode) -> dict[str, float]:
        now = self._now = episode.observe()
        seen = self._situation = self._planner.sense(now)
        left, middle, right = (length / now.range for length in seen.lengths)
        most = now.range / now.unit
        return {
            "left": left,
            "middle": middle,
            "right": right,
            "distance": seen.distance / most,
            "difference": seen.difference / most,
            "turn": seen.inferred.turn / 2.0,
            "stride": seen.inferred.stride / LONGEST_STRIDE,
            **goal_seen(now),
            **motion_seen(now, self._robot),
            **{mode: float(mode == self._planner.mode) for mode in MODES},
        }

    def _act(self, episode: Episode, first: float, second: float) -> None:
        weights = (1.0 + first, 1.0 + second)
        decisions = 1 if self._now.motion is None else round(HOLD * self.rate)
        for left in reversed(range(decisions)):
            episode.advance(self._planner.act(self._now, self._situation, weights))
            if episode.outcome is not None or not left:
                return
            self._see(episode)

    def _shown(self) -> Decision:
        return Decision(
            heading=self._now.heading,
            step=0.0,
            mode=self._planner.mode,
            lines=self._situation.lines,
            lengths=self._situation.lengths,
        )
