"""A robot that learns its own field: Q(λ) over temporary goals, run by run.

The paper learns in the environment that it then drives ("through repeated test runs"). In every run
the planner drives as it always does, and where it chooses a temporary goal it takes the one with
the greatest Q(s, g) (``planning.learned_exits``). After the run the table is learned from what was
chosen, backwards, with −Δt as the reward, γ = 1 and the λ-return, which is what Eqs. 18 and 19 come
to at the end of an episode:

    G_k = Δt_k + (1 − λ)·T_{k+1} + λ·G_{k+1}        T ← T + η·(G_k − T_k)

where T_k = −Q is the time to the goal as it seemed at the k-th choice. Nobody tells it the truth,
and nothing explores by chance: what was never tried looks good.

The safety filter holds in every run. What is kept in the end is the table that the fastest run
began with: the same table drives the same run again, so no robot that has learned is slower than it
was at first.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from fuzzyq_bullet.episode import run_in, world_of
from fuzzyq_bullet.fuzzy import ControllerDefinition
from fuzzyq_bullet.learning import Policy, Setup, hash_of
from fuzzyq_bullet.learning.checkpoint import ROW, SUCCESS, Checkpoint, Curve
from fuzzyq_bullet.learning.learners import Floats
from fuzzyq_bullet.learning.schedules import Schedule
from fuzzyq_bullet.physics.engine import Engine
from fuzzyq_bullet.physics.sensor_world import SensorWorld
from fuzzyq_bullet.planning.escape.learned_exits import (
    LEARNER,
    SECONDS,
    Choice,
    LearnedExits,
    Place,
    names_of,
    rows_of,
)
from fuzzyq_bullet.planning.fuzzy_q_lambda import FuzzyQLambdaPlanner, rule_policy
from fuzzyq_bullet.planning.settings import FuzzyQLambdaSettings
from fuzzyq_bullet.recording.trajectory import Trajectory
from fuzzyq_bullet.scenario.fields import field_digest
from fuzzyq_bullet.scenario.models import Scenario
from fuzzyq_bullet.version import __version__

RUNS = 50
"""Runs of a training, unless more or fewer are asked for."""
RATE = Schedule(0.3)
"""η: one run's bad luck behind an exit does not condemn it."""
TRACE = Schedule(0.7)
"""λ: a choice is made every 0.3 m of a way out, so it shares in what shows a metre later."""


def field_setup(runs: int, seed: int) -> Setup:
    """Return how a field is learned."""
    return Setup(episodes=runs, seed=seed, rate=RATE, trace_decay=TRACE)


@dataclass(frozen=True)
class FieldTask:
    """The field to learn.

    Attributes:
        scenario: It, with every obstacle in its place.
    """

    scenario: Scenario

    @property
    def settings(self) -> FuzzyQLambdaSettings:
        """The planner that learns, with the rules that the scenario gives its own."""
        given = getattr(self.scenario.planner, "rules", None)
        if isinstance(given, ControllerDefinition):
            return FuzzyQLambdaSettings(rules=given)
        return FuzzyQLambdaSettings()

    def digest(self) -> str:
        """Return a hash of the field."""
        return field_digest(self.scenario)

    def run_digest(self) -> str:
        """Return a hash of all that a run depends on: the field, and where and how it is driven."""
        left_out = {"name", "description", "planner", "expect"}
        return hashlib.sha256(self.scenario.model_dump_json(exclude=left_out).encode()).hexdigest()[
            :32
        ]


@dataclass
class FieldMemory:
    """What a robot has learned of a field.

    Attributes:
        seconds: T, the time to the goal (s) from each place that was tried.
        fastest: Time of the fastest run (s).
        kept: The table that the fastest run began with.
    """

    seconds: dict[Place, float] = field(default_factory=dict)
    fastest: float = math.inf
    kept: dict[Place, float] = field(default_factory=dict)

    def drive(self, task: FieldTask, world: SensorWorld) -> tuple[Trajectory, list[Choice]]:
        """Return one run with the table as it is, and what was chosen in it."""
        planner = FuzzyQLambdaPlanner(task.settings)
        exits = LearnedExits(self.seconds)
        planner.choose_exits_by(exits.judge)
        return run_in(world, task.scenario, planner), exits.choices

    def learn(
        self,
        choices: Sequence[Choice],
        end: float,
        *,
        ahead: float = 0.0,
        rate: float,
        trace: float,
    ) -> None:
        """Learn from a run. Of several choices of one place the last counts: it was known best.

        Args:
            choices: What was chosen, in turn.
            end: When the run ended (s).
            ahead: What still lay ahead then (s): nothing in the goal.
            rate: η.
            trace: λ.
        """
        learned: dict[Place, float] = {}
        time, seems, comes = end, ahead, ahead
        for choice in reversed(choices):
            comes = time - choice.time + (1.0 - trace) * seems + trace * comes
            time, seems = choice.time, choice.seconds
            change = rate * (comes - choice.seconds)
            learned.setdefault(choice.place, max(0.0, choice.beyond + change))
        self.seconds = {**self.seconds, **learned}

    def after(
        self, trajectory: Trajectory, choices: Sequence[Choice], setup: Setup, run: int
    ) -> None:
        """Learn from a run, counted from 1, and keep the table it began with if it was the fastest.

        Where one ended that did not get there, the goal counts as far as the run's limit of time.
        """
        began, time = self.seconds, float(trajectory.ticks.time[-1])
        there = trajectory.outcome == SUCCESS.decode()
        rate, trace = (one.at(run, setup.episodes) for one in (setup.rate, setup.trace_decay))
        ahead = 0.0 if there else trajectory.scenario.limits.time
        self.learn(choices, time, ahead=ahead, rate=rate, trace=trace)
        if there and time < self.fastest:
            self.fastest, self.kept = time, began

    def as_table(self) -> Floats:
        """Return all of it, shape (K, 4): column, row, T, and T of the fastest run; −1 for none."""
        places = sorted({*self.seconds, *self.kept})
        rows = [(*one, self.seconds.get(one, -1.0), self.kept.get(one, -1.0)) for one in places]
        return np.array(rows, dtype=np.float64).reshape(-1, 4)

    @classmethod
    def of_table(cls, table: Floats, curve: Curve) -> FieldMemory:
        """Return what ``as_table`` told, after these runs."""
        told = [((int(x), int(y)), now, best) for x, y, now, best in table.tolist()]
        reached = -curve["total"][curve["outcome"] == SUCCESS]
        return cls(
            {place: now for place, now, _ in told if now >= 0.0},
            float(reached.min(initial=math.inf)),
            {place: best for place, _, best in told if best >= 0.0},
        )


