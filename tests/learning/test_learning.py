"""The learners: tables and rules, against known solutions and against each other."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from examples.exercises import CliffWalk, Corridor, RandomWalk
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.learning import (
    EXPLORATION,
    LEARNING_RATE,
    TABLE_1,
    TRACE_DECAY,
    FuzzyQLambda,
    QLambda,
    QLearning,
    Schedule,
    Setup,
    epsilon_greedy,
    greedy,
    train,
)
from fuzzyq_bullet.learning.learners import FAINT, Floats, TraceKind

STATES, ACTIONS = 5, 3
KINDS = st.sampled_from(["accumulating", "replacing"])
UNIT = st.floats(0.0, 1.0)
# Any steps at all, of any behaviour: (s, a, r, s' or None at an episode's end).
STEPS = st.lists(
    st.tuples(
        st.integers(0, STATES - 1),
        st.integers(0, ACTIONS - 1),
        st.floats(-10.0, 10.0),
        st.none() | st.integers(0, STATES - 1),
    ),
    max_size=40,
)


def alone(state: int) -> Floats:
    """One rule that fires and no other."""
    return np.eye(STATES)[state]


# Table 1 and the schedules


def test_the_paper_s_parameters_are_the_default() -> None:
    assert (TABLE_1.initial_value, TABLE_1.initial_trace) == (0.0, 0.0)
    assert QLearning(1, 1).discount == 0.9  # ξ, Eq. 7
    assert QLambda(1, 1).discount == FuzzyQLambda(1, 1).discount == 0.95  # γ, Eqs. 18 and 19
    assert QLambda(1, 1).kind == FuzzyQLambda(1, 1).kind == "accumulating"
    assert not QLambda(2, 2).table.any()
    assert not FuzzyQLambda(2, 2).table.any()
    setup = Setup()
    assert (setup.episodes, setup.rate, setup.trace_decay) == (200, LEARNING_RATE, TRACE_DECAY)


@pytest.mark.parametrize("episode", [1, 2, 77, 200])
def test_rate_and_trace_decay_are_eqs_20_and_21(episode: int) -> None:
    assert LEARNING_RATE.at(episode, 200) == 0.1 - 0.09 * (episode / 200)
    assert TRACE_DECAY.at(episode, 200) == 0.01 - 0.009 * (episode / 200)


def test_exploration_falls_from_a_half_to_a_twentieth_and_a_constant_stays() -> None:
    assert EXPLORATION.at(0, 200) == 0.5
    assert EXPLORATION.at(200, 200) == pytest.approx(0.05)
    assert {Schedule(0.9).at(i, 50) for i in range(1, 51)} == {0.9}


@pytest.mark.parametrize(("start", "drop"), [(1.1, 0.0), (-0.1, 0.0), (0.5, 0.6), (np.nan, 0.0)])
def test_a_schedule_beyond_0_to_1_is_refused(start: float, drop: float) -> None:
    with pytest.raises(UserError, match="between 0 and 1"):
        Schedule(start, drop)


# Choosing


def test_the_best_action_is_chosen_and_the_first_among_equals() -> None:
    assert greedy([0.0, 2.0, 1.0]) == 1
    assert greedy([0.0, 2.0, 2.0, 2.0]) == 1
    rng = np.random.default_rng(0)
    drawn = [greedy([0.0, 2.0, 2.0, 1.0, 2.0], rng) for _ in range(3000)]
    # 1000 each; four standard deviations are 103.
    assert np.bincount(drawn, minlength=5) == pytest.approx([0, 1000, 1000, 0, 1000], abs=103)


@pytest.mark.parametrize("epsilon", [0.0, 0.3, 1.0])
def test_an_epsilon_of_all_choices_is_drawn_from_all_actions(epsilon: float) -> None:
    rng = np.random.default_rng(0)
    drawn = np.bincount([epsilon_greedy([0, 1, 0, 0], epsilon, rng) for _ in range(4000)])
    expected = 4000 * (epsilon / 4 + (1 - epsilon) * np.eye(4)[1])
    assert np.pad(drawn, (0, 4 - len(drawn))) == pytest.approx(expected, abs=4 * 1000**0.5)


def test_equals_are_drawn_from_only_when_asked_for() -> None:
    rng = np.random.default_rng(0)
    assert {epsilon_greedy([1, 1], 0.0, rng) for _ in range(50)} == {0}
    assert {epsilon_greedy([1, 1], 0.0, rng, random_ties=True) for _ in range(50)} == {0, 1}


# One step at a time


def test_one_step_of_q_learning_is_eq_7() -> None:
    learner = QLearning(2, 2)
    learner.table = np.array([[1.0, 2.0], [3.0, 5.0]])
    learner.begin(0.1, 0.0)
    delta = learner.learn(0, 0, -1.0, 1)
    assert delta == -1.0 + 0.9 * 5.0 - 1.0
    assert learner.table.tolist() == [[1.0 + 0.1 * delta, 2.0], [3.0, 5.0]]
    assert learner.learn(1, 0, -1.0, None) == -1.0 - 3.0  # nothing is earned after the end


def test_one_step_of_q_lambda_is_eq_18() -> None:
    learner = QLambda(3, 2)
    learner.begin(0.1, 0.5)
    learner.table = np.array([[2.0, 0.0], [3.0, 0.0], [4.0, 0.0]])
    first = learner.learn(0, 0, -1.0, 1)
    second = learner.learn(1, 0, -1.0, 2)
    assert second == pytest.approx(-1.0 + 0.95 * 4.0 - 3.0)
    assert learner.traces[:2, 0] == pytest.approx([0.95 * 0.5, 1.0])
    expected = [2.0 + 0.1 * (first + 0.475 * second), 3.0 + 0.1 * second, 4.0]
    assert learner.table[:, 0] == pytest.approx(expected)
    assert not learner.table[:, 1].any()


@pytest.mark.parametrize(("kind", "trace"), [("accumulating", 1 + 0.5 * 0.95), ("replacing", 1.0)])
def test_a_state_seen_twice_adds_to_its_trace_or_renews_it(kind: TraceKind, trace: float) -> None:
    for learner in (QLambda(1, 1, kind=kind), FuzzyQLambda(1, 1, kind=kind)):
        learner.begin(0.1, 0.5)
        for _ in range(2):
            if isinstance(learner, QLambda):
                learner.learn(0, 0, 1.0, 0)
            else:
                learner.learn(np.ones(1), (0,), 1.0, np.ones(1))
        assert learner.traces[0, 0] == pytest.approx(trace)


def test_a_table_of_another_shape_is_refused() -> None:
    for learner in (QLearning(2, 3), QLambda(2, 3), FuzzyQLambda(2, 3)):
        with pytest.raises(ValueError, match="shape"):
            learner.table = np.zeros((3, 2))


def test_a_table_that_was_read_is_a_copy() -> None:
    for learner in (QLearning(2, 3), QLambda(2, 3), FuzzyQLambda(2, 3)):
        given = np.ones((2, 3))
        learner.table = given
        given[0, 0] = learner.table[0, 0] = 7.0
        assert (learner.table == 1.0).all()


def test_only_traces_too_faint_to_matter_are_forgotten() -> None:
    chain = 40
    learner = QLambda(chain, 1)
    learner.begin(0.1, 0.5)
    for s in range(chain):
        learner.learn(s, 0, 0.0, s + 1 if s + 1 < chain else None)
    powers = (0.95 * 0.5) ** np.arange(chain - 1, -1, -1.0)
    assert learner.traces[:, 0] == pytest.approx(powers, abs=1.1e-9, rel=1e-9)
    assert 0 < np.count_nonzero(learner.traces) < chain


# Properties


@given(steps=STEPS, kind=KINDS, rate=UNIT, discount=UNIT)
def test_without_trace_decay_q_lambda_is_q_learning_step_by_step(
    steps: list[tuple[int, int, float, int | None]], kind: TraceKind, rate: float, discount: float
) -> None:
    plain = QLearning(STATES, ACTIONS, discount=discount)
    traced = QLambda(STATES, ACTIONS, discount=discount, kind=kind)
    plain.begin(rate, 0.0)
    traced.begin(rate, 0.0)
    for s, a, r, after in steps:
        assert plain.learn(s, a, r, after) == traced.learn(s, a, r, after)
        assert (plain.table == traced.table).all()


@given(
    steps=STEPS,
    kind=KINDS,
    rate=st.floats(0.0, 0.1),
    discount=UNIT,
    trace_decay=UNIT,
    best=st.booleans(),
)
def test_a_rule_alone_in_each_state_is_a_table_step_by_step(
    steps: list[tuple[int, int, float, int | None]],
    kind: TraceKind,
    rate: float,
    discount: float,
    trace_decay: float,
    best: bool,
) -> None:
    # With traces only where the best is done: Watkins cuts them elsewhere, and rules do not.
    trace_decay *= best
    table = QLambda(STATES, ACTIONS, discount=discount, kind=kind)
    rules = FuzzyQLambda(STATES, ACTIONS, discount=discount, kind=kind)
    table.begin(rate, trace_decay)
    rules.begin(rate, trace_decay)
    for s, a, r, after in steps:
        act = greedy(table.values(s)) if best else a
        found = rules.learn(alone(s), [act] * STATES, r, None if after is None else alone(after))
        assert table.learn(s, act, r, after) == pytest.approx(found)
        assert table.table == pytest.approx(rules.table)
        assert table.traces == pytest.approx(rules.traces)
        rules.table = table.table  # the last digit must not decide which is the best
        if after is None:
            table.begin(rate, trace_decay)
            rules.begin(rate, trace_decay)


@given(steps=STEPS, kind=KINDS, trace_decay=UNIT)
def test_an_action_that_is_not_the_best_cuts_all_traces_but_its_own(
    steps: list[tuple[int, int, float, int | None]], kind: TraceKind, trace_decay: float
) -> None:
    learner = QLambda(STATES, ACTIONS, kind=kind)
    learner.begin(0.1, trace_decay)
    for s, a, r, after in steps:
        before = learner.traces
        explored = learner.values(s)[a] < max(learner.values(s))
        learner.learn(s, a, r, after)
        faded = np.zeros_like(before) if explored else 0.95 * trace_decay * before
        faded[faded <= FAINT] = 0.0
        faded[s, a] = 1.0 + (faded[s, a] if kind == "accumulating" else 0.0)
        assert learner.traces == pytest.approx(faded)
    learner.begin(0.1, trace_decay)
    assert not learner.traces.any()


@given(steps=STEPS, rate=UNIT, discount=st.floats(0.0, 0.95))
def test_q_learning_never_leaves_what_can_be_earned(
    steps: list[tuple[int, int, float, int | None]], rate: float, discount: float
) -> None:
    learner = QLearning(STATES, ACTIONS, discount=discount)
    learner.begin(rate, 0.0)
    for s, a, r, after in steps * 5:
        learner.learn(s, a, r, after)
    # Each value is a mean of r + ξ·max Q, which keeps within max |r| / (1 − ξ).
    assert np.abs(learner.table).max() <= 10.0 / (1.0 - discount) * (1 + 1e-9)


@given(steps=STEPS, kind=KINDS, trace_decay=UNIT, share=UNIT)
def test_q_lambda_stays_finite_at_the_paper_s_rate(
    steps: list[tuple[int, int, float, int | None]],
    kind: TraceKind,
    trace_decay: float,
    share: float,
) -> None:
    table = QLambda(STATES, ACTIONS, kind=kind)
    rules = FuzzyQLambda(STATES, ACTIONS, kind=kind, twins=range(STATES)[::-1])
    mixed = [share * alone(s) + (1 - share) / STATES for s in range(STATES)]
    for _ in range(20):
        table.begin(LEARNING_RATE.start, trace_decay)
        rules.begin(LEARNING_RATE.start, trace_decay)
        for s, a, r, after in steps:
            table.learn(s, a, r, after)
            chosen = [(a + rule) % ACTIONS for rule in range(STATES)]
            rules.learn(mixed[s], chosen, r, None if after is None else mixed[after])
    assert np.isfinite(table.table).all()
    assert np.abs(rules.table).max() < 1e4


# Rules


@given(
    phi=st.lists(st.floats(0.0, 1.0), min_size=STATES, max_size=STATES),
    chosen=st.lists(st.integers(0, ACTIONS - 1), min_size=STATES, max_size=STATES),
    seed=st.integers(0, 1000),
)
def test_the_gradient_of_eq_19_is_how_strongly_each_rule_fires(
    phi: list[float], chosen: list[int], seed: int
) -> None:
    learner = FuzzyQLambda(STATES, ACTIONS)
    before = np.random.default_rng(seed).normal(size=(STATES, ACTIONS))
    learner.table = before
    state = np.array(phi)
    value = sum(phi[rule] * before[rule, action] for rule, action in enumerate(chosen))
    assert learner.value(state, chosen) == pytest.approx(value)
    assert learner.best(state) == pytest.approx(state @ before.max(axis=1))
    learner.begin(0.1, 0.5)
    delta = learner.learn(state, chosen, -1.0, None)
    assert delta == pytest.approx(-1.0 - value)
    change = state[:, None] * np.eye(ACTIONS)[chosen] * 0.1 * delta
    assert learner.table - before == pytest.approx(change, abs=1e-12)


def test_every_rule_tries_things_for_itself() -> None:
    learner, rng = FuzzyQLambda(3, 2), np.random.default_rng(0)
    learner.table = np.array([[0.0, 1.0], [1.0, 0.0], [0.0, 1.0]])
    state = np.array([1.0, 0.0, 0.0])
    assert learner.choose(state, 0.0, rng) == (1, 0, 1)
    tried = {learner.choose(state, 1.0, rng) for _ in range(200)}
    assert len(tried) == 2**3


def test_a_rule_stands_by_what_it_tries_for_as_long_as_its_patience_on_average() -> None:
    learner, rng = FuzzyQLambda(40, 1000, patience=20.0), np.random.default_rng(0)
    state = np.full(40, 1 / 40)
    learner.begin(0.1, 0.9)
    chosen = np.array([learner.choose(state, 1.0, rng) for _ in range(500)])
    changes = float((chosen[1:] != chosen[:-1]).mean())
    # 20 000 trials; four standard deviations of the share are 0.006.
    assert changes == pytest.approx(1 / 20, abs=0.006)
    learner.begin(0.1, 0.9)  # nothing is carried into the next episode
    assert np.mean(np.array(learner.choose(state, 1.0, rng)) != chosen[-1]) > 0.9


def test_what_was_tried_counts_for_itself_and_not_for_what_went_before() -> None:
    learner = FuzzyQLambda(2, 2, discount=1.0)
    learner.table = np.array([[0.0, -1.0], [0.0, -4.0]])
    learner.begin(0.1, 1.0)
    learner.learn(np.array([1.0, 0.0]), (0, 0), -2.0, np.array([0.0, 1.0]))
    learner.learn(np.array([0.0, 1.0]), (0, 1), -3.0, None)
    # The second step was worth 4 less than the best that could be done there, and cost 3: better
    # than thought for the one that was tried, worse than the best for the one before.
    assert learner.table[1] == pytest.approx([0.0, -4.0 + 0.1 * (-3.0 + 4.0)])
    assert learner.table[0] == pytest.approx([0.1 * -2.0 + 0.1 * -3.0, -1.0])


@pytest.mark.parametrize("kind", ["accumulating", "replacing"])
def test_values_do_not_grow_beyond_what_can_be_lost_however_much_is_tried(kind: TraceKind) -> None:
    learner, rng = FuzzyQLambda(3, 3, discount=1.0, kind=kind), np.random.default_rng(0)
    for _ in range(400):
        learner.begin(0.05, 0.9)
        state = rng.dirichlet(np.ones(3))
        for step in range(20):
            after = rng.dirichlet(np.ones(3))
            chosen = learner.choose(state, 0.5, rng)
            cost = 1.0 + float(state @ np.array(chosen))
            learner.learn(state, chosen, -cost, None if step == 19 else after)
            state = after
    # An episode costs 20 to 60; with the error of what was tried in the traces it is 1e9 and more.
    assert -60.0 < learner.table.min() < learner.table.max() < 0.0


@given(steps=STEPS, kind=KINDS, trace_decay=UNIT)
def test_twins_learn_alike_from_whatever_happens_to_either(
    steps: list[tuple[int, int, float, int | None]], kind: TraceKind, trace_decay: float
) -> None:
    one = FuzzyQLambda(STATES, ACTIONS, kind=kind, twins=range(STATES)[::-1])
    other = FuzzyQLambda(STATES, ACTIONS, kind=kind, twins=range(STATES)[::-1])
    for learner in (one, other):
        learner.begin(0.1, trace_decay)
    for s, a, r, after in steps:
        one.learn(alone(s), [a] * STATES, r, None if after is None else alone(after))
        mirrored = None if after is None else alone(STATES - 1 - after)
        other.learn(alone(STATES - 1 - s), [a] * STATES, r, mirrored)
        assert (one.table == one.table[::-1]).all()
        assert one.table == pytest.approx(other.table)


def test_the_rule_in_the_middle_learns_once_and_not_twice() -> None:
    plain, twinned = FuzzyQLambda(3, 1), FuzzyQLambda(3, 1, twins=(2, 1, 0))
    for learner in (plain, twinned):
        learner.begin(0.1, 0.0)
        learner.learn(np.array([0.0, 1.0, 0.0]), (0, 0, 0), -1.0, None)
    assert plain.table.tolist() == twinned.table.tolist()


def test_replacing_traces_keep_the_stronger_of_old_and_new() -> None:
    learner = FuzzyQLambda(2, 1, kind="replacing")
    learner.begin(0.1, 1.0)
    learner.learn(np.array([1.0, 0.1]), (0, 0), 0.0, np.array([0.2, 0.8]))
    learner.learn(np.array([0.2, 0.8]), (0, 0), 0.0, None)
    assert learner.traces[:, 0] == pytest.approx([0.95, 0.8])


# Known solutions


@pytest.mark.slow
@pytest.mark.parametrize(
    ("states", "left", "trace_decay"), [(5, 0.0, 0.0), (5, 0.0, 0.8), (19, -1.0, 0.8)]
)
def test_a_random_walk_s_values_are_found(states: int, left: float, trace_decay: float) -> None:
    walk = RandomWalk(states, left=left)
    learner = QLambda(states, 1, discount=1.0)
    setup = Setup(1500, rate=Schedule(0.2, 0.1995), trace_decay=Schedule(trace_decay))
    train(walk, learner, setup)
    # The chance of the walk leaves about 0.02 after so many; the ends are 1 or 2 apart.
    assert learner.table == pytest.approx(walk.solution(), abs=0.06)


LEARNERS: list[Callable[[int, int], QLearning]] = [
    lambda states, actions: QLearning(states, actions, discount=0.95),
    QLambda,
    lambda states, actions: QLambda(states, actions, kind="replacing"),
]


@pytest.mark.parametrize("trace_decay", [TRACE_DECAY, Schedule(0.9)], ids=["Eq. 21", "0.9"])
@pytest.mark.parametrize("make", LEARNERS, ids=["Q", "Q(λ)", "Q(λ), replacing"])
def test_the_cliff_s_values_are_found(
    make: Callable[[int, int], QLearning], trace_decay: Schedule
) -> None:
    cliff = CliffWalk()
    learner = make(cliff.states, cliff.actions)
    setup = Setup(
        1000,
        rate=Schedule(0.5),
        trace_decay=trace_decay,
        exploration=Schedule(0.7, 0.65),
        max_steps=300,
    )
    curve = train(cliff, learner, setup)
    solution = cliff.solution(0.95)
    stood = ~np.isnan(solution)
    # Nothing is left to chance here, so the values are met; how closely is a matter of visits:
    # 3e-4 or better with each of the first three seeds.
    assert learner.table[stood] == pytest.approx(solution[stood], abs=0.01)
    state, steps, over = cliff.reset(1), 0, False
    while not over and steps < 20:
        state, reward, over = cliff.step(greedy(learner.values(state)))
        steps += 1
        assert reward == -1.0
    assert steps == 13  # along the very edge
    assert (curve["outcome"][-100:] == b"goal").all()


@pytest.mark.parametrize("make", LEARNERS, ids=["Q", "Q(λ)", "Q(λ), replacing"])
def test_a_corridor_s_values_are_found(make: Callable[[int, int], QLearning]) -> None:
    corridor = Corridor(10)
    learner = make(10, 2)
    train(corridor, learner, Setup(300, rate=Schedule(0.5)))
    assert learner.table == pytest.approx(corridor.solution(0.95), abs=1e-3)


def test_the_solutions_solve_bellman_s_equation() -> None:
    # Written down in closed form, so checked by what defines them.
    cliff, discount = CliffWalk(), 0.95
    q = cliff.solution(discount)
    for state in np.flatnonzero(~np.isnan(q[:, 0])).tolist():
        for action in range(4):
            cliff.reset(0)
            row, column = divmod(state, 12)
            for go in [0] * (3 - row) + [1] * column:  # up, then to the right
                cliff.step(go)
            after, reward, over = cliff.step(action)
            best = 0.0 if over else q[after].max()
            assert q[state, action] == pytest.approx(reward + discount * best)
    assert np.isnan(q[37:]).all()


def test_with_all_of_the_trace_one_episode_tells_the_whole_chain() -> None:
    chain = 8
    short, long = QLambda(chain, 1), QLambda(chain, 1)
    for learner, trace_decay in ((short, 0.0), (long, 1.0)):
        learner.begin(0.5, trace_decay)
        for s in range(chain):
            over = s == chain - 1
            learner.learn(s, 0, 1.0 if over else 0.0, None if over else s + 1)
    assert np.flatnonzero(short.table).tolist() == [chain - 1]
    expected = [0.5 * 0.95 ** (chain - 1 - s) for s in range(chain)]
    assert long.table[:, 0] == pytest.approx(expected)
