"""A hook of MkDocs: the reference of the command line, made of the help of the commands themselves.

The page ``reference/cli.md`` has a marker; what ``fuzzyq COMMAND --help`` says takes its place.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import typer
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import Files
from mkdocs.structure.pages import Page

MARKER = "<!-- fuzzyq --help -->"


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Put the help where the marker is."""
    return markdown.replace(MARKER, reference()) if MARKER in markdown else markdown


def reference() -> str:
    """Return what there is to say of every command, in Markdown."""
    from fuzzyq_bullet.cli.app import app

    group = typer.main.get_command(app)
    found = commands(group, "fuzzyq")
    return "\n".join(line for name, command in found for line in told(name, command))


def commands(group: Any, path: str) -> Iterator[tuple[str, Any]]:
    """Yield each command below a group by its whole name."""
    context = group.make_context(path, [], resilient_parsing=True)
    for name in group.list_commands(context):
        command = group.get_command(context, name)
        if hasattr(command, "list_commands"):
            yield from commands(command, f"{path} {name}")
        else:
            yield f"{path} {name}", command


def told(name: str, command: Any) -> Iterator[str]:
    """Yield the lines about a command: what it does, its arguments, its options."""
    context = command.make_context(name, [], resilient_parsing=True)
    usage = " ".join(command.collect_usage_pieces(context))
    yield f"## {name}\n\n```text\n{name} {usage}\n```\n\n{(command.help or '').strip()}\n"
    records = [one.get_help_record(context) for one in command.params]
    rows = [row(*record) for record in records if record]  # what is hidden has none
    if rows:
        yield "| | what it does |\n|---|---|"
        yield "\n".join(rows) + "\n"


def row(names: str, text: str) -> str:
    """Return the row of an argument or an option."""
    told = " ".join(text.split()).replace("|", "\\|").replace("<", "&lt;")
    return f"| `{names.strip()}` | {told} |"
