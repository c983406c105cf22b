"""The controller that runs in the page infers what the Python one infers, to 1e-6."""

from __future__ import annotations

import json
from typing import Literal

import numpy as np
import pytest

from fuzzyq_bullet.fuzzy import paper_controller
from fuzzyq_bullet.page.controller import controller_data
from tests.page.conftest import Open

CLOSE = 1e-6
"""Both add up the same 101 products in doubles; this is a million times what they may differ by."""

INPUTS = [
    (float(d), float(df))
    for d in (*np.linspace(0.0, 5.0, 21), -1.0, 6.0)
    for df in (*np.linspace(-5.0, 5.0, 21), -7.5, 9.0)
]
"""The whole ranges, and beyond, where inputs are clipped."""

INFER = """
((data, inputs) => {
  const controller = new fuzzyq.Controller(data);
  return inputs.map(([d, df]) => {
    const {near, side, rules, turn, step} = controller.infer(d, df);
    return [...near, ...side, ...rules.flat(), turn, step];
  });
})"""


@pytest.mark.parametrize(("rules", "samples"), [("corrected", 101), ("printed", 5)])
def test_it_fires_turns_and_steps_as_in_python(
    show: Open, rules: Literal["corrected", "printed"], samples: int
) -> None:
    controller = paper_controller(rules, samples)
    data = json.dumps(controller_data(controller))
    found = show("lesson").value(f"{INFER}({data}, {json.dumps(INPUTS)})")
    for (d, df), numbers in zip(INPUTS, found, strict=True):
        near, side, fired, turn, stride = controller.infer(d, df)
        expected = [*near, *side, *np.ravel(fired), turn, stride]
        np.testing.assert_allclose(numbers, expected, rtol=0, atol=CLOSE)
