"""``fuzzyq explain --policy``, ``figure weights`` and ``figure curves``: what was learned."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from PIL import Image

from fuzzyq_bullet.figures import curves, rule_weights
from fuzzyq_bullet.fuzzy import paper_controller
from fuzzyq_bullet.learning import load_policy
from fuzzyq_bullet.learning.checkpoint import ROW
from fuzzyq_bullet.planning.fuzzy_q_lambda import firing, rule_names, weighed, weights_of
from fuzzyq_bullet.planning.policies import shipped

if TYPE_CHECKING:
    from tests.helpers.commands import Call


def test_the_weights_of_every_rule_are_told_alone_or_with_what_is_sensed(inside: Call) -> None:
    weights = weights_of(load_policy(shipped("fuzzy-q-lambda")))
    names = rule_names(paper_controller().base)
    alone = json.loads(inside("explain", "--policy", "shipped", "--json").stdout)
    assert alone["weights"] == [
        {"rule": rule, "step": step, "turn": turn}
        for rule, (step, turn) in zip(names, weights.tolist(), strict=True)
    ]
    assert "weights_in_force" not in alone
    sensed = json.loads(inside("explain", 2, -1, "--policy", "shipped", "--json").stdout)
    expected = weighed(firing(paper_controller().infer(2.0, -1.0)), weights)
    assert sensed["weights_in_force"] == list(expected)
    page = inside("explain", 2, -1, "--policy", "shipped").stdout
    assert f"ω1, ω2 = {expected[0]:.3g}, {expected[1]:.3g}: turn asked" in page
    assert page.count("◀") > 2  # the strongest rule, and the weights of those that fire


@pytest.mark.parametrize(
    ("args", "words"),
    [
        ((), "D: missing; give D and DF, or neither and --policy"),
        ((1,), "DF: missing"),
        ((2, "--policy", "shipped"), "DF: missing; give D and DF, or neither and --policy"),
        (("--policy", ""), "policy: "),
        (("--policy", "x" * 5000), "policy: "),
        (("--policy", "nowhere.json"), "nowhere.json: the policy of fuzzy-q-lambda cannot be read"),
        (("--policy", shipped("q-lambda")), "is a policy of the planner 'q-lambda'"),
    ],
)
def test_what_is_missing_or_another_s_is_one_line(
    args: tuple[object, ...], words: str, fuzzyq: Call
) -> None:
    done = fuzzyq("explain", *args)
    assert done.returncode == 2
    assert words in done.stderr
    assert len(done.stderr.splitlines()) == 1


@pytest.fixture(scope="module")
def trained(fuzzyq: Call, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Two short trainings of two planners, whose policies have the same name."""
    folder = tmp_path_factory.mktemp("trained")
    files = folder / "one" / "p.json", folder / "two" / "p.json"
    for planner, file in zip(("fuzzy-q-lambda", "q-lambda"), files, strict=True):
        done = fuzzyq("train", planner, "--episodes", 3, "--out", file)
        assert done.returncode == 0, done.stderr
    return files


def test_pictures_of_what_was_learned_are_drawn_and_known_again(
    fuzzyq: Call, trained: tuple[Path, Path], tmp_path: Path
) -> None:
    for name, given in (("weights", trained[:1]), ("curves", trained)):
        for _ in range(2):  # its own it draws anew
            done = fuzzyq("figure", name, *given, "--out", tmp_path)
            assert (done.returncode, done.stdout) == (0, f"{tmp_path / name}.png\n"), done.stderr
        with Image.open(tmp_path / f"{name}.png") as image:
            assert image.width > 1000


def test_the_picture_of_weights_has_every_number_where_the_film_has_its_rule() -> None:
    weights = np.arange(50.0).reshape(25, 2)
    step, turn = rule_weights.picture(weights, "title").axes
    for axes, column in ((step, 0), (turn, 1)):
        shown = {text.get_position(): text.get_text() for text in axes.texts}
        table = weights[:, column].reshape(5, 5)[:, ::-1]  # left freer on the left
        assert shown == {(c, r): f"{table[r, c]:g}" for r in range(5) for c in range(5)}


def test_every_curve_is_drawn_and_named_whatever_its_file_is_called() -> None:
    curve = np.zeros(3, ROW)
    names = ["_under", "$\\frac$", "same", "same", "例"]
    figure = curves.picture([(name, curve) for name in names])
    assert [len(axes.lines) for axes in figure.axes] == [5, 5]
    assert len(figure.legends[0].get_texts()) == 5
    figure.savefig(io.BytesIO())  # draws no formula, and misses no letter


@pytest.mark.parametrize(
    ("args", "words"),
    [
        (("curves", "."), "POLICY: '.' is no file"),
        (("curves",), "POLICY: give 1 to 14 policies"),
        (("curves", shipped("q-lambda")), "no learning curve beside it"),
        (("weights", "a.json", "b.json"), "POLICY: weights shows one policy, got 2"),
        (("4", "a.json"), "POLICY: figure 4 shows nothing that was learned"),
        (("weights", "--planner", "fuzzy"), "--planner: weights shows no run"),
        (("5",), "FIGURE: no figure '5'; there are: 4 ("),
    ],
)
def test_what_no_picture_can_show_is_one_line(
    args: tuple[object, ...], words: str, fuzzyq: Call, tmp_path: Path
) -> None:
    done = fuzzyq("figure", *args, "--out", tmp_path)
    assert done.returncode == 2
    assert words in done.stderr
    assert not list(tmp_path.iterdir())


def test_a_picture_does_not_replace_the_policy_that_it_shows(
    fuzzyq: Call, trained: tuple[Path, Path], tmp_path: Path
) -> None:
    disguised = tmp_path / "weights.png"
    disguised.write_bytes(trained[0].read_bytes())
    done = fuzzyq("figure", "weights", disguised, "--out", tmp_path, "--replace")
    assert done.returncode == 2
    assert disguised.read_bytes() == trained[0].read_bytes()
