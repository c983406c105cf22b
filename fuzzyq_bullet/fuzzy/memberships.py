"""Membership functions: how far a number belongs to a fuzzy set, from 0 to 1."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, fields
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]
LEAST = 1e-6
"""Least width and slope: below it numbers lose their digits."""


class _Function(ABC):
    __slots__ = ()

    @abstractmethod
    def degree(self, x: float) -> float:
        """Return the membership of one number."""

    def degrees(self, x: float | Floats) -> Floats:
        """Return the memberships of numbers, in their shape."""
        values = np.asarray(x, dtype=np.float64)
        return np.array([self.degree(one) for one in values.ravel().tolist()]).reshape(values.shape)

    @property
    def parameters(self) -> tuple[float, ...]:
        """The numbers that it is made from, in their order."""
        return tuple(getattr(self, one.name) for one in fields(self))  # type: ignore[arg-type]


def _check(ok: bool, what: str) -> None:
    if not ok:
        raise ValueError(what)


@dataclass(frozen=True, slots=True)
class Gaussian(_Function):
    """exp(−(x − center)² / 2·width²), as the paper has it.

    Attributes:
        center: c.
        width: σ, at least ``LEAST``.

    Raises:
        ValueError: If the width is too small.
    """

    center: float
    width: float

    def __post_init__(self) -> None:
        _check(self.width >= LEAST, f"the width must be at least {LEAST:g}, got {self.width:g}")

    def degree(self, x: float) -> float:
        """Return the membership of one number."""
        return math.exp((x - self.center) * (x - self.center) * (-0.5 / self.width**2))

    def degrees(self, x: float | Floats) -> Floats:
        """Return the memberships of numbers, in their shape."""
        offset = (np.asarray(x, dtype=np.float64) - self.center) / self.width
        return np.asarray(np.exp(-0.5 * offset**2))


@dataclass(frozen=True, slots=True)
class Trapezoidal(_Function):
    """0 up to ``left``, 1 between the shoulders, 0 from ``right`` on; straight lines between.

    A side may be upright: its end is its shoulder, which belongs to the set.

    Raises:
        ValueError: If the numbers do not rise, or all are the same.
    """

    left: float
    left_shoulder: float
    right_shoulder: float
    right: float

    def __post_init__(self) -> None:
        _check_slopes(self.parameters)

    @property
    def center(self) -> float:
        """The middle of its shoulders."""
        return (self.left_shoulder + self.right_shoulder) / 2

    def degree(self, x: float) -> float:
        """Return the membership of one number."""
        return _on_slopes(x, *self.parameters)


@dataclass(frozen=True, slots=True)
class Triangular(_Function):
    """0 up to ``left``, 1 at ``peak``, 0 from ``right`` on; straight lines between.

    Raises:
        ValueError: If the numbers do not rise, or all are the same.
    """

    left: float
    peak: float
    right: float

    def __post_init__(self) -> None:
        _check_slopes(self.parameters)

    @property
    def center(self) -> float:
        """Its peak."""
        return self.peak

    def degree(self, x: float) -> float:
        """Return the membership of one number."""
        return _on_slopes(x, self.left, self.peak, self.peak, self.right)


@dataclass(frozen=True, slots=True)
class Bell(_Function):
    """1 / (1 + |(x − center) / half_width|^(2·slope)): a flat top with smooth flanks.

    Attributes:
        center: Its middle.
        half_width: How far from the middle the membership is 0.5, positive.
        slope: The greater, the steeper its flanks, positive.

    Raises:
        ValueError: If the half width or the slope is not positive.
    """

    center: float
    half_width: float
    slope: float

    def __post_init__(self) -> None:
        for name, number in (("half width", self.half_width), ("slope", self.slope)):
            _check(number >= LEAST, f"the {name} must be at least {LEAST:g}, got {number:g}")

    def degree(self, x: float) -> float:
        """Return the membership of one number."""
        part = abs((x - self.center) / self.half_width)
        # So far out that its power would overflow, nothing is left of the membership.
        far = 2.0 * self.slope * math.log10(part) > 300.0 if part > 0.0 else False
        return 0.0 if far else 1.0 / (1.0 + part ** (2.0 * self.slope))


@dataclass(frozen=True, slots=True)
class Singleton(_Function):
    """1 at one number, 0 everywhere else."""

    center: float

    def degree(self, x: float) -> float:
        """Return the membership of one number."""
        return 1.0 if x == self.center else 0.0


def _check_slopes(numbers: tuple[float, ...]) -> None:
    listed = "[" + ", ".join(f"{one:g}" for one in numbers) + "]"
    _check(list(numbers) == sorted(numbers), f"the numbers must rise, got {listed}")
    _check(numbers[0] < numbers[-1], f"it has no width: {listed}")


def _on_slopes(
    x: float, left: float, left_shoulder: float, right_shoulder: float, right: float
) -> float:
    if left_shoulder <= x <= right_shoulder:
        return 1.0
    if left < x < left_shoulder:
        return (x - left) / (left_shoulder - left)
    if right_shoulder < x < right:
        return (right - x) / (right - right_shoulder)
    return 0.0


MembershipFunction: TypeAlias = Gaussian | Triangular | Trapezoidal | Bell | Singleton
"""Each has a ``center``, the middle of where the membership is 1; it may lie outside the domain."""
SHAPES: dict[str, type[MembershipFunction]] = {
    "gaussian": Gaussian,
    "triangular": Triangular,
    "trapezoidal": Trapezoidal,
    "bell": Bell,
    "singleton": Singleton,
}
"""The membership functions by the names that files give them."""
