"""A controller as data: what its file holds, checked, and the way to a controller and back.

Inputs are the distance d and the difference Df in multiples of S_p, outputs the turn N_a in
multiples of A_p and the step N_s in multiples of S_p (Eqs. 13 to 17).
"""

from __future__ import annotations

import hashlib
import json
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import (
    AfterValidator,
    ConfigDict,
    Field,
    ValidationError,
    field_validator,
    model_serializer,
    model_validator,
)
from pydantic_core import InitErrorDetails, PydanticCustomError

from fuzzyq_bullet.fuzzy.definition_checks import Mistakes, mistakes_in
from fuzzyq_bullet.fuzzy.inference import LEAST_SAMPLES, FuzzyController, Method
from fuzzyq_bullet.fuzzy.memberships import SHAPES
from fuzzyq_bullet.fuzzy.rules import RuleBase
from fuzzyq_bullet.fuzzy.sets import FuzzySet, Variable
from fuzzyq_bullet.quantities import Count, Model, Number

MOST_SETS = 15
"""Most fuzzy sets of one variable."""
MOST_SAMPLES = 10_001
LARGEST = 1000.0
NAMES = {"distance": "d", "difference": "Df", "turn": "turn", "step": "step"}
"""The variables by their names in files, and what tables and rules call them."""

_Number: TypeAlias = Annotated[Number, Field(ge=-LARGEST, le=LARGEST)]
Samples: TypeAlias = Annotated[Count, Field(ge=LEAST_SAMPLES, le=MOST_SAMPLES)]
_PRINTABLE = r"^[^\x00-\x1f\x7f-\x9f\u2028\u2029]*$"
_Words: TypeAlias = Annotated[str, Field(max_length=40, pattern=_PRINTABLE)]


def _is_label(text: str) -> str:
    if not (text.isascii() and text.isidentifier() and len(text) <= 16):
        raise PydanticCustomError(
            "label", "a label has letters, digits and '_', at most 16, no digit first"
        )
    return text


Label: TypeAlias = Annotated[str, AfterValidator(_is_label)]


class SetDefinition(Model):
    """A fuzzy set: one shape with its numbers, and words for it."""

    words: _Words = Field(default="", description="Its name in words; by default its label.")
    meaning: _Words = Field(
        default="", description="What it means to a robot, for films; by default its words."
    )
    gaussian: tuple[_Number, _Number] | None = Field(default=None, description="[center, width]")
    triangular: tuple[_Number, _Number, _Number] | None = Field(
        default=None, description="[left, peak, right]"
    )
    trapezoidal: tuple[_Number, _Number, _Number, _Number] | None = Field(
        default=None, description="[left, left shoulder, right shoulder, right]"
    )
    bell: tuple[_Number, _Number, _Number] | None = Field(
        default=None, description="[center, half width, slope]"
    )
    singleton: _Number | None = Field(default=None, description="The one number that belongs.")

    @model_validator(mode="after")
    def _has_one_shape(self) -> SetDefinition:
        shapes = [name for name in SHAPES if getattr(self, name) is not None]
        if len(shapes) != 1:
            got = f"got {' and '.join(shapes)}" if shapes else "got none"
            raise PydanticCustomError(
                "one_shape", "needs one of {names}; {got}", {"names": ", ".join(SHAPES), "got": got}
            )
        try:
            self.fuzzy_set("")
        except ValueError as error:
            raise _errors([((shapes[0],), str(error))]) from error
        return self

    @property
    def shape(self) -> tuple[str, tuple[float, ...]]:
        """Name of its shape, and the numbers of that."""
        [(name, numbers)] = [
            (name, value) for name in SHAPES if (value := getattr(self, name)) is not None
        ]
        return name, numbers if isinstance(numbers, tuple) else (numbers,)

    def fuzzy_set(self, label: str) -> FuzzySet:
        """Return the set under a label."""
        name, numbers = self.shape
        return FuzzySet(label, SHAPES[name](*numbers), self.words, self.meaning)

    @model_serializer
    def _told(self) -> dict[str, Any]:
        """Leave out what is not there."""
        return {name: value for name, value in self.__dict__.items() if value not in (None, "")}


class VariableDefinition(Model):
    """A variable: its range and its fuzzy sets, by their labels, in the order of the tables."""

    range: tuple[_Number, _Number] = Field(description="Least and greatest value.")
    sets: dict[Label, SetDefinition] = Field(min_length=1, max_length=MOST_SETS)

    @field_validator("range")
    @classmethod
    def _rises(cls, value: tuple[float, float]) -> tuple[float, float]:
        if not value[0] < value[1]:
            raise PydanticCustomError("range", "its first number must be less than its second")
        return value

    def variable(self, name: str) -> Variable:
        """Return the variable under a name."""
        return Variable(
            name, self.range, tuple(one.fuzzy_set(label) for label, one in self.sets.items())
        )


