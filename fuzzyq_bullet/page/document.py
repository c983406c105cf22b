"""One HTML file out of its parts: template, style, modules of JavaScript, and data.

The modules in ``js/`` are plain ES modules. A page opened from disk cannot load others, so they are
put one after the other into one script: each becomes a function that is called at once and returns
what the module exports.
"""

from __future__ import annotations

import base64
import hashlib
import html
import json
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyq_bullet.fuzzy import ControllerDefinition, paper_definition
from fuzzyq_bullet.page.run_data import run_data
from fuzzyq_bullet.planning.base import STEP_UNIT
from fuzzyq_bullet.planning.settings import RoutineSettings, WeightsSettings
from fuzzyq_bullet.version import __version__

if TYPE_CHECKING:
    from fuzzyq_bullet.recording.trajectory import Trajectory

MARK = "fuzzyq page"
"""Stands as ``generator`` in every page, so that one is known again."""

MODULES = (
    "sets", "inference", "dom", "colours", "timeline", "arrows", "movers", "field", "plot",
    "rule_table", "surface", "senses", "around", "judges", "rules", "acts", "run_view", "legend",
    "player", "what_if", "keys", "main",
)  # fmt: skip
"""The modules of the page in an order in which each stands behind those that it imports."""

_FOLDER = Path(__file__).parent
_IMPORT = re.compile(r'^import (\{[^}]*\}) from "\./(\w+)\.js";$', re.MULTILINE)
_EXPORT = re.compile(r"^export ((?:const|function|class) (\w+))", re.MULTILINE)
_SLOT = re.compile(r"\{\{(\w+)\}\}")


def record_page(trajectories: Sequence[Trajectory]) -> str:
    """Return the page of one record, or of two side by side.

    Args:
        trajectories: The runs; each is shown from its own start.
    """
    runs = [run_data(trajectory) for trajectory in trajectories]
    names = list(dict.fromkeys(str(run["name"]) for run in runs))
    return _page(" and ".join(names), {"runs": runs, **_standard()})


def lesson_page(controller: ControllerDefinition | None = None) -> str:
    """Return the page without a record: the sets, the rules and the surface alone.

    Args:
        controller: By default the paper's.
    """
    shown = (controller or paper_definition()).model_dump(mode="json")
    return _page("Fuzzy rules", {"runs": [], "controller": shown, **_standard()})


def script() -> str:
    """Return all modules as one script."""
    return "\n".join(_module(name) for name in MODULES)


def _standard() -> dict[str, Any]:
    """Return what turns the controller's outputs into degrees and metres without a record."""
    return {
        "version": __version__,
        "standard": {
            "turn_unit": RoutineSettings.model_fields["turn_unit"].default,
            "step_unit": STEP_UNIT,
            "weights": list(WeightsSettings.model_fields["weights"].default),
        },
    }


def _module(name: str) -> str:
    text = (_FOLDER / "js" / f"{name}.js").read_text(encoding="utf-8")
    exported = ", ".join(match[2] for match in _EXPORT.finditer(text))
    body = _EXPORT.sub(r"\1", _IMPORT.sub(r"const \1 = \2_module;", text))
    return f"const {name}_module = (() => {{\n{body}return {{ {exported} }};\n}})();\n"


def _page(title: str, data: dict[str, Any]) -> str:
    style = (_FOLDER / "page.css").read_text(encoding="utf-8")
    code = script()
    # "<" cannot stand in a script's text, for "</script>" and "<!--" would end or change it.
    held = json.dumps(data, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    slots = {
        "title": html.escape(f"{title} · fuzzyq"),
        "heading": html.escape(title),
        "mark": MARK,
        "policy": html.escape(
            f"default-src 'none'; img-src data:; style-src '{_hash(style)}'; "
            f"script-src '{_hash(code)}'; base-uri 'none'; form-action 'none'"
        ),
        "style": style,
        "data": held.replace("<", "\\u003c"),
        "script": code,
    }
    template = (_FOLDER / "page.html").read_text(encoding="utf-8")
    return _SLOT.sub(lambda slot: slots[slot[1]], template)


def _hash(text: str) -> str:
    """Return how a browser is told of an inline style or script: by its hash, nothing else runs."""
    return f"sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}"
