"""What a run is held to (``expect:``): which figure, which limit, and how a miss is said."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from operator import attrgetter
from typing import Annotated, Any, Literal, TypeAlias, TypeVar

from pydantic import BeforeValidator, Field, SerializeAsAny, ValidationInfo, create_model

from fuzzyq_bullet.blame import blamed
from fuzzyq_bullet.quantities import Model, Number
from fuzzyq_bullet.wording import plain

OutcomeName: TypeAlias = Literal["goal", "collision", "timeout", "stuck"]
Sense: TypeAlias = Literal["exactly", "at least", "at most"]
Figure: TypeAlias = Callable[[Any], "float | str | None"]
"""From the ``Result`` of a run to the figure that is compared."""
_F = TypeVar("_F", bound=Figure)

ANY_NAME = "any name"
"""Context of a validation that takes what nobody registered here, as with a record from elsewhere:
a planner as a mere name, and no expectation of which nothing is known."""


class Expect(Model):
    """What CI holds the run to."""

    outcome: OutcomeName = Field(default="goal", description="How the run must end.")
    min_clearance: Annotated[Number, Field(ge=0.0)] | None = Field(
        default=None, description="Least distance to anything (m)."
    )
    max_time: Annotated[Number, Field(gt=0.0)] | None = Field(
        default=None, description="Longest simulated time (s)."
    )
    contact: Literal["none", "not-at-fault"] = Field(
        default="none",
        description="Which contacts end a run well: none, or those that the robot is not at fault "
        "for (passive safety).",
    )
    pass_rate: Annotated[Number, Field(gt=0.0, le=1.0)] = Field(
        default=1.0,
        description="Least share of the runs that must meet all this, with check --repeat.",
    )


@dataclass(frozen=True)
class _Expectation:
    figure: Figure
    sense: Sense
    said: str
    unit: str
    digits: int
    missing: str

    def unmet(self, limit: Any, result: Any) -> str:
        """Return why a result does not meet a limit; nothing if it does."""
        figure: Any = self.figure(result)
        if self.sense == "exactly":
            met, wanted = figure == limit, f"expected {limit}"
        else:
            more = self.sense == "at least"
            # Asked this way round, a figure that is not a number meets nothing.
            met = figure is not None and (figure >= limit if more else figure <= limit)
            unit = f" {self.unit}" if self.unit else ""
            wanted = f"expected {limit:g}{unit} or {'more' if more else 'less'}"
        if met:
            return ""
        if figure is None:
            return f"{self.missing}; {wanted}"
        if not isinstance(figure, str):
            figure = plain(figure, self.digits)
        return f"{self.said.format(figure)}, {wanted}"


_OF_GROUPS = ("pass_rate",)
"""What is expected of several runs together; one run neither meets nor misses it."""
_NO_FIGURES = (*_OF_GROUPS, "contact")
_EXCUSED = ("outcome", "min_clearance")
"""What a contact that the robot is not at fault for need not meet if such contacts are allowed."""
_expectations: dict[str, _Expectation] = {}
_model: type[Expect] = Expect


def register_expectation(
    name: str,
    *,
    sense: Sense,
    said: str,
    unit: str = "",
    digits: int = 2,
    missing: str = "there is no such figure of this run",
    limit: Any = Number,
) -> Callable[[_F], _F]:
    """Make an expectation known, so that ``expect:`` of a scenario may ask for it: a decorator.

    What is decorated takes the ``Result`` of a run and returns the figure to compare. A figure that
    is ``None`` or not a number meets nothing. The first line of its docstring goes into the JSON
    Schema. In a file of one's own::

        from fuzzyq_bullet import Result
        from fuzzyq_bullet.scenario import register_expectation

        @register_expectation("max_turning", sense="at most", said="turned {} rad", unit="rad")
        def turning(result: Result) -> float:
            \"\"\"Greatest sum of all changes of direction (rad).\"\"\"
            return result.turning_rad

    With ``--plugin FILE``, ``expect: {max_turning: 20.0}`` is then read by ``run``, ``check``,
    ``validate`` and pytest; a run that turns more fails with "turned 23.10 rad, expected 20 rad or
    less".

    Args:
        name: The key in the scenario file.
        sense: How figure and limit are compared.
        said: What is said of a figure that does not meet the limit; ``{}`` stands for it.
        unit: Unit of both.
        digits: Decimals of the figure in messages.
        missing: What is said where the run has no such figure.
        limit: Type of the value in the scenario file, as pydantic takes it; by default any finite
            number, written as ``20`` or ``20.0``.

    Raises:
        ValueError: If the name is taken, or can be no key.
    """
    global _model
    taken = name in _expectations or name in _NO_FIGURES
    if taken or (name not in Expect.model_fields and hasattr(Expect, name)):
        raise ValueError(f"an expectation named {name!r} is registered already")
    if not name.isidentifier() or name.startswith("_"):
        raise ValueError(f"an expectation cannot be named {name!r}; allowed: letters, digits, '_'")

    def keep(figure: _F) -> _F:
        global _model
        _expectations[name] = _Expectation(figure, sense, said, unit, digits, missing)
        if name not in Expect.model_fields:
            told = Field(default=None, description=(figure.__doc__ or "").split("\n")[0])
            more: dict[str, Any] = {name: (limit | None, told)}
            _model = create_model("Expect", __base__=_model, __doc__=Expect.__doc__, **more)
        return figure

    return keep


register_expectation("outcome", sense="exactly", said="outcome {}")(attrgetter("outcome"))
register_expectation(
    "min_clearance",
    sense="at least",
    said="least clearance {} m",
    unit="m",
    digits=3,
    missing="no clearance, as there is nothing to keep clear of",
)(attrgetter("min_clearance_m"))
register_expectation("max_time", sense="at most", said="took {} s", unit="s", digits=1)(
    attrgetter("time_s")
)


def expect_model() -> type[Expect]:
    """Return the model of ``expect:`` with all expectations that are registered."""
    return _model


def unmet_expectations(expect: Expect, result: Any) -> list[str]:
    """Return one line for every expectation that a run does not meet; empty when all is well.

    Args:
        expect: What is expected.
        result: The ``Result`` of the run.

    Raises:
        UserError: If an expectation of the user's own fails itself.
    """
    lines = []
    excused = expect.contact == "not-at-fault" and result.at_fault is False
    for name, limit in expect:
        if limit is None or name in _NO_FIGURES or (excused and name in _EXCUSED):
            continue
        with blamed(f"expectation {name}"):
            lines.append(_expectations[name].unmet(limit, result))
    return [line for line in lines if line]


def _choose_model(value: Any, info: ValidationInfo) -> Any:
    """Turn a mapping into the model of all expectations that are registered."""
    if not isinstance(value, Mapping):
        return value  # what is expected already, or a mistake that pydantic names
    if info.context == ANY_NAME:
        value = {key: limit for key, limit in value.items() if key in _model.model_fields}
    return _model.model_validate(value)


AnyExpect: TypeAlias = Annotated[SerializeAsAny[Expect], BeforeValidator(_choose_model)]
"""A field of a model for whatever is registered."""
