"""HTML out of elements: whatever is no element is text, and cannot become anything else."""

from __future__ import annotations

import base64
import html
from typing import TypeAlias

Child: TypeAlias = "Html | str | None"

MARK = "fuzzyq report"
"""Stands as ``generator`` in every page, so that one is known again."""

_VOID = frozenset({"br", "img", "link", "meta", "source"})


class Html(str):
    """Text that is HTML already; made by ``tag`` and ``join`` alone."""

    __slots__ = ()


def tag(element: str, /, *children: Child, **attributes: str | int | bool | None) -> Html:
    """Return an element.

    Args:
        element: Its name.
        children: What it holds; strings are escaped, None is left out.
        attributes: By name, where a trailing underscore is dropped and others become dashes. True
            stands for an attribute without a value; False and None leave it out.
    """
    given = "".join(
        f" {key.rstrip('_').replace('_', '-')}"
        + ("" if value is True else f'="{html.escape(str(value))}"')
        for key, value in attributes.items()
        if value is not None and value is not False
    )
    if element in _VOID:
        return Html(f"<{element}{given}>")
    return Html(f"<{element}{given}>{join(*children)}</{element}>")


def join(*children: Child) -> Html:
    """Return parts in a row; strings are escaped, None is left out."""
    return Html(
        "".join(
            one if isinstance(one, Html) else html.escape(one, quote=False)
            for one in children
            if one is not None
        )
    )


def data_uri(kind: str, contents: bytes) -> str:
    """Return contents as an address, for a page that needs no other file."""
    return f"data:{kind};base64,{base64.b64encode(contents).decode()}"
