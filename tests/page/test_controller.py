"""The controller that runs in the page infers what the Python one infers, to 1e-6."""

from __future__ import annotations

import json
import random
from itertools import product
from typing import Any, Literal

import numpy as np
import pytest

from fuzzyq_bullet.fuzzy import ControllerDefinition, definition_of, paper_controller
from fuzzyq_bullet.fuzzy.memberships import SHAPES
from tests.page.conftest import Open

CLOSE = 1e-6
"""Both add up the same 101 products in doubles; this is a million times what they may differ by."""


def grid(points: int) -> list[tuple[float, float]]:
    """Return inputs over the whole ranges, and beyond, where they are clipped."""
    distances = (*np.linspace(0.0, 5.0, points).tolist(), -1.0, 6.0)
    return list(product(distances, (*np.linspace(-5.0, 5.0, points).tolist(), -7.5, 9.0)))


def inferred(show: Open, data: dict[str, Any], inputs: list[tuple[float, float]]) -> Any:
    """Return memberships, firing strengths, turn and step, as the page infers them."""
    return show("lesson").value(
        f"""((data, inputs) => {{
          const controller = new fuzzyq.Controller(data);
          return inputs.map(([d, df]) => {{
            const {{near, side, rules, turn, step}} = controller.infer(d, df);
            return [...near, ...side, ...rules.flat(), turn, step];
          }});
        }})({json.dumps(data)}, {json.dumps(inputs)})"""
    )


def check(show: Open, definition: ControllerDefinition, inputs: list[tuple[float, float]]) -> None:
    """Compare what the page infers with what Python does."""
    controller = definition.controller()
    found = inferred(show, definition.model_dump(mode="json"), inputs)
    for (d, df), numbers in zip(inputs, found, strict=True):
        near, side, fired, turn, stride = controller.infer(d, df)
        expected = [*near, *side, *np.ravel(fired), turn, stride]
        np.testing.assert_allclose(numbers, expected, rtol=0, atol=CLOSE)


@pytest.mark.parametrize(("rules", "samples"), [("corrected", 101), ("printed", 5)])
def test_it_fires_turns_and_steps_as_in_python(
    show: Open, rules: Literal["corrected", "printed"], samples: int
) -> None:
    check(show, definition_of(paper_controller(rules, samples)), grid(21))


# Sets and tables of any kind


def random_controller(seed: int) -> dict[str, Any]:
    """Return a controller of sets of all shapes, with tables of 2 to 9 rows and columns."""
    rng = random.Random(seed)
    average = rng.random() < 0.5

    def one(low: float, high: float, output: bool) -> dict[str, Any]:
        name = rng.choice([*SHAPES] if output and average else [*SHAPES][:4])
        numbers = sorted(rng.uniform(low, high) for _ in range(4))
        if rng.random() < 0.3:
            numbers[1] = numbers[0]  # an upright side
        if name in ("gaussian", "bell"):
            steep = [rng.uniform(0.5, 5)] if name == "bell" else []
            return {name: [numbers[0], rng.uniform(0.05, 0.4) * (high - low), *steep]}
        if name == "singleton":
            return {name: numbers[0]}
        return {name: numbers if name == "trapezoidal" else [*numbers[:2], numbers[3]]}

    def variable(low: float, high: float, output: bool = False) -> dict[str, Any]:
        labels = [f"S{k}" for k in range(rng.randint(2, 9))]
        return {"range": [low, high], "sets": {label: one(low, high, output) for label in labels}}

    inputs = {"distance": variable(0, 5), "difference": variable(-5, 5)}
    outputs = {"turn": variable(-2, 2, True), "step": variable(0.1, 2, True)}
    turns, steps = ([*output["sets"]] for output in outputs.values())
    columns = len(inputs["difference"]["sets"])
    return {
        "inputs": inputs,
        "outputs": outputs,
        "rules": {
            label: [f"{rng.choice(turns)} {rng.choice(steps)}" for _ in range(columns)]
            for label in inputs["distance"]["sets"]
        },
        "inference": {
            "and": rng.choice(["product", "minimum"]),
            "defuzzification": "average" if average else "centroid",
            "samples": rng.choice([5, 31, 101]),
        },
    }


@pytest.mark.parametrize(
    "seed", [*range(4), *(pytest.param(one, marks=pytest.mark.slow) for one in range(4, 12))]
)
def test_sets_tables_and_inference_of_any_kind_are_those_of_python(show: Open, seed: int) -> None:
    check(show, ControllerDefinition.model_validate(random_controller(seed)), grid(4))
