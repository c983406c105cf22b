"""Linguistic variables: named Gaussian fuzzy sets over a domain (Eq. 1)."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]

_LINE = re.compile(r"(?P<label>\w+)\s+(?P<words>[A-Za-z ]+?)\s*\[\s*(?P<numbers>[^\]]*?)\s*\]")


@dataclass(frozen=True, slots=True)
class FuzzySet:
    """One value of a linguistic variable: exp(−(x − center)² / 2·width²).

    Attributes:
        label: Short name by which rules refer to it, such as ``VN``.
        words: The name in words, such as ``Very Near``.
        width: σ, in the unit of the variable, positive.
        center: c, where the membership is 1; it may lie outside the domain.

    Raises:
        ValueError: If the width is not positive or a number is not finite.
    """

    label: str
    words: str
    width: float
    center: float

    def __post_init__(self) -> None:
        if not (math.isfinite(self.width) and math.isfinite(self.center) and self.width > 0):
            raise ValueError(
                f"{self.label}: [{self.width} {self.center}] is not a positive width and a center"
            )

    def membership(self, x: float | Floats) -> Floats:
        """Return the degrees, in (0, 1], to which the values ``x`` belong; the shape of ``x``."""
        offset = (np.asarray(x, dtype=np.float64) - self.center) / self.width
        return np.asarray(np.exp(-0.5 * offset**2))


@dataclass(frozen=True, slots=True)
class Variable:
    """A linguistic variable T(x) = {A¹, …, Aᵐ} (Eq. 1).

    Attributes:
        name: What rules and tables call it.
        domain: Least and greatest value.
        sets: Its fuzzy sets, in the order of the tables.

    Raises:
        ValueError: If the domain is empty, there is no set, or two sets share a label.
    """

    name: str
    domain: tuple[float, float]
    sets: tuple[FuzzySet, ...]

    def __post_init__(self) -> None:
        low, high = self.domain
        if not (math.isfinite(low) and math.isfinite(high) and low < high):
            raise ValueError(f"{self.name}: [{low}, {high}] is not a domain")
        if not self.sets:
            raise ValueError(f"{self.name}: has no fuzzy sets")
        if len(set(self.labels)) != len(self.labels):
            raise ValueError(f"{self.name}: two sets share a label: {', '.join(self.labels)}")

    @classmethod
    def parse(cls, name: str, domain: tuple[float, float], table: str) -> Variable:
        """Read a variable from a table with a line ``LABEL words [width center]`` for each set.

        Raises:
            ValueError: If a line does not read so, or the variable would not be valid.
        """
        sets = []
        for line in filter(None, map(str.strip, table.splitlines())):
            match = _LINE.fullmatch(line)
            try:
                width, center = map(float, match["numbers"].split() if match else ())
            except ValueError:
                raise ValueError(f"{name}: not 'LABEL words [width center]': {line!r}") from None
            assert match is not None  # without a match there were no two numbers
            sets.append(FuzzySet(match["label"], match["words"], width, center))
        return cls(name, domain, tuple(sets))

    @property
    def labels(self) -> tuple[str, ...]:
        """The labels of the sets, in order."""
        return tuple(fuzzy_set.label for fuzzy_set in self.sets)

    def words(self, label: str) -> str:
        """Return the words that ``label`` stands for.

        Raises:
            KeyError: If the variable has no such label.
        """
        return {fuzzy_set.label: fuzzy_set.words for fuzzy_set in self.sets}[label]

    def memberships(self, x: float | Floats) -> Floats:
        """Return the membership of ``x`` in every set: an axis of sets, then those of ``x``."""
        return np.stack([fuzzy_set.membership(x) for fuzzy_set in self.sets])

    def clip(self, x: float) -> float:
        """Return ``x`` moved to the nearest value of the domain.

        Raises:
            ValueError: If ``x`` is not a number.
        """
        if x != x:
            raise ValueError(f"{self.name} is not a number")
        low, high = self.domain
        return low if x < low else high if x > high else float(x)
