"""The controller that runs in the page infers what the Python one infers, to 1e-6."""

from __future__ import annotations

import json
import math
import random
from itertools import product
from typing import Any, Literal

import numpy as np
import pytest

from fuzzyq_bullet.fuzzy import paper_controller
from fuzzyq_bullet.page.controller import controller_data
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


@pytest.mark.parametrize(("rules", "samples"), [("corrected", 101), ("printed", 5)])
def test_it_fires_turns_and_steps_as_in_python(
    show: Open, rules: Literal["corrected", "printed"], samples: int
) -> None:
    controller, inputs = paper_controller(rules, samples), grid(21)
    found = inferred(show, controller_data(controller), inputs)
    for (d, df), numbers in zip(inputs, found, strict=True):
        near, side, fired, turn, stride = controller.infer(d, df)
        expected = [*near, *side, *np.ravel(fired), turn, stride]
        np.testing.assert_allclose(numbers, expected, rtol=0, atol=CLOSE)


# Sets and tables of any kind. What they mean is written down once more here, as plainly as can be.

MEMBERSHIPS: dict[str, Any] = {
    "gaussian": lambda x, c, w: math.exp(-((x - c) ** 2) / (2 * w * w)),
    "bell": lambda x, c, a, b: 1 / (1 + abs((x - c) / a) ** (2 * b)),
    "triangular": lambda x, left, peak, right: float(np.interp(x, *_upright(left, peak, right))),
    "trapezoidal": lambda x, *corners: float(np.interp(x, *_upright(*corners))),
    "singleton": lambda x, at: float(x == at),
}
CENTERS: dict[str, Any] = {
    "gaussian": lambda c, w: c,
    "bell": lambda c, a, b: c,
    "triangular": lambda left, peak, right: peak,
    "trapezoidal": lambda left, first, last, right: (first + last) / 2,
    "singleton": lambda at: at,
}


def _upright(left: float, *rest: float) -> tuple[list[float], list[float]]:
    """Return the corners for ``np.interp``, which cannot have two at one place."""
    *tops, right = rest
    least = 1e-12
    xs = [left - (least if left == tops[0] else 0), *tops, right + least * (right == tops[-1])]
    if len(tops) == 2 and tops[0] == tops[1]:
        xs.pop(1)
        tops = tops[:1]
    return xs, [0.0, *(1.0 for _ in tops), 0.0]


def shape_of(one: dict[str, Any]) -> tuple[str, list[float]]:
    (name,) = set(one) & set(MEMBERSHIPS)
    return name, np.atleast_1d(one[name]).tolist()


def degree(one: dict[str, Any], x: float) -> float:
    name, numbers = shape_of(one)
    return float(MEMBERSHIPS[name](x, *numbers))


def expected(data: dict[str, Any], d: float, df: float) -> list[float]:
    """Return what a controller infers by its definition, rule by rule."""
    how = data["inference"]
    both = min if how["and"] == "minimum" else math.prod
    degrees = [
        {label: degree(one, float(np.clip(x, *variable["range"])))
         for label, one in variable["sets"].items()}
        for variable, x in zip(data["inputs"].values(), (d, df), strict=True)
    ]  # fmt: skip
    fired = [
        (both((near, side)), cell.split())
        for (label, near) in degrees[0].items()
        for side, cell in zip(degrees[1].values(), data["rules"][label], strict=True)
    ]
    values = []
    for k, output in enumerate(data["outputs"].values()):
        low, high = output["range"]
        if how["defuzzification"] == "average":
            weighed = [(f, CENTERS[name](*numbers)) for f, then in fired
                       for name, numbers in [shape_of(output["sets"][then[k]])]]  # fmt: skip
        else:
            points = np.linspace(low, high, how["samples"]).tolist()
            weighed = [
                (max(both((f, degree(output["sets"][then[k]], u))) for f, then in fired), u)
                for u in points
            ]
        total = sum(f for f, _ in weighed)
        none = (0.0, low)[k]
        values.append(sum(f * u for f, u in weighed) / total if total > 1e-300 else none)
    return [*degrees[0].values(), *degrees[1].values(), *(f for f, _ in fired), *values]


def random_controller(seed: int) -> dict[str, Any]:
    """Return a controller of sets of all shapes, with tables of 2 to 9 rows and columns."""
    rng = random.Random(seed)
    average = rng.random() < 0.5

    def one(low: float, high: float, output: bool) -> dict[str, Any]:
        name = rng.choice([*MEMBERSHIPS][: 5 if output and average else 4])
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


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12))
def test_sets_tables_and_inference_of_any_kind_mean_what_they_say(show: Open, seed: int) -> None:
    data, inputs = random_controller(seed), grid(4)
    found = inferred(show, data, inputs)
    for (d, df), numbers in zip(inputs, found, strict=True):
        np.testing.assert_allclose(numbers, expected(data, d, df), rtol=0, atol=CLOSE)