class _Group(Model):
    def named(self) -> list[tuple[str, VariableDefinition]]:
        """Return the variables with their names, in order."""
        return [(name, getattr(self, name)) for name in type(self).model_fields]


class Inputs(_Group):
    """What the controller is told."""

    distance: VariableDefinition = Field(description="d: free distance ahead (S_p).")
    difference: VariableDefinition = Field(
        description="Df: free distance on the left less that on the right (S_p)."
    )


class Outputs(_Group):
    """What the controller answers."""

    turn: VariableDefinition = Field(description="N_a: turn (A_p), positive to the left.")
    step: VariableDefinition = Field(description="N_s: step (S_p).")


class MethodDefinition(Model):
    """How the controller infers."""

    model_config = ConfigDict(validate_by_name=False)

    conjunction: Literal["product", "minimum"] = Field(
        default="product", alias="and", description="What 'and' and 'then' are."
    )
    defuzzification: Literal["centroid", "average"] = Field(
        default="centroid", description="How conclusions become a number (Eq. 22: centroid)."
    )
    samples: Samples = Field(default=101, description="n of Eq. 22: points of the centroid.")

    @model_serializer
    def _told(self) -> dict[str, Any]:
        return {("and" if name == "conjunction" else name): value for name, value in self}


class ControllerDefinition(Model):
    """A whole controller: sets, rules and inference.

    ``rules`` has a row for each label of the distance, and in it a cell for each label of the
    difference: the labels of turn and step, as in ``NL VL``.
    """

    name: _Words = Field(default="", description="What pages and films call it.")
    inputs: Inputs
    outputs: Outputs
    rules: dict[Label, list[str]]
    inference: MethodDefinition = MethodDefinition()

    @model_validator(mode="after")
    def _fits_together(self) -> ControllerDefinition:
        mistakes = mistakes_in(self)
        if mistakes:
            raise _errors(mistakes)
        return self

    def digest(self) -> str:
        """Return a hash of all that it does; its name and words do not count."""
        told = definition_of(self.controller()).model_dump(mode="json")
        for group in ("inputs", "outputs"):
            for variable in told[group].values():
                for one in variable["sets"].values():
                    one.pop("words", None)
                    one.pop("meaning", None)
        return hashlib.sha256(json.dumps(told).encode()).hexdigest()[:32]

    def controller(self, samples: int | None = None) -> FuzzyController:
        """Return the controller.

        Args:
            samples: n of Eq. 22 instead of its own.
        """
        row, column, turn, step = (
            one.variable(NAMES[name]) for name, one in (*self.inputs.named(), *self.outputs.named())
        )
        cells = tuple(
            tuple(tuple(cell.split()) for cell in self.rules[label]) for label in row.labels
        )
        how = self.inference
        return FuzzyController(
            RuleBase(row, column, (turn, step), cells),
            Method(how.conjunction, how.defuzzification, samples or how.samples),
        )


def definition_of(controller: FuzzyController, name: str = "") -> ControllerDefinition:
    """Return a controller as data.

    Raises:
        pydantic.ValidationError: If a file could not hold it: a number is too large, for example.
    """
    base, how = controller.base, controller.method
    names, variables = iter(NAMES), (base.row, base.column, *base.outputs)
    distance, difference, turn, step = ({next(names): _told_of(one)} for one in variables)
    return ControllerDefinition.model_validate(
        {
            "name": name,
            "inputs": distance | difference,
            "outputs": turn | step,
            "rules": {
                label: [" ".join(cell) for cell in cells]
                for label, cells in zip(base.row.labels, base.cells, strict=True)
            },
            "inference": {
                "and": how.conjunction,
                "defuzzification": how.defuzzification,
                "samples": how.samples,
            },
        }
    )


def _told_of(variable: Variable) -> dict[str, Any]:
    names = {kind: name for name, kind in SHAPES.items()}
    sets: dict[str, Any] = {}
    for one in variable.sets:
        numbers = one.function.parameters
        sets[one.label] = {
            **({"words": one.words} if one.words != one.label else {}),
            **({"meaning": one.meaning} if one.meaning != one.words else {}),
            names[type(one.function)]: numbers[0] if len(numbers) == 1 else numbers,
        }
    return {"range": variable.domain, "sets": sets}


def _errors(mistakes: Mistakes) -> ValidationError:
    return ValidationError.from_exception_data(
        "controller",
        [
            InitErrorDetails(
                type=PydanticCustomError("controller", "{why}", {"why": why}), loc=loc, input=None
            )
            for loc, why in mistakes
        ],
    )
