"""A hook of MkDocs: a link to a file outside of ``docs/`` leads to a page with that file.

The pages link to code as GitHub wants it, such as ``../../fuzzyq_bullet/episode.py#L10-L20``. On
the site each linked file becomes a page, with an anchor for each line; a linked folder becomes a
list of its files. A link to what is not there is left alone, and the strict build then fails.
"""

from __future__ import annotations

import ast
import os
import re
from pathlib import Path, PurePosixPath

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import TextLexer, get_lexer_for_filename
from pygments.util import ClassNotFound

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
LINK = re.compile(r"(?<=\]\()(?P<path>\.\.?/[^)\s#]+)(?:#L(?P<line>\d+)(?:-L\d+)?)?(?=\))")

HEAD = "---\nsearch:\n  exclude: true\nhide: [toc]\n---\n\n# `{name}`\n\n"


def outside(page: str, path: str) -> PurePosixPath | None:
    """Return what a link leads to, from the top of the repository; None if it stays in ``docs/``.

    Args:
        page: The page with the link, from ``docs/`` on.
        path: What the link says.
    """
    target = Path(os.path.normpath(DOCS / PurePosixPath(page).parent / path))
    if target.is_relative_to(DOCS) or not target.is_relative_to(ROOT) or not target.exists():
        return None
    return PurePosixPath(target.relative_to(ROOT).as_posix())


def home(target: PurePosixPath) -> str:
    """Return the page, from ``docs/`` on, that shows a file or a folder."""
    inside = "/index.md" if (ROOT / target).is_dir() else ".md"
    return f"source/{target}{inside}"


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add a page for every file and folder outside that a page links to."""
    wanted: set[PurePosixPath] = set()
    for file in files.documentation_pages():
        for link in LINK.finditer(file.content_string):
            if (target := outside(file.src_uri, link["path"])) is not None:
                wanted.add(target)
    for target in [one for one in wanted if (ROOT / one).is_dir()]:
        wanted |= set(contents(target))
    for target in sorted(wanted):
        text = listing(target) if (ROOT / target).is_dir() else shown(target)
        files.append(File.generated(config, home(target), content=text))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Let the links of a page lead to these pages."""
    here = PurePosixPath(page.file.src_uri).parent

    def led(link: re.Match[str]) -> str:
        target = outside(page.file.src_uri, link["path"])
        if target is None:
            return link[0]
        line = f"#L-{link['line']}" if link["line"] else ""
        return os.path.relpath(home(target), here) + line

    return LINK.sub(led, markdown)


def contents(folder: PurePosixPath) -> list[PurePosixPath]:
    """Return the files of a folder, without what Python and others leave there."""
    names = sorted(path for path in (ROOT / folder).iterdir() if path.is_file())
    kept = [path for path in names if not path.name.startswith(".") and path.suffix != ".pyc"]
    return [PurePosixPath(path.relative_to(ROOT).as_posix()) for path in kept]


def listing(folder: PurePosixPath) -> str:
    """Return the page of a folder: its files, and what each is for."""
    rows = [f"| [`{one.name}`]({one.name}.md) | {purpose(one)} |" for one in contents(folder)]
    return "\n".join([HEAD.format(name=f"{folder}/"), "| file | |", "|---|---|", *rows, ""])


def purpose(file: PurePosixPath) -> str:
    """Return the first line of a module's docstring."""
    if file.suffix != ".py":
        return ""
    told = ast.get_docstring(ast.parse((ROOT / file).read_text(encoding="utf-8"))) or ""
    return told.partition("\n")[0].replace("``", "`").replace("|", "\\|")


def shown(file: PurePosixPath) -> str:
    """Return the page of a file: its text, each line with an anchor and a number."""
    text = (ROOT / file).read_text(encoding="utf-8")
    try:
        lexer = get_lexer_for_filename(file.name)
    except ClassNotFound:
        lexer = TextLexer()
    look = HtmlFormatter(
        linenos="inline", linespans="L", cssclass="highlight source", wrapcode=True
    )
    return HEAD.format(name=file) + highlight(text, lexer, look)
