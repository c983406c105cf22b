"""``fuzzyq robots`` lists what a scenario can ask for."""

import json

from PIL import Image
from typer.testing import CliRunner

from fuzzyq_bullet.cli.app import app
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.robots import robot_names


def test_a_row_for_every_robot_and_its_numbers_as_json():
    told = CliRunner().invoke(app, ["robots"]).stdout.splitlines()
    assert [line.split()[0] for line in told[1:]] == list(robot_names())
    figures = json.loads(CliRunner().invoke(app, ["robots", "--json"]).stdout)
    assert figures["jackal"]["mass"] == 17.0
    assert len(figures["jackal"]["footprint"]) == 4
    assert all(figures[name]["source"] for name in figures if name != "fuzzyq")


def test_a_picture_shows_them_all(tmp_path):
    file = tmp_path / "robots.png"
    assert CliRunner().invoke(app, ["robots", "--picture", str(file)]).exit_code == 0
    with Image.open(file) as image:
        assert len(image.getcolors(1 << 20)) > 20
    wrong = CliRunner().invoke(app, ["robots", "--picture", str(tmp_path / "robots.txt")])
    assert isinstance(wrong.exception, UserError)
