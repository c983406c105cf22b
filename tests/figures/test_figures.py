"""The paper's figures: every one in the registry is drawn, and shows what it claims."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from PIL import Image

from fuzzyq_bullet.cli.report import figure
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.figures import FIGURES, drawing, runs
from fuzzyq_bullet.figures.figure4 import picture, surfaces
from fuzzyq_bullet.figures.runs import Grid, Panel, RunsFigure
from fuzzyq_bullet.fuzzy import paper_controller

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.figure import Figure


@pytest.fixture(scope="module")
def figure4() -> Figure:
    return picture(paper_controller())


def test_the_command_draws_figure_4_and_prints_where(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "new" / "folder"
    figure("4", out=out)
    path = out / "figure4.png"
    assert capsys.readouterr().out == f"{path}\n"
    assert list(out.iterdir()) == [path]
    with Image.open(path) as image:
        assert image.format == "PNG"
        assert image.width >= 1200
        # Two surfaces coloured from dark to light, not an empty page.
        assert len(image.convert("RGB").getcolors(maxcolors=1 << 24) or ()) > 500


def test_the_same_figure_is_drawn_again_to_the_byte(tmp_path: Path) -> None:
    one, other = (drawing(4)(tmp_path / name)[0].read_bytes() for name in ("a", "b"))
    assert one == other


@pytest.mark.slow
def test_another_planner_may_drive_and_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    figure = RunsFigure("figure11", (Panel("figure-11b", "With sustained avoidance"),), Grid(1))
    drawn: list[Figure] = []
    monkeypatch.setattr(runs, "save_png", lambda figure, path, **told: drawn.append(figure))
    [path] = figure.draw(tmp_path, "fuzzy-q-lambda")
    assert path.name == "figure11-fuzzy-q-lambda.png"
    titles = [legend.get_title().get_text() for legend in drawn[0].legends]
    assert titles == ["planner fuzzy-q-lambda; arena 10 × 10 m"]


def test_a_figure_without_runs_has_no_planner_and_no_figure_has_one_that_is_not_there(
    tmp_path: Path,
) -> None:
    with pytest.raises(UserError, match="figure 4 shows no run that a planner could drive"):
        figure("4", out=tmp_path, planner="fuzzy")
    with pytest.raises(UserError, match="planner"):
        figure("9", out=tmp_path / "new", planner="../nobody")
    assert not list(tmp_path.iterdir())


def test_a_picture_that_is_no_figure_of_ours_is_replaced_only_when_asked_to(tmp_path: Path) -> None:
    mine = tmp_path / "figure4.png"
    Image.new("RGB", (200, 200)).save(mine)
    before = mine.read_bytes()
    with pytest.raises(UserError, match=r"figure4.png: is there already, .* --replace"):
        figure("4", out=tmp_path)
    assert mine.read_bytes() == before
    figure("4", out=tmp_path, replace=True)
    drawn = mine.read_bytes()
    assert drawn != before
    figure("4", out=tmp_path)  # its own
    assert mine.read_bytes() == drawn


def test_an_unknown_figure_is_refused_and_the_known_are_named(tmp_path: Path) -> None:
    with pytest.raises(UserError) as caught:
        figure("99", out=tmp_path)
    (line,) = caught.value.problems
    assert "99" in line
    assert all(f"{number} ({shows})" in line for number, shows in FIGURES.items())
    assert not list(tmp_path.iterdir())


def test_a_folder_that_cannot_be_written_is_the_users_error(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(UserError, match="file"):
        figure("4", out=tmp_path / "file")


def test_every_registered_figure_can_be_drawn() -> None:
    for number in FIGURES:
        assert callable(drawing(number))


def test_the_surfaces_are_the_controllers_outputs() -> None:
    distance, difference, stride, turn = surfaces(paper_controller(), points=6)
    assert distance.shape == difference.shape == stride.shape == turn.shape == (6, 6)
    assert (distance.min(), distance.max()) == (0.0, 5.0)
    assert (difference.min(), difference.max()) == (-5.0, 5.0)
    for index in np.ndindex(6, 6):
        inference = paper_controller().infer(distance[index], difference[index])
        assert (stride[index], turn[index]) == (inference.stride, inference.turn)


def test_figure_4_shows_the_step_and_then_the_turn_with_words_and_units(figure4: Figure) -> None:
    step, turn = figure4.axes
    for axes in (step, turn):
        assert "distance ahead" in axes.get_xlabel()
        assert "left less right" in axes.get_ylabel()
        assert "S_p" in axes.get_xlabel()
        assert "S_p" in axes.get_ylabel()
    assert "N_s" in step.get_zlabel()  # type: ignore[attr-defined]
    assert "N_a" in turn.get_zlabel()  # type: ignore[attr-defined]
    # What is drawn is what the label says: the least and greatest of each output.
    *_, stride, angle = surfaces(paper_controller())
    for axes, values in ((step, stride), (turn, angle)):
        drawn = axes.zz_dataLim.intervalx  # type: ignore[attr-defined]
        assert tuple(drawn) == pytest.approx((values.min(), values.max()))
    assert step.get_zlim() == pytest.approx((0.0, 2.0))  # type: ignore[attr-defined]
    assert turn.get_zlim() == pytest.approx((-2.0, 2.0))  # type: ignore[attr-defined]


def test_the_colours_of_figure_4_read_in_grey(figure4: Figure) -> None:
    for axes in figure4.axes:
        (surface,) = axes.collections
        colours = surface.get_cmap()(np.linspace(0, 1, 64))[:, :3]
        lightness = colours @ (0.2126, 0.7152, 0.0722)
        assert (np.diff(lightness) > 0).all()
