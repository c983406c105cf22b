"""On the page: by which commands, settings and versions all of it was made."""

from __future__ import annotations

import json
import platform
from importlib import metadata
from pathlib import Path

from fuzzyq_bullet.experiments.report import commands
from fuzzyq_bullet.experiments.report.evaluation import Evaluation
from fuzzyq_bullet.experiments.report.markup import join, tag
from fuzzyq_bullet.experiments.report.parts import blocks
from fuzzyq_bullet.experiments.report.parts.blocks import Section
from fuzzyq_bullet.experiments.report.parts.steps import pair_of
from fuzzyq_bullet.experiments.report.settings import Search
from fuzzyq_bullet.platforms import pybullet_in_words
from fuzzyq_bullet.version import __version__

PACKAGES = ("numpy", "scipy", "matplotlib", "pillow", "imageio-ffmpeg")


def section(evaluation: Evaluation, report: str) -> Section:
    """Return the section; ``report`` is the command that made the page."""
    lines = [commands.success(settings, one.folder) for one, settings in evaluation.success]
    for one, table, search in evaluation.steps:
        found = search.settings if search else None
        pair = pair_of(table)
        lines.append(
            commands.steps(
                table,
                found if isinstance(found, Search) else None,
                (pair.step, pair.turn),
                one.folder.parent,
            )
        )
    for one, comparison, search in evaluation.learning:
        assert isinstance(search.settings, Search)
        lines.append(commands.learning(comparison, search.settings, one.folder.parent))
    lines += [commands.escape(settings, one.folder) for one, settings in evaluation.escape]
    versions = {one.settings.version for one in evaluation.sweeps}
    others = sorted(versions - {__version__})
    versions_of = [pybullet_in_words(), *(f"{name} {metadata.version(name)}" for name in PACKAGES)]
    packages = ", ".join(versions_of)
    told = [
        f"Page: fuzzyq_bullet {__version__}, {packages}, Python {platform.python_version()}, "
        f"{platform.platform()}.",
        f"Sweeps: fuzzyq_bullet {', '.join(sorted(versions))}.",
    ]
    settings = [
        tag(
            "details",
            tag("summary", f"Settings of {one.folder}"),
            tag("pre", tag("code", _settings(one.folder)), tabindex="0"),
        )
        for one in evaluation.sweeps
    ]
    return Section(
        "made",
        "How it was made",
        join(
            tag("pre", tag("code", "\n".join([*lines, report])), tabindex="0"),
            blocks.paragraphs(
                "A policy other than the shipped one is not in the commands; settings hold its "
                "hash. The same sweeps give the same page, with the same versions on one machine.",
                *told,
            ),
            blocks.warning(
                f"sweeps of another version ({', '.join(others)}): runs that are made again "
                "below may differ."
            )
            if others
            else None,
            *settings,
        ),
    )


def _settings(folder: Path) -> str:
    told = json.loads((folder / "settings.json").read_text(encoding="utf-8"))
    return json.dumps(told, indent=2, ensure_ascii=False)
