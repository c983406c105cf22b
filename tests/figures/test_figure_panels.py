"""Figures 9 to 12: what their panels say is what came out, and only the schemes make it so."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

import numpy as np
import pytest
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from PIL import Image

from fuzzyq_bullet import load_scenario, result_of, run, with_options
from fuzzyq_bullet.cli.report import figure
from fuzzyq_bullet.figures import FIGURES, MARK
from fuzzyq_bullet.figures.runs import FIGURES as RUNS
from fuzzyq_bullet.figures.runs import Grid, Panel, picture, scenario_of
from fuzzyq_bullet.figures.topdown import (
    HIT,
    LEAVES,
    LEGEND,
    MOVES,
    PATH,
    PLAIN,
    TEMPORARY,
    draw_run,
)
from fuzzyq_bullet.planning import MODES
from fuzzyq_bullet.scenario import bundled_scenarios, realise
from tests.test_unchanged import SAME_SINES, known, told

if TYPE_CHECKING:
    from pathlib import Path

    from fuzzyq_bullet import Trajectory

LETTERS = {9: "abc", 10: "abcd", 11: "ab", 12: "abcdefghi"}
FAILURES = {
    "figure-9a": "collision",
    "figure-9b": "collision",
    "figure-10a": "stuck",
    "figure-11a": "stuck",
}


def panels_of(number: int) -> tuple[Panel, ...]:
    return RUNS[number].panels


@pytest.fixture(scope="module")
def escape() -> Trajectory:
    """A run with all three modes that takes no time: the point robot's."""
    return run(with_options(load_scenario("figure-10b"), drive="kinematic"))


@pytest.fixture(scope="module")
def crash() -> Trajectory:
    return run(with_options(load_scenario("figure-9b"), drive="kinematic"))


def bytes_of(figure: Figure) -> bytes:
    stream = io.BytesIO()
    figure.savefig(stream, format="png")
    return stream.getvalue()


