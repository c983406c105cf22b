"""``fuzzyq explain`` in metres and degrees, and on a narrow terminal."""

from __future__ import annotations

import math
import re
from itertools import chain
from typing import TYPE_CHECKING

import pytest

from fuzzyq_bullet.fuzzy import paper_controller

if TYPE_CHECKING:
    from tests.helpers.commands import Call


@pytest.mark.parametrize("difference", [-0.8, 0.0, 3.0])
def test_turn_and_step_are_also_in_degrees_and_metres(difference: float, fuzzyq: Call) -> None:
    text = fuzzyq("explain", 1, difference).stdout
    assert "S_p = 0.2 m; A_p = 60° unless turn_unit is set." in text
    inferred = paper_controller().infer(1.0, difference)
    for weight in (1.0, 0.5):
        (line,) = (line for line in text.splitlines() if f"ω1, ω2 = {weight:g}, " in line)
        turn, step = re.search(r"turn asked ([\d.]+)°.*, step asked ([\d.]+) m", line).groups()
        assert math.isclose(float(turn), abs(weight * inferred.turn * 60.0), abs_tol=0.051)
        assert math.isclose(float(step), weight * inferred.stride * 0.2, abs_tol=0.00051)
        assert ("left" in line, "right" in line) == (difference > 0, difference < 0)


def test_the_freer_side_stands_on_its_side_as_in_the_film(fuzzyq: Call) -> None:
    page = fuzzyq("explain", 1, 0, "--policy", "shipped").stdout
    assert page.count("Columns PB and PS: the left is freer; NS and NB: the right is freer.") == 2
    heads = [line.split()[3:] for line in page.splitlines() if "d \\ Df" in line]
    assert heads == [["PB", "PS", "ZO", "NS", "NB"]] * 2
    base = paper_controller().base
    for name, cells in zip(base.row.labels, base.cells, strict=True):
        rows = [line.split() for line in page.splitlines() if line.split()[:1] == [name]]
        shown = " ".join(next(row for row in rows if row[1] in ("PL", "PS")))
        places = [shown.index(" ".join(cell)) for cell in reversed(cells)]
        assert places == sorted(places)


@pytest.mark.parametrize("width", [50, 60, 79, 80])
def test_a_narrow_terminal_cuts_nothing_away(
    width: int, fuzzyq: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", str(width))
    shown = fuzzyq("explain", "1", "-0.8").stdout
    assert max(map(len, shown.splitlines())) <= width
    assert "…" not in shown
    strengths = paper_controller().infer(1.0, -0.8).rules
    table = shown[shown.index("d \\ Df") : shown.index("Rules that fire")]
    firing = sorted(f"{strength:.2f}" for strength in chain(*strengths) if strength >= 0.01)
    assert sorted(re.findall(r"\d\.\d\d", table)) == firing
    assert table.count("◀") == 1
    assert "turn to the right by 0.50·ω2·A_p" in shown
