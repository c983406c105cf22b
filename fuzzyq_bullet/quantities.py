"""What scenario files are built of: numbers within bounds, points, models, choices of models."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Generic, TypeAlias, TypeVar, get_args

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    Strict,
    TypeAdapter,
)
from pydantic_core import core_schema

Number: TypeAlias = Annotated[float, Strict(), Field(allow_inf_nan=False)]
Coordinate: TypeAlias = Annotated[Number, Field(ge=-1000.0, le=1000.0)]
Length: TypeAlias = Annotated[Number, Field(gt=0.0, le=1000.0)]
Angle: TypeAlias = Annotated[Number, Field(ge=-100.0, le=100.0)]
Count: TypeAlias = Annotated[int, Strict()]
Flag: TypeAlias = Annotated[bool, Strict()]
Point: TypeAlias = tuple[Coordinate, Coordinate]

ANGLE_KEYS = ("heading", "yaw", "direction")
"""What keys of angles are called, all in radians."""
MAX_OBSTACLES = 10_000
MIN_RADIUS = 0.02
"""Least radius and half width of an obstacle (m)."""
TOUCH = 1e-6
"""Things closer than this (m) touch, and the physics counts a touch as a collision."""
DECIMALS = 4
"""Drawn coordinates are rounded to so many decimals of a metre."""


class Model(BaseModel):
    """Base of all that a scenario file holds: immutable, and unknown keys are mistakes."""

    model_config = ConfigDict(extra="forbid", frozen=True)


M = TypeVar("M", bound=BaseModel)


class ModelRegistry(Generic[M]):
    """Registered models of one kind, told apart by the value of one key.

    ``Annotated[Base, registry]`` is the type of a field that takes any of them: validation and
    JSON Schema follow what is registered by then, members from a user's plugin included.

    Args:
        key: The key, such as ``shape``. Each member narrows it to its own names:
            ``shape: Literal["box"]``.
        default: The name that is meant where the key is absent; without one it is required.
    """

    def __init__(self, key: str, default: str | None = None) -> None:
        self.key = key
        self._default = default
        self._models: dict[str, type[M]] = {}
        self._adapter: TypeAdapter[M] | None = None

    def add(self, model: type[M]) -> None:
        """Make a model known by the names that its key allows.

        Raises:
            ValueError: If it does not narrow the key to names, or one is taken.
        """
        names = get_args(model.model_fields[self.key].annotation)
        if not names or not all(isinstance(name, str) for name in names):
            raise ValueError(f'{model.__name__} must narrow {self.key}: Literal["its-name"]')
        for name in names:
            if name in self._models:
                raise ValueError(f"a {self.key} named {name!r} is registered already")
            self._models[name] = model
        self._adapter = None

    def names(self) -> tuple[str, ...]:
        """Return all registered names, in order of registration."""
        return tuple(self._models)

    def models(self) -> tuple[type[M], ...]:
        """Return all registered models, in order of registration."""
        return tuple(dict.fromkeys(self._models.values()))

    def validate(self, value: Any) -> M:
        """Return the model that a mapping stands for; one that is made already stays as it is.

        Raises:
            pydantic.ValidationError: If it is none of them; the places of mistakes within one
                begin with its name, as with a discriminated union.
        """
        if self._default is not None and isinstance(value, dict) and self.key not in value:
            value = {self.key: self._default, **value}
        return self._members().validate_python(value)

    def _members(self) -> TypeAdapter[M]:
        if self._adapter is None:
            choice: Any = _Choice(self.key, self._models)
            self._adapter = TypeAdapter(Annotated[Any, choice])
        return self._adapter

    def __iter__(self) -> Iterator[type[M]]:
        return iter(self.models())

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self.validate)

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return handler(self._members().core_schema)


class _Choice:
    """A union of models, told apart by a key."""

    def __init__(self, key: str, models: dict[str, Any]) -> None:
        self._key = key
        self._models = models

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        choices = {name: handler.generate_schema(one) for name, one in self._models.items()}
        return core_schema.tagged_union_schema(choices, discriminator=self._key)
