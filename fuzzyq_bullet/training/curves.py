"""A learning curve in a few numbers, for the progress bar, the summary and the picture."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fuzzyq_bullet.learning.tabular import Floats

if TYPE_CHECKING:
    from fuzzyq_bullet.learning.checkpoint import Curve

WINDOW = 50
"""Number of episodes in a running mean."""
SUCCESS = b"goal"
"""The outcome of a successful episode."""


def reached(curve: Curve) -> NDArray[np.bool_]:
    """Return which episodes reached the goal, shape (N,)."""
    return np.asarray(curve["outcome"] == SUCCESS)


def success(curve: Curve) -> float:
    """Return the share of episodes that reached the goal; NaN if there are no episodes."""
    return float(reached(curve).mean()) if len(curve) else float("nan")


def last_mean(values: NDArray[Any], window: int = WINDOW) -> Floats:
    """Return the running mean over the last ``window`` values, shape (N,).

    At the beginning, where there are fewer, it is the mean of those.
    """
    count = len(values)
    sums = np.concatenate([[0.0], np.cumsum(values, dtype=float)])
    last = np.arange(1, count + 1)
    first = np.maximum(last - window, 0)
    return np.asarray((sums[last] - sums[first]) / (last - first))
