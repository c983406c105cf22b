"""Linguistic variables: named fuzzy sets over a domain (Eq. 1)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fuzzyq_bullet.fuzzy.memberships import Floats, MembershipFunction


@dataclass(frozen=True, slots=True)
class FuzzySet:
    """One value of a linguistic variable.

    Attributes:
        label: Short name by which rules refer to it, such as ``VN``.
        function: How far a number belongs to it.
        words: The name in words, such as ``Very Near``.
        meaning: What it means to a robot, such as ``very near``.
    """

    label: str
    function: MembershipFunction
    words: str = ""
    meaning: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "words", self.words or self.label)
        object.__setattr__(self, "meaning", self.meaning or self.words)

    @property
    def center(self) -> float:
        """Where the membership is 1, in the middle."""
        return self.function.center


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

    @property
    def labels(self) -> tuple[str, ...]:
        """The labels of the sets, in order."""
        return tuple(fuzzy_set.label for fuzzy_set in self.sets)

    @property
    def falling(self) -> tuple[int, ...]:
        """Where in ``sets`` each is, from the greatest center to the least.

        In this order the sets of Df stand wherever they are shown side by side: what means that the
        left is freer stands on the left, in whatever order a file lists its sets.
        """
        return tuple(sorted(range(len(self.sets)), key=lambda i: -self.sets[i].center))

    def set_of(self, label: str) -> FuzzySet:
        """Return the set that ``label`` stands for.

        Raises:
            KeyError: If the variable has no such label.
        """
        return {fuzzy_set.label: fuzzy_set for fuzzy_set in self.sets}[label]

    def memberships(self, x: float | Floats) -> Floats:
        """Return the membership of ``x`` in every set: an axis of sets, then those of ``x``."""
        return np.stack([fuzzy_set.function.degrees(x) for fuzzy_set in self.sets])

    def clip(self, x: float) -> float:
        """Return ``x`` moved to the nearest value of the domain.

        Raises:
            ValueError: If ``x`` is not a number.
        """
        if x != x:
            raise ValueError(f"{self.name} is not a number")
        low, high = self.domain
        return low if x < low else high if x > high else float(x)
