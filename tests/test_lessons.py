"""The lessons: they open in Jupyter, their cells run, and what they say is so.

The cells run without Jupyter. ``python -m tests.helpers.lessons`` writes what the solutions print.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jupytext
import nbformat
import numpy as np
import pytest

from tests.helpers.lessons import FOLDER, LESSONS, SOLUTION, desk, notebook, play

CHEAP = ("6", "7")
"""Lessons that take less than a few seconds: those without a robot."""
NAMES = [path.name for path in LESSONS]

Names = dict[str, Any]
"""What the cells of a lesson left."""


def test_there_are_eight() -> None:
    assert [name[:2] for name in NAMES] == [f"{number}-" for number in range(1, 9)]


@pytest.mark.parametrize("lesson", LESSONS, ids=NAMES)
def test_it_is_a_notebook_that_stays_the_same_when_it_is_saved(lesson: Path) -> None:
    book = notebook(lesson)
    nbformat.validate(book)
    assert book.metadata.kernelspec.language == "python"
    kinds = [cell.cell_type for cell in book.cells]
    assert kinds.count("code") >= 5
    assert not any(cell.source.startswith("%") for cell in book.cells)  # no other languages
    saved = jupytext.writes(book, fmt="md").splitlines()
    kept = [line for line in saved if not line.startswith("      jupytext_version:")]
    assert kept == lesson.read_text("utf-8").splitlines()


@pytest.mark.parametrize("lesson", LESSONS, ids=NAMES)
def test_it_ends_with_two_exercises_whose_solutions_are_folded(lesson: Path) -> None:
    _, exercises = lesson.read_text("utf-8").split("\n## Exercises\n")
    assert re.findall(r"^### (\d)\. .", exercises, re.MULTILINE) == ["1", "2"]
    # Folded in Jupyter: each is a Markdown cell of its own, and no code cell shows it.
    cells = notebook(lesson).cells
    folded = [cell for cell in cells if SOLUTION.fullmatch(cell.source)]
    assert [cell.cell_type for cell in folded] == ["markdown", "markdown"]
    assert len(SOLUTION.findall(exercises)) == exercises.count("<details>") == 2


@pytest.mark.parametrize("page", [*LESSONS, FOLDER / "README.md"], ids=lambda page: page.name)
def test_its_links_lead_somewhere(page: Path) -> None:
    links = re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", page.read_text("utf-8"))
    assert links
    assert [one for one in links if ":" not in one and not (FOLDER / one).exists()] == []


def test_the_list_has_every_lesson_by_its_title() -> None:
    listed = re.findall(r"\[([^\]]+)\]\((\d-[^)]+)\)", (FOLDER / "README.md").read_text("utf-8"))
    titles = [re.search(r"^# Lesson \d: (.+)$", p.read_text("utf-8"), re.M) for p in LESSONS]
    assert listed == [(t[1], p.name) for t, p in zip(titles, LESSONS, strict=True) if t]


# --- what the lessons say, beside what their cells print


def lines_tell_where_to_turn(names: Names) -> None:
    ticks, decisions = names["ticks"], names["decisions"]
    assert names["trajectory"].outcome == "goal"
    left, middle, right = decisions.lengths[names["number_at"](5.0)]
    assert middle < left < right
    slow = (ticks.time > 30.0) & (ticks.time < 49.0)
    assert ticks.clearance[slow].min() == ticks.clearance.min()
    assert ticks.speed[slow].max() < ticks.speed[~slow & (ticks.time > 1.0)].mean()
    assert np.array_equal(decisions.lengths[names["number_at"](1.0)], [1.0, 1.0, 1.0])


def one_number_makes_it_hit_the_pillar(names: Names) -> None:
    assert (names["before"].outcome, names["after"].outcome) == ("goal", "collision")
    medium = names["distance"].memberships(2.49)[2]
    assert medium == 1.0


def rules_are_a_surface(names: Names) -> None:
    runs = [names[name].outcome for name in ("right", "wrong", "printed")]
    assert runs == ["goal", "collision", "collision"]
    turn = names["inference"].turn
    assert turn < 0.0  # to the right
    assert names["centroid"] == pytest.approx(turn, abs=1e-6)


def a_trap_holds_the_robot(names: Names) -> None:
    assert names["stuck"].outcome == "stuck"
    assert names["free"].outcome == "goal"
    assert set(names["table"]["outcome"]) == {"stuck"}
    assert names["moved"] < 1e-3
    distance, turned = names["distance"], names["turned"]
    assert distance[turned:].max() > distance[:turned].min() + 1.0


def memory_leads_out(names: Names) -> None:
    outcomes = names["table"]["outcome"].to_dict()
    assert outcomes == {"neither": "stuck", "breakout alone": "timeout", "both": "goal"}
    modes = [names["MODES"][names["decisions"].mode[k]] for k in names["changes"]]
    assert modes == ["routine", "breakout", "following", "routine"]


def the_cliff_is_learned(names: Names) -> None:
    learner, setup = names["QLearning"](48, 4, discount=0.9), names["Setup"]
    schedule = names["Schedule"]
    how = setup(episodes=500, rate=schedule(0.5), exploration=schedule(0.1))
    curve = names["train"](names["CliffWalk"](), learner, how)
    assert len(names["best_path"](learner.table)) - 1 == 13
    assert curve["total"][-100:].mean() < -40  # far below -13


def lambda_carries_news_back(names: Names) -> None:
    learned, truth = names["learned"], names["truth"]
    first = [abs(learned(trace, 1).table[0, 1] - truth[0]) for trace in (0.9, 0.5, 0.0)]
    assert first == sorted(first)
    off = names["off"]
    assert off(0.8, 0.1) < off(0.4, 0.1)
    assert off(0.4, 0.4) < off(0.8, 0.4)
    with pytest.raises(Exception, match="the learning diverges"):
        off(1.0, 0.4)


def the_best_fixed_weights_are_as_good(names: Names) -> None:
    against = {line["role"]: line["time"] for line in names["measured"]["against"]}
    assert against["best triple"]["low"] < 1.0 < against["best triple"]["high"]
    assert against["0.5/0.5"]["high"] < 0.5
    assert not all(target["met"] for target in names["measured"]["targets"])
    drives = [row["time_s"] for row in names["rows"]]
    assert drives[2] < 0.5 * drives[0]
    assert drives[2] == pytest.approx(drives[1], rel=0.1)
    who = {row["who"]: row["time"] for row in names["familiar"]["rows"] if row["family"] == "all"}
    assert 0.6 < who["learned-50"] / who["first-run"] < 0.7
    assert who["kept-map-10"] < 1.02 * who["learned-50"]


CLAIMS: dict[str, Callable[[Names], None]] = {
    "1": lines_tell_where_to_turn,
    "2": one_number_makes_it_hit_the_pillar,
    "3": rules_are_a_surface,
    "4": a_trap_holds_the_robot,
    "5": memory_leads_out,
    "6": the_cliff_is_learned,
    "7": lambda_carries_news_back,
    "8": the_best_fixed_weights_are_as_good,
}


def shown(value: Any) -> None:
    """Make sure that Jupyter could show what a cell shows."""
    if hasattr(value, "savefig"):
        value.canvas.draw()
    elif hasattr(value, "_repr_html_"):
        assert value._repr_html_()
    else:
        assert repr(value)


@pytest.mark.parametrize(
    "lesson",
    [
        pytest.param(one, id=one.name, marks=[] if one.name[0] in CHEAP else pytest.mark.slow)
        for one in LESSONS
    ],
)
def test_its_cells_run_and_its_solutions_print_what_it_says(lesson: Path, tmp_path: Path) -> None:
    with desk(tmp_path):
        names, solutions = play(lesson, shown)
        CLAIMS[lesson.name[0]](names)
    for said, printed in solutions:
        assert said == printed
