"""What learning gains is plain arithmetic over pairs of rows; made by hand, the answer is known."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rich.console import Console
from scipy.stats import binom

from fuzzyq_bullet import UserError
from fuzzyq_bullet.cli.app import call
from fuzzyq_bullet.cli.study import printed
from fuzzyq_bullet.learning import Policy, hash_of
from fuzzyq_bullet.planning.fuzzy_q_lambda import CHOICES
from fuzzyq_bullet.scenario import realise
from fuzzyq_bullet.studies import Findings
from fuzzyq_bullet.studies.episodes import Environment, Row
from fuzzyq_bullet.studies.learning.shown import picture, tables_of
from fuzzyq_bullet.studies.learning.study import (
    MOST_SEED,
    NO_CONTROLLER,
    ComparisonPlan,
    Learning,
    unseen,
)
from fuzzyq_bullet.studies.learning.table import (
    LEARNED,
    Against,
    Summary,
    Target,
    summary_of,
    time_ratios,
)
from fuzzyq_bullet.studies.selection import (
    HALF,
    ONE,
    PAIRS,
    TRIPLES,
    Weights,
    best_of,
    label_of,
    search,
    settings_of,
)
from fuzzyq_bullet.studies.statistics import (
    Estimate,
    difference_of_shares,
    mean_of_differences,
    median_of_ratios,
    ratio_of_means,
)
from fuzzyq_bullet.training.registry import learn, recipe_of
from fuzzyq_bullet.training.tasks import FIRST_SEED, Tasks
from tests.helpers.commands import Call, no_workers

SLOW, FAST = HALF, ONE
RIVAL = "best triple"
ROLES = {RIVAL: label_of(FAST)}
TIMES = st.lists(st.tuples(st.floats(1.0, 600.0), st.floats(1.0, 600.0)), min_size=1, max_size=12)


def dice(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def row(planner: str | Weights, run: int = 0, **changes: Any) -> Row:
    """A success: 11 m driven in 20 s where 10 m are the shortest."""
    plain = {
        "planner": planner if isinstance(planner, str) else label_of(planner),
        "drive": "wheels",
        "layout": "scatter",
        "count": 25,
        "run": run,
        "seed": run,
        "feasible": True,
        "outcome": "goal",
        "steps": 4800,
        "time_s": 20.0,
        "path_length_m": 11.0,
        "shortest_path_m": 10.0,
        "spl": 10 / 11,
        "min_clearance_m": 0.1,
        "collisions": 0,
        "digest": "d",
    }
    return Row(**{**plain, **changes})


def stuck(planner: str | Weights, run: int, **changes: Any) -> Row:
    return row(planner, run, **{"outcome": "stuck", "time_s": 600.0, "spl": 0.0, **changes})


def hit(planner: str | Weights, run: int, **changes: Any) -> Row:
    return stuck(planner, run, **{"outcome": "collision", "collisions": 1, **changes})


def gain(rows: Iterable[Row], roles: Mapping[str, str] = ROLES) -> tuple[Summary, Against]:
    summary = summary_of(rows, roles, RIVAL, dice())
    return summary, next(one for one in summary.against if one.role == RIVAL)


def missed(summary: Summary) -> list[str]:
    return [one.what.split()[0] for one in summary.targets if not one.met]


# Intervals


@settings(max_examples=25)
@given(TIMES)
def test_an_interval_holds_its_estimate(pairs: list[tuple[float, float]]) -> None:
    ours, theirs = zip(*pairs, strict=True)
    for figure in (ratio_of_means, median_of_ratios, mean_of_differences):
        one = figure(ours, theirs, dice())
        assert one is not None
        assert one.low <= one.value <= one.high
        assert one.pairs == len(pairs)


@settings(max_examples=25)
@given(TIMES)
def test_exchanged_a_ratio_is_its_reciprocal_and_so_is_its_interval(
    pairs: list[tuple[float, float]],
) -> None:
    ours, theirs = zip(*pairs, strict=True)
    one, two = ratio_of_means(ours, theirs, dice()), ratio_of_means(theirs, ours, dice())
    assert one is not None
    assert two is not None
    ends = (two.value, two.low, two.high)
    assert (1 / one.value, 1 / one.high, 1 / one.low) == pytest.approx(ends, rel=1e-12)


@settings(max_examples=25)
@given(st.lists(st.floats(1.0, 600.0), min_size=1, max_size=12))
def test_the_same_on_both_sides_is_no_gain_for_certain(times: list[float]) -> None:
    n = len(times)
    assert ratio_of_means(times, times, dice()) == Estimate(1.0, 1.0, 1.0, n)
    assert median_of_ratios(times, times, dice()) == Estimate(1.0, 1.0, 1.0, n)
    assert mean_of_differences(times, times, dice()) == Estimate(0.0, 0.0, 0.0, n)


def test_the_interval_is_as_wide_as_theory_says_and_knows_of_the_pairs() -> None:
    rng = dice(1)
    noise = rng.normal(0.0, 1.0, 400)
    other = mean_of_differences(noise.tolist(), [0.0] * 400, dice())
    assert other is not None
    half = 1.96 * noise.std() / 20
    # 10 000 resamples place an end to about 2 % of the half-width.
    assert (other.low, other.high) == pytest.approx(
        (noise.mean() - half, noise.mean() + half), abs=0.08 * half
    )
    # Environments differ a hundredfold, but in each of them ours takes nine tenths.
    theirs = rng.uniform(5.0, 500.0, 50)
    paired = ratio_of_means((0.9 * theirs).tolist(), theirs.tolist(), dice())
    assert paired is not None
    assert (paired.value, paired.low, paired.high) == pytest.approx((0.9, 0.9, 0.9))


def test_the_mean_is_for_the_long_way_and_the_median_for_the_usual_one() -> None:
    ours, theirs = [10.0, 10.0, 100.0], [10.0, 10.0, 400.0]
    means, usual = ratio_of_means(ours, theirs, dice()), median_of_ratios(ours, theirs, dice())
    assert means is not None
    assert usual is not None
    assert (means.value, usual.value) == pytest.approx((120 / 420, 1.0))


def test_the_generator_decides_the_interval_and_nothing_else() -> None:
    ours, theirs = [1.0, 2.0, 4.0, 9.0], [2.0, 3.0, 3.0, 7.0]
    assert ratio_of_means(ours, theirs, dice(3)) == ratio_of_means(ours, theirs, dice(3))


def test_without_pairs_there_is_no_estimate() -> None:
    for figure in (ratio_of_means, median_of_ratios, mean_of_differences):
        assert figure([], [], dice()) is None
    assert difference_of_shares([], []) is None
    assert ratio_of_means([1.0], [0.0], dice()) is None


def test_a_share_without_a_failure_is_not_certain() -> None:
    one = difference_of_shares([True] * 200, [True] * 200)
    assert one is not None
    # The rule of three says 1.5 % for one share at 95 %; here are two, at 97.5 % on both sides.
    assert (one.value, one.low, one.high) == pytest.approx((0.0, -0.0217, 0.0217), abs=1e-4)


def test_the_interval_of_a_share_is_exact() -> None:
    # At its ends, so many or more, or so few or fewer, are seen once in 80 times.
    one = difference_of_shares([True] * 3 + [False] * 7, [False] * 10)
    assert one is not None
    unseen_side = 1 - 0.0125 ** (1 / 10)
    low, high = one.low + unseen_side, one.high
    assert binom.sf(2, 10, low) == pytest.approx(0.0125)
    assert binom.cdf(3, 10, high) == pytest.approx(0.0125)


def test_shares_are_compared_pair_by_pair() -> None:
    ours = [True, True, True, False, True] * 20
    theirs = [True, False, True, True, False] * 20
    one, other = difference_of_shares(ours, theirs), difference_of_shares(theirs, ours)
    assert one is not None
    assert other is not None
    assert one.value == pytest.approx(0.2)
    assert one.low < one.value < one.high
    assert (other.value, other.low, other.high) == pytest.approx((-0.2, -one.high, -one.low))


# What counts where


def test_a_failure_of_one_side_counts_in_success_and_in_no_time() -> None:
    summary, against = gain(
        [
            *(row(LEARNED, run, time_s=10.0) for run in (0, 1, 2)),
            *(row(FAST, 0, time_s=20.0), row(FAST, 1, time_s=20.0), stuck(FAST, 2)),
        ]
    )
    assert against.time == Estimate(0.5, 0.5, 0.5, 2)
    assert against.success is not None
    assert against.success.value == pytest.approx(1 / 3)
    assert [line.figures.found for line in summary.lines] == pytest.approx([2 / 3, 1.0])
    assert [line.figures.time for line in summary.lines] == [20.0, 10.0]
    assert missed(summary) == []


def test_a_failure_of_the_learned_one_misses_the_target_however_fast_it_is() -> None:
    summary, against = gain(
        [row(LEARNED, 0, time_s=1.0), stuck(LEARNED, 1), row(FAST, 0), row(FAST, 1)]
    )
    assert against.time is not None
    assert against.time.value == 0.05
    assert missed(summary) == ["success"]


def test_a_collision_counts_where_there_is_no_way_too_and_success_does_not() -> None:
    closed = {"feasible": False, "shortest_path_m": None, "spl": None}
    summary, against = gain(
        [
            *(row(LEARNED, 0, time_s=10.0), hit(LEARNED, 1, **closed)),
            *(row(FAST, 0), stuck(FAST, 1, **closed)),
        ]
    )
    assert (summary.environments, summary.feasible, summary.common) == (2, 1, 1)
    assert against.collisions is not None
    assert against.collisions.value == 0.5
    assert against.success is not None
    assert against.success.pairs == 1
    assert missed(summary) == ["collisions"]


def test_an_error_excuses_nothing() -> None:
    blank = dict.fromkeys(("steps", "time_s", "path_length_m", "shortest_path_m", "spl", "digest"))
    gone = row(FAST, 1, outcome="error", feasible=None, collisions=None, error="E", **blank)
    rows = [row(LEARNED, 0, time_s=1.0), row(LEARNED, 1, time_s=1.0), row(FAST, 0), gone]
    summary, against = gain(rows)
    assert summary.feasible == 2
    assert against.time is not None
    assert against.time.pairs == 1
    assert missed(summary) == ["errors"]


def test_every_figure_is_compared_on_the_same_environments() -> None:
    _, against = gain(
        [
            row(LEARNED, 0, steps=10, path_length_m=12.0, min_clearance_m=0.3),
            row(LEARNED, 1, steps=30, path_length_m=12.0, min_clearance_m=None),
            row(FAST, 0, steps=20, path_length_m=10.0, min_clearance_m=0.2),
            row(FAST, 1, steps=60, path_length_m=10.0),
        ]
    )
    assert against.steps == Estimate(0.5, 0.5, 0.5, 2)
    assert against.path is not None
    assert against.path.value == pytest.approx(1.2)
    assert against.clearance is not None
    assert (against.clearance.value, against.clearance.pairs) == (pytest.approx(0.1), 1)


def test_a_gain_of_less_than_a_twentieth_misses_and_one_never_measured_too() -> None:
    for time, expected in ((19.0, []), (19.1, ["time"]), (25.0, ["time", "upper"])):
        summary, _ = gain([row(LEARNED, time_s=time), row(FAST)])
        assert missed(summary) == expected
    summary, against = gain([stuck(LEARNED, 0), stuck(FAST, 0)])
    assert against.time is None
    assert missed(summary) == ["time", "upper"]
    assert "not measured" in str(Target("time", None, 0.95, "at most"))


def test_counts_are_compared_apart() -> None:
    rows = [
        *(row(LEARNED, 0, count=25, time_s=10.0), row(LEARNED, 1, count=100, time_s=40.0)),
        *(row(FAST, 0, count=25), row(FAST, 1, count=100)),
    ]
    summary, _ = gain(rows)
    seen = [(one.count, one.time.value if one.time else None) for one in summary.counts]
    assert seen == [(25, 0.5), (100, 2.0)]
    assert time_ratios(rows, label_of(FAST)) == {25: [0.5], 100: [2.0]}


def test_a_planner_that_missed_an_environment_cannot_be_compared() -> None:
    with pytest.raises(ValueError, match="row for every environment"):
        gain([row(LEARNED, 0), row(LEARNED, 1), row(FAST, 0)])


# The best fixed weights


def test_the_best_is_the_fastest_of_the_surest_of_the_safe() -> None:
    unsafe, unsure, slow, fast = (Weights(k / 4, 1.0, 1.0) for k in (1, 2, 3, 4))
    rows = [
        *(row(unsafe, 0, time_s=1.0), hit(unsafe, 1)),
        *(row(unsure, 0, time_s=2.0), stuck(unsure, 1)),
        *(row(slow, 0, time_s=30.0), row(slow, 1, time_s=30.0)),
        *(row(fast, 0, time_s=10.0), row(fast, 1, time_s=40.0)),
    ]
    tried = (unsafe, unsure, slow, fast)
    choice = best_of(rows, tried)
    assert choice.best == fast
    assert (choice.feasible, choice.common) == (2, 2)
    assert [one.time for one in choice.trials] == [None, None, 30.0, 25.0]
    assert best_of(rows, tried[:3]).best == slow
    assert best_of(rows, tried[:2]).best == unsure
    assert best_of(rows, tried[:1]).best == unsafe


def test_times_of_the_best_are_those_of_environments_that_all_of_them_solved() -> None:
    # Equally sure, but ``one`` failed where the way is long and ``two`` where it is short.
    one, two = Weights(1.0, 1.0, 1.0), Weights(2.0, 1.0, 1.0)
    rows = [
        *(row(one, 0, time_s=10.0), row(one, 1, time_s=12.0), stuck(one, 2)),
        *(stuck(two, 0), row(two, 1, time_s=11.0), row(two, 2, time_s=90.0)),
    ]
    choice = best_of(rows, (one, two))
    assert (choice.best, choice.common) == (two, 1)


def test_where_there_is_no_way_nothing_can_be_solved_and_among_equals_the_first_is_best() -> None:
    rows = [row(one, 0) for one in (SLOW, FAST)]
    rows += [stuck(SLOW, 1, feasible=False), row(FAST, 1, feasible=False)]
    assert best_of(rows, (SLOW, FAST)).best == SLOW
    assert best_of(rows, (FAST, SLOW)).best == FAST


def test_a_search_that_cannot_tell_says_so() -> None:
    with pytest.raises(UserError, match="--grid: no environment"):
        best_of([stuck(SLOW, 0), stuck(FAST, 0)], (SLOW, FAST))


def test_the_search_offers_all_that_learning_has() -> None:
    turning = {one for one in CHOICES if one.turn}  # 0 is no weight, but no controller
    assert turning <= {(one.step, one.turn) for one in TRIPLES if one.breakout_at == 4.0}
    assert {HALF, ONE} <= set(PAIRS) <= set(TRIPLES)
    labels = [label_of(one) for one in TRIPLES]
    assert len(set(labels)) == len(labels)
    told = settings_of(Weights(2.0, 0.5, 3.0))
    assert (told.weights, told.breakout_at) == ((2.0, 0.5), 3.0)


# What is run


@pytest.fixture(scope="module")
def policy(tmp_path_factory: pytest.TempPathFactory) -> tuple[Policy, Path]:
    """A policy that has learned next to nothing, and its file."""
    recipe = recipe_of("fuzzy-q-lambda")
    tasks = Tasks(drive="kinematic", seed=3, counts=(5,))
    made, _ = learn(recipe, tasks, recipe.setup(3, 3), command="a test")
    path = tmp_path_factory.mktemp("policy") / "policy.json"
    made.save(path)
    return made, path


def comparison(policy: Policy, seed: int, number: int = 8) -> ComparisonPlan:
    return ComparisonPlan(
        sweep="learning comparison",
        drive="kinematic",
        seed=seed,
        environments=number,
        counts=(5, 25),
        fixed=(label_of(HALF), label_of(ONE)),
        policy=hash_of(policy),
    )


def test_the_search_takes_place_where_the_training_did() -> None:
    stage = search("learning", "kinematic", 3, 3, (HALF,))
    for episode, job in enumerate(stage.plan.jobs(stage.planners), start=1):
        trained_on = recipe_of("fuzzy-q-lambda").tasks("kinematic", 3).scenario_of(episode)
        ours = realise(job.scenario())
        assert ours.obstacles == trained_on.obstacles
        assert (ours.start, ours.goal) == (trained_on.start, trained_on.goal)
        assert job.environment.run == episode


def test_no_environment_of_the_comparison_is_one_of_a_training(
    policy: tuple[Policy, Path],
) -> None:
    for seed in (0, MOST_SEED):
        plan = comparison(policy[0], seed, 1000)
        least, greatest = unseen(plan.places())
        assert 0 <= least <= greatest < FIRST_SEED
    trained_on = [where for where, *_ in search("l", "kinematic", 0, 2, (ONE,)).plan.schedule()]
    assert min(where.seed for where in trained_on) >= FIRST_SEED
    with pytest.raises(UserError, match="for training"):
        unseen([Environment("scatter", 25, 0, 5), *trained_on])


def test_all_planners_meet_the_same_environments_with_counts_in_turn(
    policy: tuple[Policy, Path],
) -> None:
    plan = comparison(policy[0], 0, 4)
    names = [label_of(HALF), label_of(ONE), NO_CONTROLLER, LEARNED]
    assert [(name, where.count) for where, name, _ in plan.schedule()] == [
        (name, count) for count in (5, 25, 5, 25) for name in names
    ]
    assert plan.total == len(list(plan.schedule()))


def test_another_training_makes_another_comparison(policy: tuple[Policy, Path]) -> None:
    changed = policy[0].model_copy(update={"table": ((1.0,),)})
    assert comparison(policy[0], 0).described() != comparison(changed, 0).described()


# The whole of it, as people call it


@pytest.mark.slow
def test_it_runs_goes_on_and_says_what_it_found(
    fuzzyq: Call, inside: Call, policy: tuple[Policy, Path], tmp_path: Path
) -> None:
    command = (
        *("bench", "learning", "--policy", policy[1], "--drive", "kinematic", "--environments", 4),
        *("--counts", "5,10", "--grid", 1, "--jobs", 2, "--out", tmp_path),
    )
    with no_workers():
        first = inside(*command, "--json")
    assert first.returncode in (0, 1), first.stderr
    told = json.loads(first.stdout)
    assert told == json.loads((tmp_path / "learning.json").read_text())
    assert first.returncode == int(not all(one["met"] for one in told["targets"]))
    assert "no training saw any of the 4 environments: their seeds are 0 to 3" in first.stderr
    assert told["seeds"]["greatest"] == 3 < told["seeds"]["first_of_trainings"]
    assert [one["role"] for one in told["lines"]] == [
        *("0.5/0.5", "1/1", "best pair", "best triple", "no controller", "learned")
    ]
    assert len(told["search"]["best triple"]["trials"]) == len(TRIPLES)
    assert told["settings"]["same_tasks"] is False  # this policy learned among 5 obstacles
    assert (tmp_path / "learning.png").read_bytes().startswith(b"\x89PNG")
    files = [tmp_path / name for name in ("grid/grid.csv", "comparison/comparison.csv")]
    files.append(tmp_path / "learning.json")
    before = [path.read_bytes() for path in files]

    for name in ("grid", "comparison"):  # what is lost is run again, and nothing else
        journal = tmp_path / name / "journal.jsonl"
        journal.write_bytes(b"".join(journal.read_bytes().splitlines(keepends=True)[:-2]))
    again = fuzzyq(*command)
    assert again.returncode == first.returncode
    assert [
        line.split(" in ")[0] for line in again.stderr.splitlines() if "episodes/s" in line
    ] == [
        "grid: 2 episodes",
        "comparison: 2 episodes",
    ]
    assert [path.read_bytes() for path in files] == before
    assert max(map(len, again.stdout.splitlines())) <= Learning.width


def test_the_tables_cut_nothing_off() -> None:
    fixed = {"0.5/0.5": SLOW, "1/1": ONE, "best pair": TRIPLES[-1], RIVAL: TRIPLES[-2]}
    others = {role: label_of(weights) for role, weights in fixed.items()}
    others["no controller"] = NO_CONTROLLER
    rows = [
        row(name, run, time_s=10.0 + run + 0.123 * place)
        for place, name in enumerate((LEARNED, *others.values()))
        for run in range(3)
    ]
    summary, _ = gain(rows, others)
    console = Console(width=1000)
    with console.capture() as shown:
        console.print(printed(Findings(tables_of(summary, "about"), {})))
    text = shown.get()
    assert all(role in text for role in others)
    assert "no/controller" not in text
    # The tables themselves, without the words below them, which are broken wherever there is room.
    widths = [len(line.rstrip()) for line in text.splitlines() if line.startswith((*others, "le"))]
    assert 0 < max(widths) <= Learning.width


def test_the_picture_has_every_environment_and_every_interval() -> None:
    rows = [row(name, run, count=25 + 25 * (run % 2)) for name in (LEARNED, FAST) for run in (0, 1)]
    rows += [row(LEARNED, 2, count=50, time_s=10.0), row(FAST, 2, count=50)]
    summary, _ = gain(rows)
    figure = picture(summary, time_ratios(rows, label_of(FAST)), "title")
    left, right = figure.axes
    points = sorted(y for line in left.lines if line.get_marker() == "o" for y in line.get_ydata())
    assert points == pytest.approx([1.0, 1.0, 0.5][::-1])
    assert [text.get_text() for text in right.texts] == ["0.833  [0.500, 1.000]"]


MISTAKES = {
    ("--counts", "none"): ["--counts"],
    ("--drive", "both"): ["--drive", "wheels", "kinematic"],
    ("--drive", "wheel"): ["did you mean 'wheels'?"],
    ("--seed", str(MOST_SEED + 1)): ["--seed", str(MOST_SEED)],
    ("--seed", "-1"): ["--seed", "-1"],
    ("--grid", "0"): ["--grid"],
    ("--environments", "0"): ["--environments"],
    ("--policy", "nowhere.json"): ["nowhere.json", "fuzzyq train"],
    ("--policy", "x" * 5000): ["--policy", "4096"],
}


@pytest.mark.parametrize("options", MISTAKES, ids=lambda one: " ".join(one)[:40])
def test_a_mistake_is_one_line_and_nothing_is_run(
    options: tuple[str, ...],
    policy: tuple[Policy, Path],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    monkeypatch.chdir(tmp_path)
    given = ("--policy", str(policy[1]))
    monkeypatch.setattr(sys, "argv", ["fuzzyq", "bench", "learning", *given, *options])
    with pytest.raises(UserError) as caught:
        call()
    (line,) = caught.value.problems
    assert "\n" not in line
    assert all(word in line for word in MISTAKES[options])
    assert not list(tmp_path.iterdir())