@pytest.mark.slow
@pytest.mark.parametrize("number", LETTERS)
def test_every_panel_of_a_figure_ends_as_its_scenario_promises(
    number: int,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    runs: list[Trajectory] = []

    def recorded(scenario):
        runs.append(run(scenario))
        return runs[-1]

    monkeypatch.setattr("fuzzyq_bullet.figures.runs.run", recorded)
    figure(str(number), out=tmp_path)
    assert capsys.readouterr().out == f"{tmp_path / f'figure{number}.png'}\n"
    with Image.open(tmp_path / f"figure{number}.png") as image:
        assert image.width >= 1000
        assert image.info["Software"] == MARK  # by which the command knows its own
    assert [one.scenario.name for one in runs] == [
        f"figure-{number}{letter}" for letter in LETTERS[number]
    ]
    for one in runs:
        name = one.scenario.name
        assert one.scenario.drive == "wheels"
        assert one.outcome == one.scenario.expect.outcome == FAILURES.get(name, "goal"), name
        assert (one.collision is None) == (one.outcome != "collision")
        assert one.ticks.time[-1] < 90.0
        assert not SAME_SINES or told(one) == known(name)


def test_the_figures_are_registered_and_their_scenarios_listed() -> None:
    assert set(LETTERS) <= set(FIGURES)
    listed = bundled_scenarios()
    for number in LETTERS:
        assert {panel.scenario for panel in panels_of(number)} <= set(listed)


def test_the_trap_of_10a_is_that_of_10b_and_only_the_breakout_is_missing() -> None:
    stuck, free = load_scenario("figure-10a"), load_scenario("figure-10b")
    assert realise(stuck).obstacles == realise(free).obstacles
    assert (stuck.start, stuck.goal) == (free.start, free.goal)
    assert free.planner.model_copy(update={"breakout": False}) == stuck.planner


def test_the_obstacle_of_11a_is_that_of_11b_and_only_sustained_avoidance_is_missing() -> None:
    held, past = load_scenario("figure-11a"), load_scenario("figure-11b")
    assert (held.obstacles, held.start, held.goal) == (past.obstacles, past.start, past.goal)
    assert past.planner.model_copy(update={"following": False}) == held.planner


def test_the_three_fields_of_figure_9_are_one_but_for_the_obstacle_that_overlaps() -> None:
    a, b, c = (load_scenario(f"figure-9{letter}") for letter in "abc")
    first, second, safe = (set(realise(one).obstacles) for one in (a, b, c))
    assert first == second
    (overlapping,) = first - safe
    corner = np.array(a.start.position)
    assert tuple(corner) == b.goal.position
    # The robot's disc there, 0.2 m, and the obstacle's, 0.2 m, all but touch.
    assert np.hypot(*(overlapping.position - corner)) < 0.41
    assert a.planner == b.planner == c.planner
    assert (a.random.margin, b.random.margin, c.random.margin) == (0.0, 0.0, 0.1)


def test_algorithm_2_alone_turns_9b_into_a_success() -> None:
    safe = load_scenario("figure-9b")
    safe = safe.model_copy(update={"random": load_scenario("figure-9c").random})
    assert run(safe).outcome == "goal"


def test_figure_12_has_the_fields_of_the_paper() -> None:
    counts = []
    for panel in panels_of(12):
        scenario = realise(scenario_of(panel))
        counts.append((scenario.obstacles[0].shape, len(scenario.obstacles)))
        assert panel.words.startswith(str(len(scenario.obstacles)))
        assert scenario.expect.outcome == "goal"
    assert (
        counts
        == [("cylinder", 80)] * 3 + [("cylinder", 120)] * 2 + [("box", 30)] * 2 + [("box", 60)] * 2
    )
    tasks = [load_scenario(panel.scenario) for panel in panels_of(12)]
    for changed in (2, 6, 8):
        before = tasks[changed - 1]
        assert tasks[changed].start != before.start
        assert tasks[changed].goal != before.goal


def test_the_path_is_drawn_whole_each_part_in_the_colour_of_its_mode(escape: Trajectory) -> None:
    axes = Figure().add_subplot()
    draw_run(axes, escape)
    drawn = {}
    for mode in MODES:
        colour = to_rgba(PATH[mode].colour)
        (part,) = [one for one in axes.collections if tuple(one.get_edgecolor()[0]) == colour]
        drawn[mode] = part.get_segments()
    assert sum(map(len, drawn.values())) == len(escape.ticks.time) - 1
    # With the point robot every decision is one move.
    for index, mode in enumerate(MODES):
        starts = escape.ticks.position[:-1][escape.decisions.mode == index]
        assert np.array([segment[0] for segment in drawn[mode]]) == pytest.approx(starts)


def test_the_temporary_goal_and_the_place_of_leaving_are_those_of_the_record(
    escape: Trajectory,
) -> None:
    axes = Figure().add_subplot()
    assert {TEMPORARY, LEAVES} <= set(draw_run(axes, escape))
    diamonds = [line.get_xydata()[0] for line in axes.lines if line.get_marker() == "D"]
    squares = [line.get_xydata()[0] for line in axes.lines if line.get_marker() == "s"]
    modes = [MODES[mode] for mode in escape.decisions.mode]
    begun, left = modes.index("breakout"), len(modes) - modes[::-1].index("following")
    assert diamonds == [pytest.approx(escape.decisions.target[begun])]
    assert squares[-1] == pytest.approx(escape.ticks.position[escape.decisions.tick[left]])
    bare = Figure().add_subplot()
    assert TEMPORARY not in draw_run(bare, escape, targets=False)
    assert not [line for line in bare.lines if line.get_marker() == "D"]


def test_a_collision_is_marked_where_it_was_and_nowhere_else(
    crash: Trajectory, escape: Trajectory
) -> None:
    axes = Figure().add_subplot()
    assert HIT in draw_run(axes, crash)
    (cross,) = [line.get_xydata()[0] for line in axes.lines if line.get_marker() == "X"]
    assert crash.collision is not None
    assert cross == pytest.approx(crash.collision.point)
    assert HIT not in draw_run(Figure().add_subplot(), escape)


def test_titles_say_how_each_run_ended_and_one_legend_explains_all(
    escape: Trajectory, crash: Trajectory
) -> None:
    pair = [Panel("figure-10b", "out"), Panel("figure-9b", "into")]
    drawn = picture(pair, [escape, crash], Grid(columns=2, close_up=(1.0, 1.0, 2.0)))
    whole = [axes for axes in drawn.axes if axes.get_title()]
    assert [axes.get_title() for axes in whole] == ["(a) out", "(b) into"]
    for axes, trajectory, word in zip(whole, (escape, crash), ("goal", "collision"), strict=True):
        (text,) = [one.get_text() for one in axes.texts]
        result = result_of(trajectory)
        assert text.startswith(word)
        assert f"{result.time_s:.1f} s, {result.path_length_m:.1f} m" in text
    assert len(drawn.axes) == 4  # each panel and its close-up
    (legend,) = drawn.legends
    words = [text.get_text() for text in legend.get_texts()]
    # Between them the two show all there is, but for what moves and planners without rules.
    assert words == [entry for entry in LEGEND if entry not in (MOVES, PLAIN)]
    assert "10 × 10 m" in legend.get_title().get_text()


def test_the_same_record_makes_the_same_picture_to_the_byte(escape: Trajectory) -> None:
    one, other = (
        bytes_of(picture([Panel("figure-10b", "x")], [escape], Grid(columns=1))) for _ in range(2)
    )
    assert one == other


def test_a_file_of_the_same_name_does_not_replace_a_panels_scenario(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "figure-10a").write_text("name: other\nstart: {position: [1, 1]}\n")
    assert scenario_of(panels_of(10)[0]).name == "figure-10a"


@pytest.mark.slow
@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
@pytest.mark.parametrize("name", ["semicircle", "u-shape", "rectangles", "maze"])
def test_the_layouts_that_are_bundled_to_be_filmed_are_crossed(name: str, drive: str) -> None:
    scenario = with_options(load_scenario(name), drive=drive)
    trajectory = run(scenario)
    assert trajectory.outcome == scenario.expect.outcome == "goal"
    assert trajectory.ticks.clearance.min() > 0.0