def learn_field(
    task: FieldTask,
    setup: Setup,
    *,
    command: str,
    checkpoint: Path | None = None,
    resume: bool = False,
    on_episode: Callable[[Curve], None] | None = None,
) -> tuple[Policy, Curve]:
    """Learn what the ways out of a field are worth.

    Args:
        task: The field.
        setup: For how many runs, η and λ.
        command: What to type to do this again; the policy keeps it.
        checkpoint: Where to keep how far it is after every run.
        resume: Whether to go on from there.
        on_episode: Called after every run with the learning curve so far.

    Returns:
        The policy and the learning curve, in which an episode earns minus its time (s), or minus
        its limit of time if it did not get to the goal.

    Raises:
        UserError: If the checkpoint cannot be written, or read, or is that of another training.
    """
    scenario = task.scenario
    plan = {"version": __version__, **setup.describe(), "learner": LEARNER}
    plan |= {"drive": scenario.drive, **_depends_on(task)}
    memory, curve, done = FieldMemory(), np.zeros(setup.episodes, ROW), 0
    saved = Checkpoint.find(checkpoint) if resume and checkpoint is not None else None
    if saved is not None and checkpoint is not None:
        saved.check(checkpoint, plan, (len(saved.table), 4))
        done = len(saved.curve)
        curve[:done] = saved.curve
        memory = FieldMemory.of_table(saved.table, saved.curve)
    elif checkpoint is not None:  # now rather than after a run, should that not be possible
        Checkpoint(plan, memory.as_table(), curve[:0]).save(checkpoint)
    with Engine() as engine:
        for run in range(done + 1, setup.episodes + 1):
            trajectory, choices = memory.drive(task, world_of(scenario, engine))
            memory.after(trajectory, choices, setup, run)
            outcome = trajectory.outcome.encode()
            time = float(trajectory.ticks.time[-1])
            earned = -time if outcome == SUCCESS else -scenario.limits.time
            curve[run - 1] = earned, len(choices), outcome
            if checkpoint is not None:
                Checkpoint(plan, memory.as_table(), curve[:run]).save(checkpoint)
            if on_episode is not None:
                on_episode(curve[:run])
    return _policy(task, setup, memory, curve, command), curve


def _policy(
    task: FieldTask, setup: Setup, memory: FieldMemory, curve: Curve, command: str
) -> Policy:
    reached = np.flatnonzero(curve["outcome"] == SUCCESS)
    fastest = reached[curve["total"][reached].argmax()] if reached.size else None
    first = -float(curve["total"][0]) if curve["outcome"][0] == SUCCESS else None
    described: dict[str, str | bool | int | float | None] = {
        "rate": setup.rate.start,
        "rate_drop": setup.rate.drop,
        "trace": setup.trace_decay.start,
        "trace_drop": setup.trace_decay.drop,
        **_depends_on(task),
        "first_s": first,
        "fastest_s": None if fastest is None else -float(curve["total"][fastest]),
        "fastest_run": None if fastest is None else int(fastest) + 1,
    }
    return Policy(
        planner="fuzzy-q-lambda",
        learner=LEARNER,
        command=command,
        seed=setup.seed,
        version=__version__,
        drive=task.scenario.drive,
        scenario=task.digest(),
        episodes=setup.episodes,
        parameters=described,
        states=names_of(memory.kept),
        actions=(SECONDS,),
        table=rows_of(memory.kept),
    )


def _depends_on(task: FieldTask) -> dict[str, str]:
    """Return what the runs of a training depend on beside its schedules.

    That is the field, where and how it is driven, and the weights of the rules.
    """
    settings = task.settings
    told = {"run": task.run_digest(), "rules": hash_of(rule_policy(settings))}
    own = settings.rules
    return told if isinstance(own, str) else {**told, "controller": own.digest()}
